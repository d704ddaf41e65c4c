use rand_chacha::ChaCha8Rng;

use crate::boundary::{self, Cuboid};
use crate::collide::Restitution;
use crate::dynamics::{ForceFree, Trochoid, TurningGravity, TurningGround, UniformGravity};
use crate::engine::{self, Settings};
use crate::error::SetupError;
use crate::model::{Dynamics, GravityCourse, Motion, Parts};
use crate::particle::Vector;
use crate::policy::{self, Never, SlowDescent};
use crate::predict::{Polynomial, Turning};
use crate::scenario::schema::{Phase, Rotation, Scenario, SelfCheck, Side, Turns};
use crate::setup;
use crate::time::Time;

/// The model of a scenario without gravity.
pub type FloatingModel<const D: usize> =
    Parts<ForceFree, Polynomial, Restitution, Never, Cuboid<D>>;
/// The model of a scenario in which something turns, with `S` for who sleeps and
/// wakes.
pub type TurningModel<S, const D: usize> = Parts<Drumming<D>, Turning, Restitution, S, Cuboid<D>>;

/// Gravity that turns, or the ground.
#[derive(Clone, Copy, Debug)]
pub enum Drumming<const D: usize> {
    /// Gravity, as seen from the drum.
    Gravity(TurningGravity<D>),
    /// The ground, as seen from outside.
    Ground(TurningGround<D>),
}

impl<const D: usize> Dynamics<D> for Drumming<D> {
    type Flight = Trochoid<D>;

    const DRIVES: bool = true;

    #[inline]
    fn flight(&self, motion: &Motion<D>, since: Time) -> Trochoid<D> {
        match self {
            Drumming::Gravity(dynamics) => dynamics.flight(motion, since),
            Drumming::Ground(dynamics) => dynamics.flight(motion, since),
        }
    }

    fn gravity(&self, time: Time) -> Vector<D> {
        match self {
            Drumming::Gravity(dynamics) => dynamics.gravity(time),
            Drumming::Ground(dynamics) => dynamics.gravity(time),
        }
    }

    fn ground_velocity(&self, position: &Vector<D>, time: Time) -> Vector<D> {
        match self {
            Drumming::Gravity(dynamics) => dynamics.ground_velocity(position, time),
            Drumming::Ground(dynamics) => dynamics.ground_velocity(position, time),
        }
    }

    fn gravity_course(&self) -> GravityCourse {
        match self {
            Drumming::Gravity(dynamics) => dynamics.gravity_course(),
            Drumming::Ground(dynamics) => dynamics.gravity_course(),
        }
    }

    fn validate(&self) -> Result<(), SetupError> {
        match self {
            Drumming::Gravity(dynamics) => dynamics.validate(),
            Drumming::Ground(dynamics) => dynamics.validate(),
        }
    }
}

/// The model of a scenario with gravity, and with `S` for who sleeps and wakes.
pub type GravityModel<S, const D: usize> =
    Parts<UniformGravity<D>, Polynomial, Restitution, S, Cuboid<D>>;

impl Scenario {
    /// Lower end and length of an axis that is bounded on both sides, in d, and
    /// whether it is periodic.
    #[must_use]
    pub fn lateral(&self, axis: usize) -> Option<(f64, f64, bool)> {
        match self.side(axis) {
            Side::Periodic { origin, length } => Some((origin, length, true)),
            Side::Walls {
                low: Some(low),
                high: Some(high),
                ..
            } => Some((low, high - low, false)),
            Side::Walls { .. } | Side::Open => None,
        }
    }

    /// The extent across the last axis, in d^(D−1), if that is finite and
    /// gravity points down that axis: then there may be a deposit.
    #[must_use]
    pub fn deposit_area(&self) -> Option<f64> {
        let axes = self.axes();
        if !self.gravity.is_down(axes) || self.rotation.is_some() {
            return None;
        }
        (0..axes - 1).try_fold(1.0, |area, axis| Some(area * self.lateral(axis)?.1))
    }

    /// How the engine is to work.
    #[must_use]
    pub fn settings(&self) -> Settings {
        let guards = &self.guards;
        let unless_zero = |number: u32| (number > 0).then_some(number);
        Settings {
            guards: engine::Guards {
                cascade: unless_zero(guards.cascade),
                exit_speed: guards
                    .exit_speed
                    .unwrap_or(0.1 * self.parameters.elastic_speed),
                floor_speed: guards.floor_speed,
                hold: guards.hold,
                collapse: unless_zero(guards.collapse),
            },
            sleep_horizon: self.sleep.horizon,
            ..Settings::default()
        }
    }

    /// What collisions do.
    #[must_use]
    pub fn collision_rule(&self) -> Restitution {
        Restitution {
            restitution: self.parameters.restitution,
            frozen_restitution: self.parameters.frozen_restitution,
            elastic_speed: self.parameters.elastic_speed,
            elastic_on_static: self.parameters.elastic_on_static,
        }
    }

    /// The paper's criteria as the scenario has them, whichever it names.
    #[must_use]
    pub fn slow_descent(&self) -> SlowDescent {
        let (parameters, sleep) = (&self.parameters, &self.sleep);
        SlowDescent {
            sleep_speed: parameters.sleep_speed,
            wake_speed: parameters.wake_speed.0,
            frozen_restitution: parameters.frozen_restitution,
            energy_store: sleep.energy_store,
            store_at: sleep.store_at,
            store_time: sleep.store_time,
            speed_read: sleep.speed_read,
            descent_read: sleep.descent_read,
            comparison: sleep.comparison,
            wake_read: sleep.wake_read,
            place: sleep.place,
            wall_supports: sleep.wall_supports,
            self_check: self.self_check.as_ref().map(|check| self.self_check(check)),
            keep_history: sleep.keep_history,
        }
    }

    fn self_check(&self, check: &SelfCheck) -> policy::SelfCheck {
        policy::SelfCheck {
            timing: check.timing,
            interval: check.interval,
            support_range: check.support_range,
            support_normals: check.support_normals,
            phase: match check.phase {
                Phase::Spread => policy::Phase::Spread { seed: self.seed },
                Phase::Own => policy::Phase::Own,
                Phase::Global => policy::Phase::Global,
            },
            unsupported_wakes: check.unsupported_wakes,
        }
    }

    /// The model without gravity, in which nobody sleeps.
    #[must_use]
    pub fn floating_model<const D: usize>(&self, boundary: Cuboid<D>) -> FloatingModel<D> {
        Parts {
            dynamics: ForceFree,
            predictor: Polynomial,
            collision_rule: self.collision_rule(),
            state_policy: Never,
            boundary,
        }
    }

    /// The model with gravity, in which `policy` says who sleeps and wakes.
    #[must_use]
    pub fn gravity_model<S, const D: usize>(
        &self,
        policy: S,
        boundary: Cuboid<D>,
    ) -> GravityModel<S, D> {
        let component = |axis, _| self.gravity.component(axis, D);
        Parts {
            dynamics: UniformGravity::new(Vector::from_fn(component)),
            predictor: Polynomial,
            collision_rule: self.collision_rule(),
            state_policy: policy,
            boundary,
        }
    }

    /// The model with gravity or ground that turns, in which `policy` says who
    /// sleeps and wakes.
    #[must_use]
    pub fn turning_model<S, const D: usize>(
        &self,
        rotation: &Rotation,
        policy: S,
        boundary: Cuboid<D>,
    ) -> TurningModel<S, D> {
        let gravity = Vector::from_fn(|axis, _| self.gravity.component(axis, D));
        let (rate, plane) = (rotation.angular_velocity, [0, D - 1]);
        let dynamics = match rotation.of {
            // As the drum turns one way, gravity turns the other.
            Turns::Gravity => {
                let turning = TurningGravity::new(gravity, -rate, plane);
                Drumming::Gravity(match rotation.step {
                    Some(step) => turning.in_steps(step),
                    None => turning,
                })
            }
            Turns::Ground => {
                Drumming::Ground(TurningGround::new(gravity, rate, plane, Vector::zeros()))
            }
        };
        Parts {
            dynamics,
            predictor: Turning,
            collision_rule: self.collision_rule(),
            state_policy: policy,
            boundary,
        }
    }

    /// The random numbers of the source at `index`. Each source has its own, so
    /// that changing one leaves the others as they are.
    #[must_use]
    pub fn random(&self, index: usize) -> ChaCha8Rng {
        let mut generator = setup::seeded(self.seed);
        generator.set_stream(index as u64);
        generator
    }

    /// What drops the grains that come one by one, if there are any, and the
    /// random numbers for it.
    #[must_use]
    pub fn dropper<const D: usize>(&self) -> Option<(setup::OneByOne<D>, ChaCha8Rng)> {
        let index = self
            .grains
            .iter()
            .position(|source| source.one_by_one.is_some())?;
        let drops = self.grains[index].one_by_one.as_ref()?;
        let (lengths, origin, periodic) = self.lateral_box();
        let dropper = setup::OneByOne {
            sizes: drops.sizes,
            clearance: drops.clearance,
            fall_speed: drops.fall_speed,
            lengths,
            origin,
            periodic,
        };
        Some((dropper, self.random(index)))
    }

    /// Lengths, lower corner and periods of the lateral axes; the last entries
    /// are left at 0.
    pub(super) fn lateral_box<const D: usize>(&self) -> (Vector<D>, Vector<D>, [bool; D]) {
        let mut lengths = Vector::zeros();
        let mut origin = Vector::zeros();
        let mut periodic = [false; D];
        for axis in 0..D - 1 {
            if let Some((low, length, closed)) = self.lateral(axis) {
                origin[axis] = low;
                lengths[axis] = length;
                periodic[axis] = closed;
            }
        }
        (lengths, origin, periodic)
    }

    /// The box of a run in which these axes, by origin and length, are periodic:
    /// those of a gas are not in the scenario.
    ///
    /// # Errors
    ///
    /// When a period is none.
    pub fn boundary_with<const D: usize>(
        &self,
        periods: &[Option<(f64, f64)>],
    ) -> Result<Cuboid<D>, SetupError> {
        let mut sides = self.sides::<D>();
        for (side, period) in sides.iter_mut().zip(periods) {
            if let Some((origin, length)) = *period {
                *side = boundary::Side::Periodic { origin, length };
            }
        }
        Cuboid::new(sides)
    }

    pub(super) fn sides<const D: usize>(&self) -> [boundary::Side; D] {
        std::array::from_fn(|axis| match self.side(axis) {
            Side::Open => boundary::Side::Open,
            Side::Periodic { origin, length } => boundary::Side::Periodic { origin, length },
            Side::Walls {
                low,
                high,
                restitution,
            } => boundary::Side::Walls {
                low,
                high,
                restitution,
            },
        })
    }
}
