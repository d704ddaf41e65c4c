//! The event queue: one entry a grain, ordered by time, kind and ids.
//!
//! A calendar of equal time slots whose current slot is an indexed heap (Paul
//! 2007, doi:10.1016/j.jcp.2006.06.042): entries far ahead are only filed, so
//! the cost of an event does not depend on how many grains wait. Slots decide
//! where an entry lies, never which comes first.

mod check;

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

/// One entry for each of a set of grains, named by index.
#[derive(Clone, Debug)]
pub(super) struct EventQueue {
    keys: Vec<Key>,
    /// Position in the heap, or the list (slot + 1, or `BEYOND`) it is filed in.
    places: Vec<u32>,
    /// Neighbours in the list an entry is filed in.
    next: Vec<u32>,
    previous: Vec<u32>,
    /// First entries of the lists: `BEYOND`, then one for each slot.
    heads: Vec<u32>,
    heap: Vec<u32>,
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
            keys: Vec::with_capacity(capacity),
            places: Vec::with_capacity(capacity),
            next: Vec::with_capacity(capacity),
            previous: Vec::with_capacity(capacity),
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
        self.keys.push(Key {
            time: Time::NEVER,
            rank: Rank::Transfer,
            low: 0,
            high: 0,
        });
        self.places.push(NOWHERE);
        self.next.push(NOWHERE);
        self.previous.push(NOWHERE);
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
        std::iter::successors(first, move |particle| known(self.next[*particle as usize]))
    }

    /// Reads an entry, to have it at hand.
    #[inline]
    pub(super) fn touch(&self, particle: u32) {
        black_box(self.keys[particle as usize].low);
        black_box(self.places[particle as usize]);
    }

    /// Takes back the last grain that room was made for.
    pub(super) fn forget_last(&mut self) {
        if let Some(last) = self.keys.len().checked_sub(1) {
            self.take_out(last as u32);
            self.keys.pop();
            self.places.pop();
            self.next.pop();
            self.previous.pop();
        }
    }

    /// The earliest entry.
    pub(super) fn peek(&mut self) -> Option<(u32, Key)> {
        while self.heap.is_empty() {
            if !self.turn_page() {
                return None;
            }
        }
        let first = self.heap[0];
        Some((first, self.keys[first as usize]))
    }

    /// Gives a grain another entry, or none if `key.time` is never.
    pub(super) fn set(&mut self, particle: u32, key: Key) {
        let index = particle as usize;
        if self.keys[index] == key {
            return;
        }
        let place = self.places[index];
        let slot = self.slot_of(key.time);
        if place != NOWHERE && place & IN_HEAP != 0 && slot <= self.current {
            // The common case: stays in the heap.
            let earlier = key < self.keys[index];
            self.keys[index] = key;
            let position = (place & !IN_HEAP) as usize;
            if earlier {
                self.sift_up(position);
            } else {
                self.served += u64::from(position == 0);
                self.sift_down(position);
            }
            return;
        }
        self.take_out(particle);
        self.keys[index] = key;
        self.file(particle);
    }

    /// How many slots there are: a power of two.
    fn slots(&self) -> i64 {
        self.heads.len() as i64 - 1
    }

    fn slot_of(&self, time: Time) -> i64 {
        // Saturates, for what lies far ahead or never comes.
        ((time - self.origin) * self.per_time) as i64
    }

    fn file(&mut self, particle: u32) {
        let index = particle as usize;
        let time = self.keys[index].time;
        if !time.is_finite() {
            self.places[index] = NOWHERE;
            return;
        }
        let slot = self.slot_of(time);
        if slot <= self.current {
            self.heap.push(particle);
            self.sift_up(self.heap.len() - 1);
            return;
        }
        let list = if slot - self.current < self.slots() {
            self.filed += 1;
            (slot & (self.slots() - 1)) as usize + 1
        } else {
            BEYOND
        };
        let head = self.heads[list];
        self.next[index] = head;
        self.previous[index] = NOWHERE;
        if head != NOWHERE {
            self.previous[head as usize] = particle;
        }
        self.heads[list] = particle;
        self.places[index] = list as u32;
    }

    fn take_out(&mut self, particle: u32) {
        let index = particle as usize;
        let place = self.places[index];
        if place == NOWHERE {
            return;
        }
        self.places[index] = NOWHERE;
        if place & IN_HEAP != 0 {
            let position = (place & !IN_HEAP) as usize;
            self.served += u64::from(position == 0);
            let last = self.heap.len() - 1;
            self.heap.swap_remove(position);
            if position < last {
                self.places[self.heap[position] as usize] = position as u32 | IN_HEAP;
                self.sift_up(position);
                self.sift_down(position);
            }
            return;
        }
        let (next, previous) = (self.next[index], self.previous[index]);
        if next != NOWHERE {
            self.previous[next as usize] = previous;
        }
        if previous == NOWHERE {
            self.heads[place as usize] = next;
        } else {
            self.next[previous as usize] = next;
        }
        self.filed -= usize::from(place as usize != BEYOND);
    }

    /// Moves the next slot into the empty heap; false if nothing is left.
    fn turn_page(&mut self) -> bool {
        if self.filed == 0 {
            if self.heads[BEYOND] == NOWHERE {
                return false;
            }
            // A gap: start a new calendar at the earliest entry.
            self.rebuild(self.width * 2.0);
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
            self.rebuild(width);
            return true;
        }
        let list = (self.current & (self.slots() - 1)) as usize + 1;
        let mut particle = std::mem::replace(&mut self.heads[list], NOWHERE);
        while particle != NOWHERE {
            let following = self.next[particle as usize];
            self.filed -= 1;
            self.heap.push(particle);
            self.sift_up(self.heap.len() - 1);
            particle = following;
        }
        true
    }

    /// Files everything anew, from the earliest entry on.
    fn rebuild(&mut self, width: f64) {
        let start = self.keys.iter().map(|key| key.time).min();
        self.origin = start.unwrap_or(self.origin);
        self.width = width.clamp(1.0e-14, 1.0e6);
        self.per_time = 1.0 / self.width;
        self.current = 0;
        self.filed = 0;
        self.heap.clear();
        self.heads.fill(NOWHERE);
        for particle in 0..self.keys.len() as u32 {
            self.file(particle);
        }
    }

    fn sift_up(&mut self, mut position: usize) {
        let particle = self.heap[position];
        let key = self.keys[particle as usize];
        while position > 0 {
            let parent = (position - 1) / 2;
            let above = self.heap[parent];
            if self.keys[above as usize] <= key {
                break;
            }
            self.heap[position] = above;
            self.places[above as usize] = position as u32 | IN_HEAP;
            position = parent;
        }
        self.heap[position] = particle;
        self.places[particle as usize] = position as u32 | IN_HEAP;
    }

    fn sift_down(&mut self, mut position: usize) {
        let particle = self.heap[position];
        let key = self.keys[particle as usize];
        loop {
            let mut child = 2 * position + 1;
            if child >= self.heap.len() {
                break;
            }
            let right = child + 1;
            if right < self.heap.len()
                && self.keys[self.heap[right] as usize] < self.keys[self.heap[child] as usize]
            {
                child = right;
            }
            let below = self.heap[child];
            if key <= self.keys[below as usize] {
                break;
            }
            self.heap[position] = below;
            self.places[below as usize] = position as u32 | IN_HEAP;
            position = child;
        }
        self.heap[position] = particle;
        self.places[particle as usize] = position as u32 | IN_HEAP;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn key(units: f64, particle: u32) -> Key {
        Key {
            time: Time::from_units(units),
            rank: Rank::Contact,
            low: particle,
            high: particle,
        }
    }

    proptest! {
        /// Against a sorted map: random re-scheduling over twelve decades of
        /// waiting times.
        #[test]
        fn serves_in_order(
            waits in proptest::collection::vec((0u32..40, -10.0..2.0f64, 0u8..8), 1..600)
        ) {
            let mut queue = EventQueue::new(40, Time::ZERO);
            for _ in 0..40 {
                queue.push_empty();
            }
            let mut sorted = std::collections::BTreeMap::new();
            let mut clock = 0.0;
            for (particle, exponent, action) in waits {
                if action == 0 {
                    let expected = sorted.iter().next().map(|(key, particle)| (*particle, *key));
                    prop_assert_eq!(queue.peek(), expected);
                    if let Some((first, first_key)) = expected {
                        clock = f64::max(clock, first_key.time.units());
                        queue.set(first, Key { time: Time::NEVER, ..first_key });
                        sorted.remove(&first_key);
                    }
                    continue;
                }
                let new = key(clock + libm::exp10(exponent), particle);
                sorted.retain(|_, p| *p != particle);
                sorted.insert(new, particle);
                queue.set(particle, new);
            }
            while let Some((key, particle)) = sorted.pop_first() {
                prop_assert_eq!(queue.peek(), Some((particle, key)));
                queue.set(particle, Key { time: Time::NEVER, ..key });
            }
            prop_assert_eq!(queue.peek(), None);
        }
    }

    #[test]
    fn equal_times_go_by_kind_then_ids() {
        let mut queue = EventQueue::new(4, Time::ZERO);
        for _ in 0..4 {
            queue.push_empty();
        }
        let at = |rank, low, high| Key {
            time: Time::from_units(1.0),
            rank,
            low,
            high,
        };
        queue.set(0, at(Rank::Transfer, 0, 0));
        queue.set(3, at(Rank::Contact, 2, 3));
        queue.set(2, at(Rank::Contact, 1, 2));
        queue.set(1, at(Rank::Sleep, 1, 1));
        let mut order = Vec::new();
        while let Some((particle, key)) = queue.peek() {
            order.push(particle);
            queue.set(
                particle,
                Key {
                    time: Time::NEVER,
                    ..key
                },
            );
        }
        assert_eq!(order, [2, 3, 1, 0]);
    }
}
