//! The event queue: one entry a grain, ordered by time, kind and ids.
//!
//! A calendar of equal time slots whose current slot is an indexed heap (Paul
//! 2007, doi:10.1016/j.jcp.2006.06.042): entries far ahead are only filed, so
//! the cost of an event does not depend on how many grains wait. Slots decide
//! where an entry lies, never which comes first.

mod check;
mod lists;
#[cfg(test)]
mod tests;

use std::hint::black_box;

use serde::{Deserialize, Serialize};

use lists::Lists;

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
/// The list of entries beyond the last slot of the calendar.
const BEYOND: u32 = 0;

/// An entry in the heap.
#[derive(Clone, Copy, Debug)]
struct Entry {
    key: Key,
    particle: u32,
}

/// Position in the heap, if this place is one.
#[inline]
fn in_heap(place: u32) -> Option<usize> {
    (place != NOWHERE && place & IN_HEAP != 0).then_some((place & !IN_HEAP) as usize)
}

/// Slots of a calendar, however few entries there are: at the end of a turn it takes a look at
/// all that lie beyond.
const FEWEST: usize = 4096;

/// Leaves that the lists may take besides two for each grain.
const SPARE: usize = 4096;

/// How many slots the calendar of so many entries has: a power of two.
fn slots_for(entries: usize) -> usize {
    (2 * entries).next_power_of_two().clamp(FEWEST, 1 << 20)
}

/// One entry for each of a set of grains, named by index.
///
/// What an entry says is kept in the heap alone. For those that are only filed, who
/// asks for the earliest says it again: it must be what it was when they were set.
///
/// Nobody is taken off a list: an id on it whose entry lies elsewhere by now is passed
/// over when its slot is opened. So an entry that is set anew costs no more than a line
/// on another list, and is kept nowhere but there and in one number.
#[derive(Clone, Debug)]
pub(super) struct EventQueue {
    /// Where the entry of each grain lies: its position in the heap, or the list
    /// (`BEYOND`, or slot + 1) it is filed in.
    places: Vec<u32>,
    lists: Lists,
    heap: Vec<Entry>,
    /// Entries filed in slots, and beyond the last.
    filed: [usize; 2],
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
        let slots = slots_for(capacity);
        EventQueue {
            places: Vec::with_capacity(capacity),
            lists: Lists::new(slots + 1),
            heap: Vec::new(),
            filed: [0; 2],
            origin: start,
            width: 1.0 / slots as f64,
            per_time: slots as f64,
            current: 0,
            served: 0,
        }
    }

    /// Makes room for one more grain, without an entry.
    pub(super) fn push_empty(&mut self) {
        self.places.push(NOWHERE);
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
        let list = self.list_in_turn(slot);
        let ids = ahead.then(|| self.lists.each(list)).into_iter().flatten();
        ids.filter(move |particle| self.is_on(*particle, list))
    }

    /// Reads where an entry lies, to have it at hand.
    #[inline]
    pub(super) fn touch(&self, particle: u32) {
        black_box(self.places[particle as usize]);
    }

    /// Takes back the last grain that room was made for.
    pub(super) fn forget_last(&mut self) {
        if let Some(last) = self.places.len().checked_sub(1) {
            self.take_out(last as u32);
            self.places.pop();
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
        let place = self.places[particle as usize];
        if !key.time.is_finite() {
            self.take_out(particle);
            return;
        }
        let slot = self.slot_of(key.time);
        if let Some(position) = in_heap(place) {
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
        } else if slot > self.current && place == self.list_of(slot) {
            return;
        }
        self.take_out(particle);
        self.file(particle, slot, key);
    }

    /// How many slots there are: a power of two.
    fn slots(&self) -> i64 {
        self.lists.len() as i64 - 1
    }

    fn slot_of(&self, time: Time) -> i64 {
        // Saturates, for what lies far ahead or never comes.
        ((time - self.origin) * self.per_time) as i64
    }

    /// The list for a slot that is still to come.
    #[inline]
    fn list_of(&self, slot: i64) -> u32 {
        if slot - self.current < self.slots() {
            self.list_in_turn(slot)
        } else {
            BEYOND
        }
    }

    /// The list for a slot of this turn of the calendar.
    #[inline]
    fn list_in_turn(&self, slot: i64) -> u32 {
        (slot & (self.slots() - 1)) as u32 + 1
    }

    /// Whether an id on a list stands for an entry.
    #[inline]
    fn is_on(&self, particle: u32, list: u32) -> bool {
        self.places.get(particle as usize) == Some(&list)
    }

    #[inline]
    fn file(&mut self, particle: u32, slot: i64, key: Key) {
        if slot <= self.current {
            self.push(Entry { key, particle });
            return;
        }
        let list = self.list_of(slot);
        self.filed[usize::from(list == BEYOND)] += 1;
        self.places[particle as usize] = list;
        self.lists.add(list, particle);
        if self.lists.leaves() > 2 * self.places.len() + SPARE {
            self.sweep();
        }
    }

    /// Strikes ids off that stand for no entry: so many have come together since the
    /// calendar has last moved on.
    #[cold]
    #[inline(never)]
    fn sweep(&mut self) {
        let mut swept = Lists::new(self.lists.len());
        for list in 0..self.lists.len() as u32 {
            for particle in self.unfile(list) {
                self.filed[usize::from(list == BEYOND)] += 1;
                self.places[particle as usize] = list;
                swept.add(list, particle);
            }
        }
        self.lists = swept;
    }

    fn take_out(&mut self, particle: u32) {
        let place = std::mem::replace(&mut self.places[particle as usize], NOWHERE);
        if let Some(position) = in_heap(place) {
            self.served += u64::from(position == 0);
            self.heap.swap_remove(position);
            if let Some(&moved) = self.heap.get(position) {
                self.sift_up(position, moved);
                let position = in_heap(self.places[moved.particle as usize]);
                self.sift_down(position.unwrap_or_default(), moved);
            }
        } else if place != NOWHERE {
            self.filed[usize::from(place == BEYOND)] -= 1;
        }
    }

    /// Moves the next slot into the empty heap; false if nothing is left.
    fn turn_page(&mut self, key: &impl Fn(u32) -> Key) -> bool {
        if self.filed == [0; 2] {
            return false;
        }
        if self.filed[0] == 0 {
            // A gap: start a new calendar at the earliest entry.
            self.rebuild(self.width * 2.0, key);
            return true;
        }
        self.current += 1;
        if self.current & (self.slots() - 1) == 0 {
            let per_slot = self.served as f64 / self.slots() as f64;
            self.served = 0;
            // About one served from each: more have to be sorted, fewer to be looked for.
            let width = if (0.5..=3.0).contains(&per_slot) {
                self.width
            } else {
                self.width * (1.2 / per_slot).clamp(0.0625, 4.0)
            };
            let slots = slots_for(self.filed[0] + self.filed[1]) as i64;
            if width != self.width || slots != self.slots() {
                self.rebuild(width, key);
                return true;
            }
            for particle in self.unfile(BEYOND) {
                let key = key(particle);
                self.file(particle, self.slot_of(key.time), key);
            }
        }
        let list = self.list_in_turn(self.current);
        let mut page = self.lists.take(list);
        while let Some(few) = self.lists.next(&mut page) {
            for &particle in few.ids() {
                if self.is_on(particle, list) {
                    self.filed[0] -= 1;
                    self.push(Entry {
                        key: key(particle),
                        particle,
                    });
                }
            }
        }
        true
    }

    /// Files everything anew, from the earliest entry on; the heap is empty.
    fn rebuild(&mut self, width: f64, key: &impl Fn(u32) -> Key) {
        let lists = 0..self.lists.len() as u32;
        let all: Vec<u32> = lists.flat_map(|list| self.unfile(list)).collect();
        if let Some(start) = all.iter().map(|particle| key(*particle).time).min() {
            self.origin = start;
        }
        self.width = width.clamp(1.0e-14, 1.0e6);
        self.per_time = 1.0 / self.width;
        self.current = 0;
        self.lists = Lists::new(slots_for(all.len()) + 1);
        for particle in all {
            let key = key(particle);
            self.file(particle, self.slot_of(key.time), key);
        }
    }

    /// Takes all entries from a list: whose they are, each once.
    fn unfile(&mut self, list: u32) -> Vec<u32> {
        let mut all = Vec::new();
        let mut page = self.lists.take(list);
        while let Some(few) = self.lists.next(&mut page) {
            for &particle in few.ids() {
                if self.is_on(particle, list) {
                    self.take_out(particle);
                    all.push(particle);
                }
            }
        }
        all
    }

    #[inline]
    fn push(&mut self, entry: Entry) {
        self.heap.push(entry);
        self.sift_up(self.heap.len() - 1, entry);
    }

    /// Puts an entry into the heap at a position, or above.
    #[inline]
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
        self.places[entry.particle as usize] = position as u32 | IN_HEAP;
    }
}
