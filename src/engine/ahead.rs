//! Data of the next events, fetched before they are needed.
//!
//! In a large system hardly anything that an event needs is near the processor, and
//! what it needs is found out step by step: the entry names the grain, the grain its
//! partner and its list, the list the neighbours. So what belongs to the entries of
//! the next few slots of the calendar is read a little earlier, a step of that chain
//! for each slot: then the processor waits for many things at once instead of for one
//! after the other. Nothing is kept of it, so it changes nothing but the time taken.

use std::hint::black_box;
use std::mem::needs_drop;

use crate::engine::body::World;
use crate::engine::simulation::Simulation;
use crate::engine::slot::Partner;
use crate::model::{MemoryOf, Model};

/// Smaller systems are near anyway.
const MANY: usize = 20_000;

/// How many slots of the calendar ahead each step is taken.
const STEPS: [i64; 4] = [8, 6, 4, 2];

impl<M: Model<D>, const D: usize> Simulation<M, D> {
    /// Fetches what belongs to events soon to come, if the calendar has got on.
    #[inline]
    pub(super) fn fetch_ahead(&mut self) {
        let page = self.queue.page();
        if page != self.fetched && self.world.bodies.len() >= MANY {
            self.fetch_pages(page);
        }
    }

    #[inline(never)]
    fn fetch_pages(&mut self, page: i64) {
        // After a leap of the calendar only the last slots matter.
        let first = if page > self.fetched {
            (self.fetched + 1).max(page - STEPS[0])
        } else {
            page
        };
        self.fetched = page;
        for (step, ahead) in STEPS.into_iter().enumerate() {
            for slot in first..=page {
                for particle in self.queue.filed_in(slot + ahead) {
                    self.fetch(particle, step);
                }
            }
        }
    }

    /// Takes a step for one grain.
    #[inline]
    fn fetch(&self, particle: u32, step: usize) {
        let partner = || match self.slots[particle].partner {
            Partner::Particle(partner) => Some(partner),
            _ => None,
        };
        match step {
            0 => self.touch(particle),
            1 => {
                self.world.near.touch_list(particle);
                if let Some(partner) = partner() {
                    self.touch(partner);
                }
            }
            2 => {
                if let Some(partner) = partner() {
                    self.world.near.touch_list(partner);
                }
                self.world.touch_neighbours(particle);
            }
            _ => {
                if self.world.near.has_bed(particle) {
                    self.world.touch_movers(particle);
                }
                if let Some(partner) = partner() {
                    self.world.touch_neighbours(partner);
                }
            }
        }
    }

    /// What is kept of a grain itself.
    #[inline]
    fn touch(&self, particle: u32) {
        let place = particle as usize;
        black_box(self.slots[particle].partner_stamp);
        black_box(self.world.bodies[place].position[0]);
        black_box(self.world.bodies[place].stamp);
        if const { !needs_drop::<MemoryOf<M, D>>() } {
            // Owns nothing, so a copy costs no more than reading it.
            black_box(self.memories[particle].clone());
        }
        self.world.glances.touch(particle);
        self.world.near.touch(particle);
        self.traces.touch(particle);
        self.queue.touch(particle);
    }
}

impl<const D: usize> World<D> {
    /// A grain's bed, or how those on its list are seen if it has none.
    #[inline]
    fn touch_neighbours(&self, particle: u32) {
        match self.near.bed(particle) {
            (Some(bed), _) => bed.touch(),
            (None, _) => self.touch_movers(particle),
        }
    }

    /// How those on a grain's list who move are seen.
    #[inline]
    fn touch_movers(&self, particle: u32) {
        for link in self.near.bed(particle).1 {
            self.glances.touch(link.particle());
        }
    }
}
