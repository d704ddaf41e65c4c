//! Small random systems of all kinds.

use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::restless::Restless;
use super::{audit, hash_of, restart};
use crate::boundary::{Cuboid, Side};
use crate::collide::Restitution;
use crate::dynamics::{ForceFree, Growing, UniformGravity};
use crate::engine::{Guards, Settings, Simulation};
use crate::model::{Boundary, Dynamics, Parts, Place, PolynomialFlight, StatePolicy, Wall};
use crate::particle::{Mode, Particle, Vector};
use crate::policy::{Never, SelfCheck, SlowDescent};
use crate::predict::Polynomial;
use crate::time::Time;

/// What a system is made of.
pub(super) struct Case<const D: usize> {
    pub(super) what: String,
    pub(super) boundary: Cuboid<D>,
    pub(super) grains: Vec<Particle<D>>,
    /// Some of them to be inserted during the run.
    pub(super) newcomers: Vec<Particle<D>>,
    pub(super) events: u32,
    /// Moving fixed grains may crush others, so that overlaps say nothing.
    pub(super) crushes: bool,
    gravity: bool,
    growth: Option<f64>,
    policy: Policy,
    settings: Settings,
    rule: Restitution,
}

#[derive(Clone, Copy, Debug)]
enum Policy {
    Never,
    Restless(u64),
    Slow(Place, bool),
}

/// What has been seen.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Outcome {
    pub(super) events: u64,
    pub(super) sleeps: u64,
    pub(super) wakes: u64,
    pub(super) inserted: u64,
}

impl std::ops::Add for Outcome {
    type Output = Outcome;

    fn add(self, other: Outcome) -> Outcome {
        Outcome {
            events: self.events + other.events,
            sleeps: self.sleeps + other.sleeps,
            wakes: self.wakes + other.wakes,
            inserted: self.inserted + other.inserted,
        }
    }
}

fn between(rng: &mut ChaCha8Rng, least: f64, most: f64) -> f64 {
    least + (most - least) * rng.random::<f64>()
}

fn one_in(rng: &mut ChaCha8Rng, odds: u64) -> bool {
    rng.next_u64().is_multiple_of(odds)
}

fn random_vector<const D: usize>(rng: &mut ChaCha8Rng, most: f64) -> Vector<D> {
    Vector::from_fn(|_, _| between(rng, -most, most))
}

impl<const D: usize> Case<D> {
    pub(super) fn random(seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let rng = &mut rng;
        let (smallest, largest) = match rng.next_u64() % 4 {
            0 => (1.0, 1.0),
            1 => (0.7, 1.3),
            2 => (0.2, 1.0),
            _ => (0.2, 5.0),
        };
        let growth = one_in(rng, 4).then(|| between(rng, 0.01, 0.3));
        let gravity = one_in(rng, 2);
        let policy = match rng.next_u64() % 4 {
            0 => Policy::Never,
            1 => Policy::Slow(
                if one_in(rng, 4) {
                    Place::Here
                } else {
                    Place::HalfWay
                },
                one_in(rng, 2),
            ),
            _ => Policy::Restless(seed),
        };
        // Growing grains need room for themselves.
        let room = if growth.is_some() { 3.0 } else { 2.0 };
        let mut sizes = [0.0; D];
        let sides = std::array::from_fn(|axis| {
            let spare = if one_in(rng, 2) { 0.3 } else { 3.0 };
            let length = largest * between(rng, room, room + spare);
            sizes[axis] = length;
            let vertical = axis == D - 1;
            if (vertical && gravity) || one_in(rng, 4) {
                Side::Walls {
                    low: Some(0.0),
                    high: (!vertical || one_in(rng, 2)).then_some(length),
                    restitution: between(rng, 0.5, 1.0),
                }
            } else if one_in(rng, 8) {
                Side::Open
            } else if one_in(rng, 2) {
                Side::Periodic {
                    origin: -0.3,
                    length,
                }
            } else {
                Side::periodic(length)
            }
        });
        let boundary = Cuboid::new(sides).unwrap();
        let statics = rng.next_u64() % 3;
        let mut grains: Vec<Particle<D>> = Vec::new();
        // Sleepers grow, too, into each other.
        let mut crushes = growth.is_some() && (statics > 0 || !matches!(policy, Policy::Never));
        let wanted = 2 + rng.next_u64() % 12;
        for attempt in 0..40 * wanted {
            if grains.len() as u64 == wanted {
                break;
            }
            let diameter = if attempt == 0 {
                largest
            } else {
                between(rng, smallest, largest)
            };
            let position = Vector::from_fn(|axis, _| between(rng, 0.0, sizes[axis]));
            let fits_walls = boundary
                .walls()
                .iter()
                .all(|wall| wall.distance(&position, Time::ZERO) >= 0.5 * diameter);
            let fits = grains.iter().all(|other| {
                let apart = boundary.displacement(&position, &other.position).norm();
                apart >= 0.5 * (diameter + other.diameter)
            });
            if !(fits_walls && fits) {
                continue;
            }
            let mode = match rng.next_u64() % 8 {
                0 if statics > 0 => Mode::Fixed,
                // Sleepers are refused where diameters grow.
                1 | 2 if statics > 1 && growth.is_none() => Mode::Frozen,
                3 => Mode::Falling,
                _ => Mode::Normal,
            };
            let velocity = match mode {
                Mode::Frozen => Vector::zeros(),
                Mode::Fixed if one_in(rng, 2) => Vector::zeros(),
                _ if one_in(rng, 3) => Vector::zeros(),
                _ => random_vector(rng, 2.0),
            };
            crushes |= mode == Mode::Fixed && velocity != Vector::<D>::zeros();
            grains.push(
                Particle::new(position, velocity)
                    .with_mode(mode)
                    .with_diameter(diameter)
                    .with_mass(between(rng, 0.5, 2.0)),
            );
        }
        // Those that come later stand where others are now: most are refused,
        // unless these have moved away.
        let mut newcomers: Vec<_> = grains.split_off((grains.len() / 2).max(1));
        let keep = newcomers.len() / 2;
        grains.extend(newcomers.drain(..keep));
        for newcomer in &mut newcomers {
            newcomer.diameter = newcomer.diameter.min(smallest * 1.2);
        }
        let rule = if one_in(rng, 3) {
            Restitution::elastic()
        } else {
            Restitution {
                elastic_speed: 1.0e-3,
                ..Restitution::default()
            }
        };
        let guards = Guards {
            collapse: Some(500),
            ..Guards::default()
        };
        let settings = Settings {
            start: if one_in(rng, 3) && growth.is_none() {
                Time::from_units(1.0e6)
            } else {
                Time::ZERO
            },
            guards,
            ..Settings::default()
        };
        let what = format!(
            "{} grains {smallest}..{largest}, gravity {gravity}, growth {growth:?}, {policy:?}, moving fixed {crushes}, {boundary:?}",
            grains.len()
        );
        Case {
            what,
            boundary,
            grains,
            newcomers,
            events: 150,
            crushes,
            gravity,
            growth,
            policy,
            settings,
            rule,
        }
    }
}

pub(super) fn run<const D: usize>(case: &Case<D>) -> Result<Outcome, String> {
    let down = UniformGravity::<D>::down();
    match (case.gravity, case.growth) {
        (false, None) => with_dynamics(case, ForceFree),
        (true, None) => with_dynamics(case, down),
        (false, Some(rate)) => with_dynamics(case, Growing::new(ForceFree, rate)),
        (true, Some(rate)) => with_dynamics(case, Growing::new(down, rate)),
    }
}

fn with_dynamics<const D: usize, Y>(case: &Case<D>, dynamics: Y) -> Result<Outcome, String>
where
    Y: Dynamics<D> + Clone,
    Y::Flight: PolynomialFlight<D>,
{
    match case.policy {
        Policy::Never => with_policy(case, dynamics, Never),
        Policy::Restless(seed) => with_policy(case, dynamics, Restless { seed }),
        Policy::Slow(place, checks) => {
            let policy = SlowDescent {
                place,
                wall_supports: true,
                self_check: checks.then(SelfCheck::default),
                ..SlowDescent::with_threshold(1.0)
            };
            with_policy(case, dynamics, policy)
        }
    }
}

fn with_policy<const D: usize, Y, S>(
    case: &Case<D>,
    dynamics: Y,
    policy: S,
) -> Result<Outcome, String>
where
    Y: Dynamics<D> + Clone,
    Y::Flight: PolynomialFlight<D>,
    S: StatePolicy<D> + Clone,
{
    let parts = || Parts {
        dynamics: dynamics.clone(),
        predictor: Polynomial,
        collision_rule: case.rule,
        state_policy: policy.clone(),
        boundary: case.boundary.clone(),
    };
    let start = || {
        Simulation::with_settings(parts(), case.grains.clone(), case.settings)
            .map_err(|error| format!("refused: {error}"))
    };
    let events = u64::from(case.events);
    let (whole, sliced) = (
        hash_of(start()?, events, None),
        hash_of(start()?, events, Some(0.0137)),
    );
    if whole != sliced {
        return Err("the trajectory depends on stops and neighbour lists".into());
    }
    restart(case, parts, start()?, start()?)?;
    audit(case, start()?)
}
