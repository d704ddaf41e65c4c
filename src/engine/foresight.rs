//! How long until a grain's next collision, for those that fall asleep half-way
//! to it.
//!
//! Prediction notes only what it has to; here everybody counts, and as far
//! ahead as it takes. A bound on all speeds says when nobody else can come
//! first.

use crate::engine::cells::Found;
use crate::engine::simulation::Simulation;
use crate::model::{Boundary, Flight, Model};
use crate::particle::WallId;
use crate::time::Time;

/// Beyond this, in √(d/g), so much comes near that telling who does spares nothing.
const SOON: f64 = 0.25;

/// Leaves room for rounding.
const ROUND: f64 = 1.0 - 1.0e-9;

impl<M: Model<D>, const D: usize> Simulation<M, D> {
    /// How long until a grain's next collision if everyone flies on as now.
    pub(super) fn next_collision(&mut self, particle: u32) -> Option<f64> {
        let start = self.world.clock;
        let horizon = start + self.settings.sleep_horizon;
        let horizon = horizon.min(Time::LAST);
        let mut first = horizon;
        let mut any = false;
        for wall in 0..self.model.boundary().walls().len() {
            if let Some(time) = self.wall_contact(particle, WallId(wall as u16), first) {
                first = time;
                any = true;
            }
        }
        let mut found = std::mem::take(&mut self.scratch);
        found.clear();
        found.extend(self.world.near.list(particle));
        let farthest = self.shortest_period();
        let mut looked = None;
        loop {
            // Surfaces farther apart than this do not meet before.
            let mut near = self.nearing_soon(particle, first - start);
            let mut scale = self.scale_at(first);
            for other in &found {
                let bodies = &self.world.bodies;
                let sum = bodies[particle as usize].radius + bodies[other.particle as usize].radius;
                let distance = self.distance_to(particle, other);
                if distance > farthest || distance * ROUND > sum * scale + near {
                    continue;
                }
                if let Some(time) = self.pair_contact(particle, other.particle, other.turns, first)
                {
                    first = time;
                    any = true;
                    near = self.nearing_soon(particle, first - start);
                    scale = self.scale_at(first);
                }
            }
            // Nobody whose surface is farther away than this comes first.
            let nearing = self.nearing(particle, first - start);
            let Some(distance) = looked else {
                // Who is not on the list is off by what is left of the leash.
                let position = self.world.bodies[particle as usize].position;
                if any && nearing <= self.world.near.slack(particle, &position) {
                    break;
                }
                looked = Some(1.5 * self.world.largest);
                self.find_within(particle, 1.5 * self.world.largest, &mut found);
                continue;
            };
            let reach = farthest.min(self.world.largest * self.scale_at(first) + nearing);
            let everything =
                self.world.aloft.is_empty() && self.world.near.is_everything(particle, distance);
            if reach <= distance || everything {
                break;
            }
            looked = Some(reach);
            self.find_within(particle, reach, &mut found);
        }
        self.scratch = found;
        any.then_some(first - start)
    }

    /// Beyond the shortest period, images are not looked for: the limit is one
    /// of the model, so that it does not depend on the grid.
    fn shortest_period(&self) -> f64 {
        (0..D)
            .filter_map(|axis| self.model.boundary().period(axis))
            .map(|period| period.length)
            .fold(f64::INFINITY, f64::min)
    }

    /// How far away another grain is now, in the image it was found in.
    fn distance_to(&self, particle: u32, other: &Found<D>) -> f64 {
        let here = self.world.particle_now(&self.model, particle).position;
        let mut there = self
            .world
            .particle_now(&self.model, other.particle)
            .position;
        for axis in 0..D {
            if let Some(period) = self.model.boundary().period(axis) {
                there[axis] += f64::from(other.turns[axis]) * period.length;
            }
        }
        (there - here).norm_squared().sqrt()
    }

    fn find_within(&self, particle: u32, distance: f64, found: &mut Vec<Found<D>>) {
        found.clear();
        self.world
            .for_each_within(&self.model, particle, distance, |other| found.push(other));
    }

    /// How much nearer, in d, any grain can come to `particle` within a time.
    fn nearing(&mut self, particle: u32, within: f64) -> f64 {
        let own = self.world.flight(&self.model, particle).speed_bound(within);
        (own + self.speed_ceiling(within)) * within
    }

    /// The same where it costs little: infinity for longer times.
    fn nearing_soon(&mut self, particle: u32, within: f64) -> f64 {
        if within > SOON {
            f64::INFINITY
        } else {
            self.nearing(particle, within)
        }
    }
}
