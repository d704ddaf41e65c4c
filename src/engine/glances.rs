//! Grains as bounds see them: all at one instant, in uniform motion.
//!
//! Flights of one [frame](crate::model::Predictor::frame) move uniformly as seen
//! from each other, whatever they do otherwise. So where each would be at the
//! start of an *epoch*, if nothing had come or came in its way, is all that a
//! bound needs: no flights have to be brought to one instant first.
//!
//! A glance follows from the grain's state, the epoch and the place it is filed
//! under, if it has a list: a simulation that is restored has the same. Who has none is
//! at rest or aloft, and looked at in other ways.

use std::hint::black_box;

use wide::f64x4;

use crate::engine::body::{LONG_AGO, World, flight_of, rounding};
use crate::engine::sparse::Sparse;
use crate::model::{Dynamics, Flight, LANES, Model, Motion, Predictor};
use crate::particle::{Mode, ParticleId, Vector};
use crate::time::Time;

/// How long an epoch is good for, in √(d/g).
const EPOCH: f64 = 0.5 * LONG_AGO;

/// No place that is known to no more than this, in d, is of use.
const SHARP: f64 = 1.0e-9;

/// Covers the rounding of all that is done here, over the sizes it is done
/// with: 128 u.
const ROUND: f64 = 64.0 * f64::EPSILON;

/// A grain at the start of the epoch.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Glance<const D: usize> {
    /// In the image that lies in the grid, in d.
    place: Vector<D>,
    velocity: Vector<D>,
    /// At t = 0, in d.
    radius: f64,
    /// When it is predicted anew, from the epoch.
    bound: f64,
}

impl<const D: usize> Glance<D> {
    /// Of somebody who may be anywhere.
    fn unknown() -> Self {
        Glance {
            place: Vector::repeat(f64::NAN),
            velocity: Vector::zeros(),
            radius: f64::NAN,
            bound: f64::INFINITY,
        }
    }
}

/// Grains at one instant.
#[derive(Clone, Debug)]
pub(super) struct Glances<const D: usize> {
    /// Of those that have a list and are known well enough.
    all: Sparse<Glance<D>>,
    epoch: Time,
    /// The acceleration of the frame, if there is one.
    frame: Option<Vector<D>>,
}

/// A grain that looks at others now.
pub(super) struct Onlooker<const D: usize> {
    here: Vector<D>,
    velocity: Vector<D>,
    radius: f64,
    /// Since the epoch.
    passed: f64,
    /// How far ahead something can be said of those that close.
    far: f64,
    blur: f64,
    /// How far ahead it matters.
    horizon: f64,
}

impl<const D: usize> Glances<D> {
    pub(super) fn new(count: usize, epoch: Time) -> Self {
        Glances {
            all: Sparse::new(count, Glance::unknown()),
            epoch,
            frame: None,
        }
    }

    pub(super) fn epoch(&self) -> Time {
        self.epoch
    }

    /// Adds a grain of whom nothing is known yet.
    pub(super) fn add(&mut self) {
        self.all.push();
    }

    pub(super) fn forget_last(&mut self) {
        self.all.pop();
    }

    /// Notes until when a grain is left alone.
    #[inline]
    pub(super) fn set_bound(&mut self, particle: u32, bound: Time) {
        let bound = self.offset(bound);
        if let Some(glance) = self.all.own(particle) {
            glance.bound = bound;
        }
    }

    /// Whether a grain that is known is predicted anew before a time.
    #[inline]
    pub(super) fn is_bound_before(&self, particle: u32, time: Time) -> bool {
        time - self.epoch > self.all[particle].bound
    }

    /// A time from the epoch, or a little more.
    #[inline]
    fn offset(&self, time: Time) -> f64 {
        (time - self.epoch) * (1.0 + 4.0 * f64::EPSILON)
    }

    /// Reads how a grain is seen, to have it at hand.
    #[inline]
    pub(super) fn touch(&self, particle: u32) {
        black_box(self.all[particle].radius);
    }

    /// Whether nothing can be said of a grain.
    #[inline]
    pub(super) fn is_unknown(&self, particle: u32) -> bool {
        !self.all.has(particle)
    }
}

impl<const D: usize> World<D> {
    /// Notes a grain as it is: its state, or its image in the grid, is new.
    pub(super) fn glance<M: Model<D>>(&mut self, model: &M, particle: u32) {
        let glance = self.made(model, particle);
        let body = &self.bodies[particle as usize];
        let passed = self.glances.epoch - body.since;
        if passed.abs() > EPOCH && glance.is_some() {
            let flight = flight_of(model, particle, body);
            let rounding = rounding(&flight, passed.abs() + EPOCH);
            self.blur = self.blur.max(2.0 * rounding);
        }
        match glance {
            Some(glance) => *self.glances.all.make(particle) = glance,
            None => self.glances.all.clear(particle),
        }
    }

    /// Begins a new epoch: all who have a list as they would be now.
    pub(super) fn begin_epoch<M: Model<D>>(&mut self, model: &M, epoch: Time) {
        let still = Motion {
            id: ParticleId(0),
            position: Vector::zeros(),
            velocity: Vector::zeros(),
            mode: Mode::Normal,
        };
        let flight = model.dynamics().flight(&still, epoch);
        self.glances.frame = model.predictor().frame(&flight);
        self.glances.epoch = epoch;
        let tied: Vec<u32> = self.near.tied().collect();
        for particle in tied {
            self.glance(model, particle);
        }
    }

    /// Whether two grains are known to move uniformly as seen from each other.
    #[inline]
    pub(super) fn see_each_other(&self, one: u32, other: u32) -> bool {
        !self.glances.is_unknown(one) && !self.glances.is_unknown(other)
    }

    /// Whether the epoch is still good.
    #[inline]
    pub(super) fn is_current(&self) -> bool {
        self.clock - self.glances.epoch <= EPOCH
    }

    /// A grain that is to look at others; nothing if it can't from afar.
    #[inline(always)]
    pub(super) fn onlooker(&self, particle: u32, horizon: Time) -> Option<Onlooker<D>> {
        let own = &self.glances.all[particle];
        let passed = self.clock - self.glances.epoch;
        if own.radius.is_nan() || !(0.0..=EPOCH).contains(&passed) {
            return None;
        }
        let bent = self
            .glances
            .frame
            .is_some_and(|pull| pull != Vector::<D>::zeros());
        let horizon = horizon - self.clock;
        Some(Onlooker {
            here: own.place + own.velocity * passed,
            velocity: own.velocity,
            radius: own.radius,
            passed,
            far: if bent { EPOCH } else { f64::INFINITY },
            blur: self.blur,
            // So that what never comes is late.
            horizon: horizon.min(f64::MAX),
        })
    }
}

impl<const D: usize> World<D> {
    /// How a grain with a list is seen, if it is known well enough and moves in the
    /// frame; its bound is that of one to be predicted anew.
    fn made<M: Model<D>>(&self, model: &M, particle: u32) -> Option<Glance<D>> {
        let body = &self.bodies[particle as usize];
        let flight = flight_of(model, particle, body);
        let passed = self.glances.epoch - body.since;
        let seen = !M::Dynamics::GROWS
            && self.near.is_tied(particle)
            && self.glances.frame.is_some()
            && model.predictor().frame(&flight) == self.glances.frame;
        if !seen || (passed.abs() > EPOCH && rounding(&flight, passed.abs() + EPOCH) > SHARP) {
            return None;
        }
        let then = flight.advanced(passed);
        Some(Glance {
            place: then.start() - self.near.home_shift(particle),
            velocity: then.start_velocity(),
            radius: body.radius,
            bound: f64::INFINITY,
        })
    }

    /// Whether a grain is as it was said to be.
    pub(super) fn check_glance<M: Model<D>>(
        &self,
        model: &M,
        particle: u32,
        bound: Time,
    ) -> Result<(), String> {
        let known = &self.glances.all[particle];
        let made = self.made(model, particle).unwrap_or_else(Glance::unknown);
        let bits = |v: &Vector<D>| v.map(f64::to_bits);
        let same = bits(&known.place) == bits(&made.place)
            && bits(&known.velocity) == bits(&made.velocity)
            && known.radius.to_bits() == made.radius.to_bits();
        let mut least = made;
        least.bound = self.glances.offset(bound);
        if !same || known.bound < bound - self.glances.epoch {
            return Err(format!(
                "grain {particle} is seen as {known:?}, not {least:?}"
            ));
        }
        Ok(())
    }
}

impl<const D: usize> Glances<D> {
    /// For four grains a time before which the onlooker certainly does not meet
    /// them, and who of them, one bit each, may come before the horizon and
    /// before they are predicted anew. Those that are unknown may at once.
    #[inline(always)]
    pub(super) fn not_before(
        &self,
        own: &Onlooker<D>,
        few: [u32; LANES],
        shifts: Option<[Vector<D>; LANES]>,
    ) -> (f64x4, u32) {
        let few = few.map(|other| &self.all[other]);
        let (mut squared, mut b, mut a) = (f64x4::ZERO, f64x4::ZERO, f64x4::ZERO);
        for axis in 0..D {
            let place = f64x4::new(few.map(|other| other.place[axis]));
            let velocity = f64x4::new(few.map(|other| other.velocity[axis]));
            let mut apart = velocity.mul_add(f64x4::splat(own.passed), place) - own.here[axis];
            if let Some(shifts) = &shifts {
                apart += f64x4::new(shifts.map(|shift| shift[axis]));
            }
            let velocity = velocity - own.velocity[axis];
            squared = apart.mul_add(apart, squared);
            b = apart.mul_add(velocity, b);
            a = velocity.mul_add(velocity, a);
        }
        let distance = f64x4::new(few.map(|other| other.radius)) + (own.radius + own.blur);
        let contact = distance * distance;
        let c0 = squared * (1.0 - 9.0 * ROUND) - contact * (1.0 + 4.0 * ROUND);
        let discriminant = b * b * (1.0 + ROUND) - a * c0;
        // No number if they do not meet, and not looked at then.
        let root = discriminant.sqrt();
        let never = f64x4::splat(f64::INFINITY);
        let meets = b.simd_lt(f64x4::ZERO) & discriminant.simd_ge(f64x4::ZERO);
        let time = meets.bitselect(c0 / (root - b) * (1.0 - ROUND), never);
        let time = c0.simd_gt(f64x4::ZERO) & time.fast_min(f64x4::splat(own.far));
        // What opens never closes; nor can the rounding of its velocities, which
        // is far less than the blur, make it.
        let margin = (squared + a + 1.0) * (own.blur + ROUND);
        let time = b.simd_gt(margin).bitselect(never, time);
        let left_alone = f64x4::new(few.map(|other| other.bound)) - own.passed;
        let late = time.simd_gt(left_alone.fast_min(f64x4::splat(own.horizon)));
        (time, !late.to_bitmask() & 0b1111)
    }
}
