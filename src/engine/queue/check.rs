//! Whether the queue's own book-keeping holds.

use crate::engine::queue::{BEYOND, EventQueue, Key, NOWHERE};

impl EventQueue {
    /// Where the entry of a grain, which says this, is said to lie, it must lie, and in
    /// the right order.
    pub(in crate::engine) fn check_entry(&self, particle: u32, key: Key) -> Result<(), String> {
        let berth = self.berths[particle as usize];
        if berth.place == NOWHERE {
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
        if let Some(position) = berth.in_heap() {
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
        let place = berth.place as usize;
        // What was beyond the calendar may lie within it by now.
        if slot <= self.current || (place != self.list_of(slot) && place != BEYOND) {
            return Err(format!(
                "grain {particle} for slot {slot} is filed in {place}, the calendar being at {}",
                self.current
            ));
        }
        let follows = match berth.previous {
            NOWHERE => self.heads[place] == particle,
            previous => self.berths[previous as usize].next == particle,
        };
        let next = berth.next;
        let precedes = next == NOWHERE || self.berths[next as usize].previous == particle;
        if !follows || !precedes {
            return Err(format!("grain {particle} is not linked in list {place}"));
        }
        Ok(())
    }

    /// The numbers of entries.
    pub(in crate::engine) fn check_numbers(&self) -> Result<(), String> {
        let (mut filed, mut heaped) = (0, 0);
        for berth in &self.berths {
            heaped += usize::from(berth.in_heap().is_some());
            filed += usize::from(berth.list().is_some_and(|list| list != BEYOND));
        }
        if filed != self.filed {
            return Err(format!("{filed} entries are filed, not {}", self.filed));
        }
        if heaped != self.heap.len() {
            return Err("the heap holds more entries than there are".into());
        }
        Ok(())
    }
}
