//! The event queue: one entry a grain, ordered by time, kind and ids.
//!
//! A calendar of equal time slots whose current slot is an indexed heap (Paul
//! 2007, doi:10.1016/j.jcp.2006.06.042): entries far ahead are only filed, so
//! the cost of an event does not depend on how many grains wait. Slots decide
//! where an entry lies, never which comes first.

mod check;
#[cfg(test)]
mod tests;

use std::hint::black_box;

use serde::{Deserialize, Serialize};

use crate::time::Time;

/// What an entry announces, in the order in which equal times are served.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) enum Rank {
    Contact,
    Wall,
    Sleep,
    Policy,
    Transfer,
}

/// When and in which order: time, kind, smaller id, larger id.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) struct Key {
    pub(super) time: Time,
    pub(super) rank: Rank,
    pub(super) low: u32,
    pub(super) high: u32,
}

const NOWHERE: u32 = u32::MAX;
/// Marks a place as a position in the heap.
const IN_HEAP: u32 = 1 << 31;
/// Entries beyond the last slot of the calendar.
const BEYOND: usize = 0;

/// An entry in the heap.
#[derive(Clone, Copy, Debug)]
struct Entry {
    key: Key,
    particle: u32,
}

/// Where the entry of a grain lies.
#[derive(Clone, Copy, Debug)]
struct Berth {
    /// Position in the heap, or the list (slot + 1, or `BEYOND`) it is filed in.
    place: u32,
    /// Neighbours in that list.
    next: u32,
    previous: u32,
}

impl Berth {
    const NONE: Berth = Berth {
        place: NOWHERE,
        next: NOWHERE,
        previous: NOWHERE,
    };

    #[inline]
    fn in_heap(self) -> Option<usize> {
        (self.place != NOWHERE && self.place & IN_HEAP != 0)
            .then_some((self.place & !IN_HEAP) as usize)
    }

    /// The list that holds the entry, if one does.
    #[inline]
    fn list(self) -> Option<usize> {
        (self.place & IN_HEAP == 0).then_some(self.place as usize)
    }
}

/// One entry for each of a set of grains, named by index.
///
/// What an entry says is kept in the heap alone. For those that are only filed, who
/// asks for the earliest says it again: it must be what it was when they were set.
#[derive(Clone, Debug)]
pub(super) struct EventQueue {
    berths: Vec<Berth>,
    /// First entries of the lists: `BEYOND`, then one for each slot.
    heads: Vec<u32>,
    heap: Vec<Entry>,
    /// Entries filed in slots.
    filed: usize,
    /// Start of slot 0 of the calendar.
    origin: Time,
    /// Length of a slot.
    width: f64,
    /// Slots in a unit of time.
    per_time: f64,
    /// The slot that is in the heap; all earlier ones are empty.
    current: i64,
    /// Entries taken from the front since the calendar last turned.
    served: u64,
}

impl EventQueue {
    pub(super) fn new(capacity: usize, start: Time) -> Self {
        let slots = (2 * capacity).next_power_of_two().clamp(256, 1 << 20);
        EventQueue {
            berths: Vec::with_capacity(capacity),
            heads: vec![NOWHERE; slots + 1],
            heap: Vec::new(),
            filed: 0,
            origin: start,
            width: 1.0 / slots as f64,
            per_time: slots as f64,
            current: 0,
            served: 0,
        }
    }

    /// Makes room for one more grain, without an entry.
    pub(super) fn push_empty(&mut self) {
        self.berths.push(Berth::NONE);
    }

    /// The slot of the calendar that is being served.
    #[inline]
    pub(super) fn page(&self) -> i64 {
        self.current
    }

    /// Whose entries are filed in a slot that is still to come.
    #[inline]
    pub(super) fn filed_in(&self, slot: i64) -> impl Iterator<Item = u32> {
        let ahead = slot > self.current && slot - self.current < self.slots();
        let list = (slot & (self.slots() - 1)) as usize + 1;
        let known = |particle: u32| (particle != NOWHERE).then_some(particle);
        let first = if ahead { known(self.heads[list]) } else { None };
        let next = move |particle: &u32| known(self.berths[*particle as usize].next);
        std::iter::successors(first, next)
    }

    /// Reads where an entry lies, to have it at hand.
    #[inline]
    pub(super) fn touch(&self, particle: u32) {
        black_box(self.berths[particle as usize].place);
    }

    /// Takes back the last grain that room was made for.
    pub(super) fn forget_last(&mut self) {
        if let Some(last) = self.berths.len().checked_sub(1) {
            self.take_out(last as u32);
            self.berths.pop();
        }
    }

    /// The earliest entry, where `key` says again what was set.
    #[inline]
    pub(super) fn peek(&mut self, key: impl Fn(u32) -> Key) -> Option<(u32, Key)> {
        while self.heap.is_empty() {
            if !self.turn_page(&key) {
                return None;
            }
        }
        let Entry { key, particle } = self.heap[0];
        Some((particle, key))
    }

    /// Gives a grain another entry, or none if `key.time` is never.
    pub(super) fn set(&mut self, particle: u32, key: Key) {
        let berth = self.berths[particle as usize];
        if !key.time.is_finite() {
            self.take_out(particle);
            return;
        }
        let slot = self.slot_of(key.time);
        if let Some(position) = berth.in_heap() {
            if slot <= self.current {
                // The common case: stays in the heap.
                let entry = Entry { key, particle };
                let old = self.heap[position].key;
                if key < old {
                    self.sift_up(position, entry);
                } else if key != old {
                    self.served += u64::from(position == 0);
                    self.sift_down(position, entry);
                }
                return;
            }
        } else if slot > self.current && berth.list() == Some(self.list_of(slot)) {
            return;
        }
        self.take_out(particle);
        self.file(particle, slot, key);
    }

    /// How many slots there are: a power of two.
    fn slots(&self) -> i64 {
        self.heads.len() as i64 - 1
    }

    fn slot_of(&self, time: Time) -> i64 {
        // Saturates, for what lies far ahead or never comes.
        ((time - self.origin) * self.per_time) as i64
    }

    /// The list for a slot that is still to come.
    fn list_of(&self, slot: i64) -> usize {
        if slot - self.current < self.slots() {
            (slot & (self.slots() - 1)) as usize + 1
        } else {
            BEYOND
        }
    }

    fn file(&mut self, particle: u32, slot: i64, key: Key) {
        if slot <= self.current {
            self.push(Entry { key, particle });
            return;
        }
        let list = self.list_of(slot);
        self.filed += usize::from(list != BEYOND);
        let head = self.heads[list];
        self.berths[particle as usize] = Berth {
            place: list as u32,
            next: head,
            previous: NOWHERE,
        };
        if head != NOWHERE {
            self.berths[head as usize].previous = particle;
        }
        self.heads[list] = particle;
    }

    fn take_out(&mut self, particle: u32) {
        let berth = std::mem::replace(&mut self.berths[particle as usize], Berth::NONE);
        if let Some(position) = berth.in_heap() {
            self.served += u64::from(position == 0);
            self.heap.swap_remove(position);
            if let Some(&moved) = self.heap.get(position) {
                self.sift_up(position, moved);
                let position = self.berths[moved.particle as usize].in_heap();
                self.sift_down(position.unwrap_or_default(), moved);
            }
        } else if let Some(list) = berth.list() {
            if berth.next != NOWHERE {
                self.berths[berth.next as usize].previous = berth.previous;
            }
            if berth.previous == NOWHERE {
                self.heads[list] = berth.next;
            } else {
                self.berths[berth.previous as usize].next = berth.next;
            }
            self.filed -= usize::from(list != BEYOND);
        }
    }

    /// Moves the next slot into the empty heap; false if nothing is left.
    fn turn_page(&mut self, key: &impl Fn(u32) -> Key) -> bool {
        if self.filed == 0 {
            if self.heads[BEYOND] == NOWHERE {
                return false;
            }
            // A gap: start a new calendar at the earliest entry.
            self.rebuild(self.width * 2.0, key);
            return true;
        }
        self.current += 1;
        if self.current & (self.slots() - 1) == 0 {
            let per_slot = self.served as f64 / self.slots() as f64;
            self.served = 0;
            let width = if per_slot > 3.0 {
                self.width * 0.25
            } else if per_slot < 0.25 {
                self.width * 2.0
            } else {
                self.width
            };
            self.rebuild(width, key);
            return true;
        }
        let list = (self.current & (self.slots() - 1)) as usize + 1;
        let mut particle = std::mem::replace(&mut self.heads[list], NOWHERE);
        while particle != NOWHERE {
            let following = self.berths[particle as usize].next;
            self.filed -= 1;
            self.push(Entry {
                key: key(particle),
                particle,
            });
            particle = following;
        }
        true
    }

    /// Files everything anew, from the earliest entry on.
    fn rebuild(&mut self, width: f64, key: &impl Fn(u32) -> Key) {
        let filed = (0..self.berths.len() as u32)
            .filter(|&particle| self.berths[particle as usize].place != NOWHERE);
        if let Some(start) = filed.map(|particle| key(particle).time).min() {
            self.origin = start;
        }
        self.width = width.clamp(1.0e-14, 1.0e6);
        self.per_time = 1.0 / self.width;
        self.current = 0;
        self.filed = 0;
        self.heap.clear();
        self.heads.fill(NOWHERE);
        for particle in 0..self.berths.len() as u32 {
            if self.berths[particle as usize].place != NOWHERE {
                let key = key(particle);
                self.file(particle, self.slot_of(key.time), key);
            }
        }
    }

    fn push(&mut self, entry: Entry) {
        self.heap.push(entry);
        self.sift_up(self.heap.len() - 1, entry);
    }

    /// Puts an entry into the heap at a position, or above.
    fn sift_up(&mut self, mut position: usize, entry: Entry) {
        while position > 0 {
            let parent = (position - 1) / 2;
            let above = self.heap[parent];
            if above.key <= entry.key {
                break;
            }
            self.put(position, above);
            position = parent;
        }
        self.put(position, entry);
    }

    /// Puts an entry into the heap at a position, or below.
    fn sift_down(&mut self, mut position: usize, entry: Entry) {
        loop {
            let child = 2 * position + 1;
            let Some(mut below) = self.heap.get(child) else {
                break;
            };
            let mut lower = child;
            if let Some(right) = self.heap.get(child + 1)
                && right.key < below.key
            {
                (below, lower) = (right, child + 1);
            }
            if entry.key <= below.key {
                break;
            }
            self.put(position, *below);
            position = lower;
        }
        self.put(position, entry);
    }

    #[inline]
    fn put(&mut self, position: usize, entry: Entry) {
        self.heap[position] = entry;
        self.berths[entry.particle as usize].place = position as u32 | IN_HEAP;
    }
}
