//! Whether the queue's own book-keeping holds.

use crate::engine::queue::{BEYOND, EventQueue, Key, NOWHERE, in_heap};

impl EventQueue {
    /// Where the entry of a grain, which says this, is said to lie, it must lie, and in
    /// the right order.
    pub(in crate::engine) fn check_entry(&self, particle: u32, key: Key) -> Result<(), String> {
        let place = self.places[particle as usize];
        if place == NOWHERE {
            return if key.time.is_finite() {
                Err(format!(
                    "the entry of grain {particle}, {key:?}, is nowhere"
                ))
            } else {
                Ok(())
            };
        }
        if !key.time.is_finite() {
            return Err(format!("grain {particle} is filed without an entry"));
        }
        let slot = self.slot_of(key.time);
        if let Some(position) = in_heap(place) {
            let there = self.heap.get(position);
            let Some(entry) = there.filter(|entry| entry.particle == particle) else {
                return Err(format!("grain {particle} is not at {position} of the heap"));
            };
            if entry.key != key {
                let filed = entry.key;
                return Err(format!(
                    "grain {particle} is filed as {filed:?}, not {key:?}"
                ));
            }
            let above = self.heap[position.saturating_sub(1) / 2];
            if above.key > key {
                let above = above.particle;
                return Err(format!("grain {particle} in the heap comes before {above}"));
            }
            if slot > self.current {
                return Err(format!("grain {particle} in the heap is for slot {slot}"));
            }
            return Ok(());
        }
        // What was beyond the calendar may lie within it by now, but not before its next turn.
        let slots = self.slots();
        let beyond = place == BEYOND && slot >= (self.current / slots + 1) * slots;
        if slot <= self.current || (place != self.list_of(slot) && !beyond) {
            return Err(format!(
                "grain {particle} for slot {slot} is filed in {place}, the calendar being at {}",
                self.current
            ));
        }
        if !self.lists.each(place).any(|id| id == particle) {
            return Err(format!("grain {particle} is not on list {place}"));
        }
        Ok(())
    }

    /// The numbers of entries.
    pub(in crate::engine) fn check_numbers(&self) -> Result<(), String> {
        let (mut filed, mut heaped) = ([0; 2], 0);
        for &place in self.places.iter().filter(|place| **place != NOWHERE) {
            match in_heap(place) {
                Some(_) => heaped += 1,
                None => filed[usize::from(place == BEYOND)] += 1,
            }
        }
        if filed != self.filed {
            return Err(format!("{filed:?} entries are filed, not {:?}", self.filed));
        }
        if heaped != self.heap.len() {
            return Err("the heap holds more entries than there are".into());
        }
        Ok(())
    }
}
