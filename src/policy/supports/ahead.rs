//! When a support will be lost: what there is to check between changes.

use crate::model::{Commands, GravityCourse, SHORTEST_WAIT, Surroundings};
use crate::particle::{Mode, ParticleId, Vector};
use crate::policy::supports::{Check, CheckDue, EDGE, Supports, WALL_RANGE};
use crate::time::Time;

/// Supports that move no faster than this, in √(gd), over the ground rest on it.
const AT_REST: f64 = 1.0e-9;

/// Part of a step of gravity that is taken for rounding.
const ROUND: f64 = 1.0e-9;

impl Supports {
    /// A grain has just been found to lie on these: it leans on them, and its next
    /// check is asked for.
    pub(super) fn settle_down<const D: usize, S: Surroundings<D>>(
        &mut self,
        check: Check<'_>,
        id: ParticleId,
        near: &S,
        commands: &mut Commands<CheckDue>,
    ) {
        for &supporter in &self.below {
            commands.lean_on(id, supporter);
        }
        for &brace in &self.above {
            // Out there it has left the range of the check, smaller by EDGE.
            commands.lean_within(id, brace, check.support_range);
        }
        if self.below.len() + self.above.len() + self.walls as usize > 0 {
            self.look_ahead(check, id, near, commands);
        } else if check.unsupported_wakes {
            // At once; but who is caught where nobody holds it, and put to sleep
            // again and again, is to get on.
            let now = near.time();
            let again = |last: Time| now - last < check.interval;
            let wait = if self.unsupported.is_some_and(again) {
                check.interval
            } else {
                0.0
            };
            self.unsupported = Some(now);
            commands.schedule(id, wait, self.next_check());
        }
    }

    /// Asks for the next check at the instant at which gravity leaves a support.
    pub(super) fn look_ahead<const D: usize, S: Surroundings<D>>(
        &self,
        check: Check<'_>,
        id: ParticleId,
        near: &S,
        commands: &mut Commands<CheckDue>,
    ) {
        let wait = self.gravity_leaves_after(check, id, near);
        if wait.is_finite() {
            commands.schedule(id, wait.max(SHORTEST_WAIT), self.next_check());
        }
    }

    /// How long until a support is no longer below under the gravity of then; the
    /// interval of the clock if that can't be foreseen.
    fn gravity_leaves_after<const D: usize, S: Surroundings<D>>(
        &self,
        check: Check<'_>,
        id: ParticleId,
        near: &S,
    ) -> f64 {
        let course = near.gravity_course();
        if course == GravityCourse::Unknown {
            return check.interval;
        }
        let (now, gravity) = (near.time(), near.gravity());
        let leaves = |offset: &Vector<D>| leaves_after(&course, offset, &gravity, now);
        let mut wait = f64::INFINITY;
        near.for_each_neighbour(id, check.range(), |other| {
            if self.below.binary_search(&other.id).is_ok() {
                let foreseen = if other.mode == Mode::Fixed && moves(other.id, near) {
                    check.interval
                } else {
                    leaves(&other.offset)
                };
                wait = wait.min(foreseen);
            }
        });
        if check.walls_count && self.walls > 0 {
            let carried = near.ground_velocity(id).norm_squared() > 0.0;
            near.for_each_wall(id, WALL_RANGE, |wall| {
                let offset = -wall.normal;
                if check.is_below(&offset, &gravity) {
                    let foreseen = if wall.speed > 0.0 || carried {
                        check.interval
                    } else {
                        leaves(&offset)
                    };
                    wait = wait.min(foreseen);
                }
            });
        }
        wait
    }
}

/// Whether a static grain moves over the ground.
fn moves<const D: usize, S: Surroundings<D>>(id: ParticleId, near: &S) -> bool {
    let over_ground = near.particle(id).velocity - near.ground_velocity(id);
    over_ground.norm_squared() > AT_REST * AT_REST
}

/// How long until what lies at `offset` from a grain, at rest over the ground, is
/// below it no more, its cosine to gravity being down to half of [`EDGE`].
///
/// With gravity that turns by θ = ωt in a plane, from **g** now,
///
/// **o**·**g**(t) = C + A cos θ + B sin θ,
///
/// A and B being **o**·**g** and **o**·**g**⟂ in that plane and C along the other
/// axes; so the first root is at θ = atan2(B, A) + acos((½ EDGE o g − C)/√(A² + B²)),
/// or there is none.
fn leaves_after<const D: usize>(
    course: &GravityCourse,
    offset: &Vector<D>,
    gravity: &Vector<D>,
    now: Time,
) -> f64 {
    let (rate, [from, to], step) = match *course {
        GravityCourse::Constant | GravityCourse::Unknown => return f64::INFINITY,
        GravityCourse::Turning { rate, plane } => (rate, plane, None),
        GravityCourse::Stepped { rate, plane, step } => (rate, plane, Some(step)),
    };
    let along = offset[from] * gravity[from] + offset[to] * gravity[to];
    let across = offset[to] * gravity[from] - offset[from] * gravity[to];
    let mut steady = 0.0;
    for axis in (0..D).filter(|&axis| axis != from && axis != to) {
        steady += offset[axis] * gravity[axis];
    }
    let across = if rate < 0.0 { -across } else { across };
    let size = (along * along + across * across).sqrt();
    let edge = 0.5 * EDGE * (offset.norm_squared() * gravity.norm_squared()).sqrt();
    let cosine = (edge - steady) / size;
    if size == 0.0 || cosine.is_nan() || cosine < -1.0 {
        return f64::INFINITY;
    }
    let angle = libm::atan2(across, along) + libm::acos(cosine.min(1.0));
    let angle = angle.max(0.0);
    let Some(step) = step else {
        return angle / rate.abs();
    };
    // At the first step that turns it as far.
    let steps = libm::ceil(angle / (rate.abs() * step) - ROUND).max(1.0);
    Time::from_units((now.multiples_reached(step) + steps) * step) - now
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::TurningGravity;
    use crate::model::Dynamics;
    use proptest::prelude::*;

    fn vector(of: std::ops::Range<f64>) -> impl Strategy<Value = Vector<3>> {
        let component = move || of.clone();
        (component(), component(), component()).prop_map(|(x, y, z)| Vector::<3>::new(x, y, z))
    }

    /// When o·g is down to nothing for the first time, from gravity itself: the
    /// first of many short steps in which it is, halved until it is found.
    fn searched(
        dynamics: &TurningGravity<3>,
        offset: &Vector<3>,
        now: f64,
        end: f64,
    ) -> Option<f64> {
        let lower = |after: f64| {
            let gravity = dynamics.gravity(Time::from_units(now + after));
            offset.dot(&gravity)
        };
        let steps = 40_000;
        let (mut early, mut late) = (1..=steps)
            .map(|step| {
                let at = |step: u32| end * f64::from(step) / f64::from(steps);
                (at(step - 1), at(step))
            })
            .find(|(_, late)| lower(*late) <= 0.0)?;
        for _ in 0..60 {
            let middle = 0.5 * (early + late);
            if lower(middle) > 0.0 {
                early = middle;
            } else {
                late = middle;
            }
        }
        Some(late)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        #[test]
        fn gravity_leaves_when_a_search_finds_that_it_does(
            offset in vector(-1.0..1.0),
            gravity in vector(-1.0..1.0),
            rate in prop_oneof![-2.0..-0.05, 0.05..2.0],
            plane in prop_oneof![Just([0, 2]), Just([1, 0]), Just([2, 1])],
            now in 0.0..50.0_f64,
        ) {
            let dynamics = TurningGravity::new(gravity, rate, plane);
            let down = dynamics.gravity(Time::from_units(now));
            prop_assume!(offset.norm() > 0.1 && offset.dot(&down) > 1.0e-3);
            let course = dynamics.gravity_course();
            let found = leaves_after(&course, &offset, &down, Time::from_units(now));
            let turn = 2.0 * core::f64::consts::PI / f64::abs(rate);
            match searched(&dynamics, &offset, now, turn) {
                // Where gravity comes near to it but slowly the instant is less sure.
                Some(wanted) => {
                    let lower = |after: f64| {
                        offset.dot(&dynamics.gravity(Time::from_units(now + after)))
                    };
                    prop_assert!(lower(found) < 1.0e-12 * offset.norm(), "{}", lower(found));
                    prop_assert!(found < wanted + 1.0e-12, "{found} is after {wanted}");
                    prop_assert!((found - wanted).abs() < 1.0e-6, "{found}, {wanted}");
                }
                None => prop_assert!(found.is_infinite() || found > turn),
            }
            // In steps: the first at which it is not below.
            let step = 0.03;
            let stepped = dynamics.in_steps(step);
            let down = stepped.gravity(Time::from_units(now));
            prop_assume!(offset.dot(&down) > 1.0e-3);
            let course = stepped.gravity_course();
            let found = leaves_after(&course, &offset, &down, Time::from_units(now));
            let first = libm::floor(now / step) + 1.0;
            let wanted = (0..4000).map(|count| (first + f64::from(count)) * step).find(|&time| {
                offset.dot(&stepped.gravity(Time::from_units(time))) <= 0.0
            });
            if let Some(wanted) = wanted && found.is_finite() {
                // It may be skipped where it is left for less than a step.
                let last = now + found;
                prop_assert!(last < wanted + 1.0e-9, "{last} is after {wanted}");
            }
        }
    }
}
