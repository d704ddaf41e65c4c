//! Whether the queue's own book-keeping holds.

use crate::engine::queue::{BEYOND, EventQueue, IN_HEAP, Key, NOWHERE};

impl EventQueue {
    /// The entry of a grain; its time is never if it has none.
    pub(in crate::engine) fn key(&self, particle: u32) -> Key {
        self.keys[particle as usize]
    }

    /// Where a grain's entry is said to lie, it must lie, and in the right
    /// order.
    pub(in crate::engine) fn check_entry(&self, particle: u32) -> Result<(), String> {
        let index = particle as usize;
        let (key, place) = (self.keys[index], self.places[index]);
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
        if place & IN_HEAP != 0 {
            let position = (place & !IN_HEAP) as usize;
            if self.heap.get(position) != Some(&particle) {
                return Err(format!("grain {particle} is not at {position} of the heap"));
            }
            let above = self.heap[position.saturating_sub(1) / 2];
            if self.keys[above as usize] > key {
                return Err(format!("grain {particle} in the heap comes before {above}"));
            }
            if slot > self.current {
                return Err(format!("grain {particle} in the heap is for slot {slot}"));
            }
            return Ok(());
        }
        let right = if slot - self.current >= self.slots() {
            BEYOND
        } else {
            (slot.rem_euclid(self.slots())) as usize + 1
        };
        // What was beyond the calendar may lie within it by now.
        if slot <= self.current || (place as usize != right && place as usize != BEYOND) {
            return Err(format!(
                "grain {particle} for slot {slot} is filed in {place}, the calendar being at {}",
                self.current
            ));
        }
        let (next, previous) = (self.next[index], self.previous[index]);
        let follows = match previous {
            NOWHERE => self.heads[place as usize] == particle,
            previous => self.next[previous as usize] == particle,
        };
        let precedes = next == NOWHERE || self.previous[next as usize] == particle;
        if !follows || !precedes {
            return Err(format!("grain {particle} is not linked in list {place}"));
        }
        Ok(())
    }

    /// All entries, and their numbers.
    pub(in crate::engine) fn check_all(&self) -> Result<(), String> {
        let mut filed = 0;
        for particle in 0..self.keys.len() as u32 {
            self.check_entry(particle)?;
            let place = self.places[particle as usize];
            filed +=
                usize::from(place != NOWHERE && place & IN_HEAP == 0 && place as usize != BEYOND);
        }
        if filed != self.filed {
            return Err(format!("{filed} entries are filed, not {}", self.filed));
        }
        let heaped = self
            .places
            .iter()
            .filter(|&&place| place != NOWHERE && place & IN_HEAP != 0);
        if heaped.count() != self.heap.len() {
            return Err("the heap holds more entries than there are".into());
        }
        Ok(())
    }
}

#[cfg(test)]
impl EventQueue {
    /// Plants a fault: an entry is changed where it lies.
    pub(in crate::engine) fn tamper(&mut self, particle: u32, key: Key) {
        self.keys[particle as usize] = key;
    }
}
