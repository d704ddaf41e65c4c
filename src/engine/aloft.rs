//! Falling grains that are still far above everything else.
//!
//! The grains of a rain fall side by side, uniformly and equally fast, so they never
//! meet each other; nor anybody else before they come down to where others are. Up to
//! there they are *aloft*: without a neighbour list, found by nobody in the grid, and one
//! entry in the queue, that of the lowest, stands for all of them.
//!
//! What holds: every grain that is not aloft, and not falling with them, stays below
//! the *ceiling* until its list is made again, and those aloft stay more than a
//! diameter above it. Whoever comes nearer *lands*: it is given a list, and from then
//! on is one of the others.
//!
//! Who is aloft decides only how much has to be predicted: it never changes a
//! trajectory.

#[cfg(test)]
mod tests;

use std::cmp::Ordering;

use serde::{Deserialize, Serialize};

use crate::engine::body::{Body, World};
use crate::engine::cells::Found;
use crate::engine::images::for_each_turns;
use crate::engine::simulation::Simulation;
use crate::model::{Boundary, Dynamics, Flight, Model, Predictor};
use crate::particle::{Mode, Vector};
use crate::time::Time;

/// Fewer than this are not worth it; tests try it with anybody.
const FEW: usize = if cfg!(test) { 1 } else { 16 };

/// Who is aloft. Heights are lengths against the direction of fall, in d.
#[derive(Clone, Debug)]
pub(super) struct Aloft<const D: usize> {
    /// How they fall, in √(gd).
    velocity: Vector<D>,
    /// Against the direction of fall.
    up: Vector<D>,
    speed: f64,
    /// They are among so many grains that were there at the start.
    among: u32,
    /// When heights were noted.
    since: Time,
    /// Heights then of the lowest points, and whose: the lowest comes last. Some may
    /// not be aloft any more.
    waiting: Vec<(f64, u32)>,
    /// Nobody else reaches higher.
    ceiling: f64,
    /// How far above it they land.
    margin: f64,
    /// Whether the ceiling has risen, or the lowest is aloft no more, so that somebody
    /// lands sooner.
    risen: bool,
}

/// What is saved of those aloft: who they are follows from the grains.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub(super) struct SavedAloft<const D: usize> {
    velocity: Vector<D>,
    since: Time,
    among: u32,
    ceiling: f64,
}

impl<const D: usize> Aloft<D> {
    /// Nobody.
    pub(super) fn nobody() -> Self {
        Aloft {
            velocity: Vector::zeros(),
            up: Vector::zeros(),
            speed: 0.0,
            among: 0,
            since: Time::ZERO,
            waiting: Vec::new(),
            ceiling: f64::NEG_INFINITY,
            margin: 0.0,
            risen: false,
        }
    }

    /// Nobody yet, of those that fall with this velocity; `None` if they don't, or
    /// come round again along a periodic axis.
    fn falling<B: Boundary<D>>(
        boundary: &B,
        velocity: &Vector<D>,
        since: Time,
        among: u32,
        largest: f64,
    ) -> Option<Self> {
        let speed = velocity.norm_squared().sqrt();
        let round = |axis: usize| boundary.period(axis).is_some() && velocity[axis] != 0.0;
        if !(speed > 0.0 && speed.is_finite()) || (0..D).any(round) {
            return None;
        }
        Some(Aloft {
            velocity: *velocity,
            up: -velocity / speed,
            speed,
            among,
            since,
            margin: largest,
            ..Aloft::nobody()
        })
    }

    /// Somebody may be aloft no more.
    #[inline]
    pub(super) fn doubt(&mut self) {
        self.risen |= !self.is_empty();
    }

    /// Whether the ceiling has risen since the lowest was told when to land.
    #[inline]
    pub(super) fn risen(&self) -> bool {
        self.risen
    }

    #[inline]
    pub(super) fn is_empty(&self) -> bool {
        self.waiting.is_empty()
    }

    /// When somebody of this height, at the start, lands.
    fn landing(&self, height: f64) -> Time {
        self.since + ((height - self.ceiling - self.margin) / self.speed).max(0.0)
    }

    /// How far they have fallen, in d.
    fn fallen(&self, now: Time) -> f64 {
        (now - self.since) * self.speed
    }
}

impl<const D: usize> World<D> {
    /// Whether a grain is aloft.
    #[inline]
    pub(super) fn is_aloft(&self, particle: u32) -> bool {
        self.bodies[particle as usize].mode == Mode::Falling && !self.near.is_tied(particle)
    }

    /// Whether a grain falls side by side with those aloft.
    fn is_with_them(&self, particle: u32) -> bool {
        let body = &self.bodies[particle as usize];
        let aloft = &self.aloft;
        body.mode == Mode::Falling
            && particle < aloft.among
            && body.since == aloft.since
            && body.velocity == aloft.velocity
    }

    /// The height of the lowest point of a grain that is aloft when heights were
    /// noted.
    fn height(&self, particle: u32) -> f64 {
        let body = &self.bodies[particle as usize];
        self.aloft.up.dot(&body.position) - body.radius
    }

    /// When a grain that is aloft lands, as far as is known now.
    pub(super) fn landing(&self, particle: u32) -> Time {
        self.aloft.landing(self.height(particle)).max(self.clock)
    }

    /// The same for the one that has to be looked after; never for all others.
    pub(super) fn next_landing(&self, particle: u32) -> Time {
        match self.aloft.waiting.last() {
            Some((_, lowest)) if *lowest == particle => self.landing(particle),
            _ => Time::NEVER,
        }
    }

    /// How high a grain that is not aloft gets as long as its list is good, or as it lies
    /// there without one.
    fn top(&self, particle: u32) -> f64 {
        let (near, body) = (&self.near, &self.bodies[particle as usize]);
        if near.is_tied(particle) {
            self.aloft.up.dot(&near.anchor(particle)) + near.reach(particle)
        } else {
            self.aloft.up.dot(&body.position) + body.radius
        }
    }

    /// Lets the ceiling be above a grain that has been tied or laid down, or falls no
    /// more.
    #[inline]
    pub(super) fn stay_below(&mut self, particle: u32) {
        if !self.aloft.is_empty() && !self.is_with_them(particle) {
            let top = self.top(particle);
            if top > self.aloft.ceiling {
                self.aloft.ceiling = top;
                self.aloft.risen = true;
            }
        }
    }

    /// Whether those who are aloft and everybody else are where they have to be.
    pub(super) fn check_aloft(&self, particle: u32) -> Result<(), String> {
        if self.is_aloft(particle) {
            let own = (self.height(particle), particle);
            let waiting = &self.aloft.waiting;
            if waiting.binary_search_by(|it| from_above(it, &own)).is_err() {
                return Err(format!(
                    "grain {particle} moves without a list, and does not wait at {} d",
                    own.0
                ));
            }
            if self.near.is_found(particle) {
                return Err(format!("grain {particle} is aloft and in the grid"));
            }
        } else if !self.aloft.is_empty()
            && !self.is_with_them(particle)
            && self.top(particle) > self.aloft.ceiling
        {
            return Err(format!("grain {particle} is above the ceiling"));
        }
        Ok(())
    }

    pub(super) fn save_aloft(&self) -> Option<SavedAloft<D>> {
        (!self.aloft.is_empty()).then_some(SavedAloft {
            velocity: self.aloft.velocity,
            among: self.aloft.among,
            since: self.aloft.since,
            ceiling: self.aloft.ceiling,
        })
    }

    /// Calls `visit` for every grain whose centre may be nearer to that of
    /// `particle` than `distance`, in d, and for some that are not; itself left
    /// out.
    pub(super) fn for_each_within<M: Model<D>>(
        &self,
        model: &M,
        particle: u32,
        distance: f64,
        mut visit: impl FnMut(Found<D>),
    ) {
        let here = self.particle_now(model, particle).position;
        self.near
            .for_each_within(particle, &here, distance, &mut visit);
        if self.aloft.is_empty() {
            return;
        }
        let fallen = self.aloft.fallen(self.clock);
        // Leaves room for rounding.
        let reach = distance + 1.0e-3 * self.aloft.margin;
        // Heights are those of lowest points.
        let level = self.aloft.up.dot(&here) + fallen;
        let (lowest, highest) = (level - reach - 0.5 * self.largest, level + reach);
        let waiting = &self.aloft.waiting;
        let begin = waiting.partition_point(|(height, _)| *height > highest);
        let end = waiting.partition_point(|(height, _)| *height >= lowest);
        for &(_, other) in &waiting[begin..end] {
            if other != particle && self.is_aloft(other) {
                let there = self.particle_now(model, other).position;
                for_each_image(model.boundary(), &(there - here), reach, |turns| {
                    visit(Found {
                        particle: other,
                        turns,
                    });
                });
            }
        }
    }
}

/// Calls `visit` for every image of a vector that is not longer than `reach` along
/// any axis.
fn for_each_image<B: Boundary<D>, const D: usize>(
    boundary: &B,
    apart: &Vector<D>,
    reach: f64,
    visit: impl FnMut([i32; D]),
) {
    let (mut low, mut high) = ([0; D], [0; D]);
    for axis in 0..D {
        if let Some(period) = boundary.period(axis) {
            low[axis] = libm::ceil((-reach - apart[axis]) / period.length) as i32;
            high[axis] = libm::floor((reach - apart[axis]) / period.length) as i32;
            // Nobody asks for images farther than a period away.
            let nearest = libm::rint(-apart[axis] / period.length) as i32;
            low[axis] = low[axis].max(nearest.saturating_sub(2));
            high[axis] = high[axis].min(nearest.saturating_add(2));
        } else if apart[axis].abs() > reach {
            return;
        }
    }
    for_each_turns(low, high, visit);
}

impl<M: Model<D>, const D: usize> Simulation<M, D> {
    /// Lifts off all grains that fall side by side high above everything else, and
    /// ties those that fall otherwise: at the start, when everybody else is tied.
    pub(super) fn lift_off(&mut self) {
        let waiting = self.high_above().unwrap_or_else(|| {
            self.world.aloft = Aloft::nobody();
            Vec::new()
        });
        let mut lifted = vec![false; self.world.bodies.len()];
        for &(_, particle) in &waiting {
            lifted[particle as usize] = true;
        }
        for (particle, lifted) in (0..).zip(&lifted) {
            if !lifted && self.world.bodies[particle as usize].mode == Mode::Falling {
                self.tie_if_moving(particle);
            }
        }
        if !waiting.is_empty() {
            // Not before: up to here the grid tells who overlaps.
            let near = &mut self.world.near;
            near.leave_out(|particle| lifted[particle as usize]);
        }
        self.world.aloft.wait(waiting);
        self.expect_landing();
    }

    /// Who falls side by side high above everything else, with their heights.
    fn high_above(&mut self) -> Option<Vec<(f64, u32)>> {
        let count = self.world.bodies.len() as u32;
        let falls = |body: &&Body<D>| body.mode == Mode::Falling;
        let velocity = self.world.bodies.iter().find(falls)?.velocity;
        if M::Dynamics::GROWS {
            return None;
        }
        let (boundary, now) = (self.model.boundary(), self.world.clock);
        let largest = self.world.near.largest();
        self.world.aloft = Aloft::falling(boundary, &velocity, now, count, largest)?;
        let mut falling = Vec::new();
        let mut ceiling = f64::NEG_INFINITY;
        for particle in 0..count {
            if self.world.is_with_them(particle) {
                let flight = self.world.flight(&self.model, particle);
                let frame = self.model.predictor().frame(&flight);
                if frame != Some(Vector::zeros()) || flight.start_velocity() != velocity {
                    // Not uniform, or not as fast as it is said to be.
                    return None;
                }
                falling.push((self.world.height(particle), particle));
            } else {
                self.tie_if_moving(particle);
                ceiling = ceiling.max(self.world.top(particle));
            }
        }
        self.world.aloft.ceiling = ceiling;
        let least = ceiling + 2.0 * self.world.aloft.margin;
        falling.retain(|(height, _)| *height > least);
        // Where there is nobody to fall upon they are better looked after one by one.
        (falling.len() >= FEW && ceiling.is_finite()).then_some(falling)
    }

    /// A grain that was aloft comes down to where others are.
    pub(super) fn land(&mut self, particle: u32) {
        self.counts.transfer += 1;
        self.tie(particle);
        self.predict_listed(particle);
        self.expect_landing();
    }

    /// Sees to it that the lowest one aloft lands in time.
    pub(super) fn expect_landing(&mut self) {
        self.world.aloft.risen = false;
        while let Some(&(_, lowest)) = self.world.aloft.waiting.last() {
            if self.world.is_aloft(lowest) {
                self.find_renewal(lowest);
                self.enqueue(lowest);
                return;
            }
            self.world.aloft.waiting.pop();
        }
        self.world.aloft = Aloft::nobody();
    }

    /// Those aloft as they were saved.
    ///
    /// # Errors
    ///
    /// Says what does not fit.
    pub(super) fn restore_aloft(
        &mut self,
        saved: Option<SavedAloft<D>>,
    ) -> Result<(), &'static str> {
        let Some(saved) = saved else {
            return Ok(());
        };
        let largest = self.world.near.largest();
        let boundary = self.model.boundary();
        let SavedAloft {
            velocity,
            since,
            among,
            ceiling,
        } = saved;
        let aloft = Aloft::falling(boundary, &velocity, since, among, largest);
        let Some(aloft) = aloft.filter(|_| ceiling.is_finite()) else {
            return Err("those aloft do not fall");
        };
        self.world.aloft = Aloft { ceiling, ..aloft };
        let mut falling = Vec::new();
        for particle in 0..self.world.bodies.len() as u32 {
            if self.world.is_aloft(particle) {
                if !self.world.is_with_them(particle) {
                    return Err("somebody aloft does not fall with the others");
                }
                falling.push((self.world.height(particle), particle));
            }
        }
        self.world.aloft.wait(falling);
        Ok(())
    }
}

/// The order in which those aloft wait: the lowest comes last.
fn from_above(one: &(f64, u32), other: &(f64, u32)) -> Ordering {
    other.0.total_cmp(&one.0).then(other.1.cmp(&one.1))
}

impl<const D: usize> Aloft<D> {
    fn wait(&mut self, mut falling: Vec<(f64, u32)>) {
        falling.sort_by(from_above);
        self.waiting = falling;
    }
}
