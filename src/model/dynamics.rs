//! How grains fly between events.

use crate::error::SetupError;
use crate::particle::{Mode, ParticleId, Vector};
use crate::time::Time;

/// What the engine knows of a grain at the instant its flight starts.
#[derive(Clone, Copy, Debug)]
pub struct Motion<const D: usize> {
    /// Which grain; prescribed paths of fixed grains may depend on it.
    pub id: ParticleId,
    /// Centre, in d.
    pub position: Vector<D>,
    /// Velocity, in √(gd).
    pub velocity: Vector<D>,
    /// The dynamics it follows.
    pub mode: Mode,
}

/// The free motion of one grain from a given instant on.
///
/// Times are counted from the start of the flight, in √(d/g).
pub trait Flight<const D: usize>: Copy {
    /// Centre `after` the start, in d.
    fn position(&self, after: f64) -> Vector<D>;

    /// Velocity `after` the start, in √(gd).
    fn velocity(&self, after: f64) -> Vector<D>;

    /// Centre at the start, in d: `position(0.0)`, said in a way that costs
    /// nothing.
    fn start(&self) -> Vector<D> {
        self.position(0.0)
    }

    /// Velocity at the start, in √(gd): `velocity(0.0)`.
    fn start_velocity(&self) -> Vector<D> {
        self.velocity(0.0)
    }

    /// The same motion counted from `after` its start.
    fn advanced(&self, after: f64) -> Self;

    /// A bound on the speed during the first `within`, in √(gd).
    fn speed_bound(&self, within: f64) -> f64;

    /// How long it certainly stays within a distance of a place, both in d, from
    /// its start on; `None`, which is provided, if that is best told from
    /// [`speed_bound`](Flight::speed_bound).
    fn stays_within(&self, _place: &Vector<D>, _distance: f64) -> Option<f64> {
        None
    }

    /// True if the grain does not move at all: the engine then need not follow
    /// it.
    fn is_at_rest(&self) -> bool;
}

/// A flight whose position is a polynomial of time, of degree two at most.
pub trait PolynomialFlight<const D: usize>: Flight<D> {
    /// False if the acceleration is zero for every flight of this type; nothing
    /// is then computed for it.
    const ACCELERATES: bool;

    /// The constant acceleration, in g.
    fn acceleration(&self) -> Vector<D>;
}

/// Where a flight gets to in the long run: from its start by u t + s t²/2, to
/// within a radius, at any time t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift<const D: usize> {
    /// u, in √(gd).
    pub velocity: Vector<D>,
    /// s, in g.
    pub acceleration: Vector<D>,
    /// The radius, in d; infinite if nothing is known.
    pub radius: f64,
}

/// A flight under a constant acceleration and one that turns at a constant rate:
///
/// a(t) = s + p cos Ωt + p⟂ sin Ωt, with p in the plane in which it turns.
///
/// Under gravity that turns, p is gravity; a grain carried on a circle has
/// p = −Ω²ρ, ρ being the vector to it from the axis.
pub trait TurningFlight<const D: usize>: Flight<D> {
    /// s: the constant part of the acceleration, in g.
    fn steady(&self) -> Vector<D>;

    /// p: the part that turns, as it is at the start, in g.
    fn turning(&self) -> Vector<D>;

    /// Ω: how fast it turns, in √(g/d). The same for all flights of a model.
    fn rate(&self) -> f64;

    /// It turns from the first of these axes to the second. The same for all
    /// flights of a model.
    fn plane(&self) -> [usize; 2];

    /// Until when it is so, in √(d/g): what accelerates it may change at once then.
    fn changes_after(&self) -> f64 {
        f64::INFINITY
    }

    /// Where it gets to in the long run.
    fn drift(&self) -> Drift<D>;

    /// True if what accelerates the two is the same, so that they accelerate
    /// alike at all times, however their accelerations have been rounded.
    fn accelerates_like(&self, other: &Self) -> bool;
}

/// How the direction of gravity changes as seen from the ground, on which static
/// grains rest: what a policy needs to tell when a support is none any more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GravityCourse {
    /// It does not.
    Constant,
    /// It turns at a constant rate in the plane of two axes; what it has along
    /// other axes stays.
    Turning {
        /// How fast, in radians per √(d/g).
        rate: f64,
        /// From the first of these axes to the second.
        plane: [usize; 2],
    },
    /// It turns at once at each multiple of a time, by as much as it would have
    /// in that time.
    Stepped {
        /// How fast on the whole, in radians per √(d/g).
        rate: f64,
        /// From the first of these axes to the second.
        plane: [usize; 2],
        /// The time from step to step, in √(d/g).
        step: f64,
    },
    /// Nobody says.
    Unknown,
}

/// How grains fly: the equation of motion between collisions.
///
/// `examples/own_dynamics.rs` shows how to write one.
///
/// The generic type names are: `D` the dimension.
pub trait Dynamics<const D: usize> {
    /// The motion of one grain up to its next event.
    type Flight: Flight<D>;

    /// Whether diameters change in time. If false (the default)
    /// [`growth_rate`](Dynamics::growth_rate) is never asked and costs nothing.
    const GROWS: bool = false;

    /// Whether energy changes in flight: gravity that changes in time does work,
    /// and so does ground that carries frozen grains along. If false (the
    /// default) nothing is summed.
    const DRIVES: bool = false;

    /// The motion from `since` on of a grain that is as `motion` says.
    fn flight(&self, motion: &Motion<D>, since: Time) -> Self::Flight;

    /// The acceleration of gravity at `time`, in g; "down" for sleep criteria.
    fn gravity(&self, time: Time) -> Vector<D>;

    /// The velocity of what counts as being at rest at `position`, in √(gd):
    /// frozen grains have it, and thresholds are relative to it.
    fn ground_velocity(&self, _position: &Vector<D>, _time: Time) -> Vector<D> {
        Vector::zeros()
    }

    /// How gravity changes as seen from the ground. To say anything but
    /// [`GravityCourse::Unknown`], which is provided, is to promise two things:
    /// that gravity does so, and that static grains whose velocity is
    /// [`ground_velocity`](Dynamics::ground_velocity) keep it, so that they stay
    /// where they are in the ground.
    fn gravity_course(&self) -> GravityCourse {
        GravityCourse::Unknown
    }

    /// Refuses parameters that are out of range; asked once, before a
    /// simulation starts.
    ///
    /// # Errors
    ///
    /// [`SetupError`] with the parameter, its value and what is allowed.
    fn validate(&self) -> Result<(), SetupError> {
        Ok(())
    }

    /// Growth of every diameter per unit of time, as a fraction of the
    /// diameter at t = 0: σ(t) = σ(0) (1 + rate·t). Lubachevsky & Stillinger
    /// 1990, doi:10.1007/BF01025983.
    fn growth_rate(&self) -> f64 {
        0.0
    }
}
