//! From a scenario to grains, a boundary and the parts of a model.

use std::fs::File;
use std::io::BufReader;

use rand_chacha::ChaCha8Rng;

use crate::boundary::{self, Cuboid};
use crate::collide::Restitution;
use crate::dynamics::{ForceFree, UniformGravity};
use crate::engine::{self, Settings};
use crate::error::SetupError;
use crate::model::Parts;
use crate::output::{Frame, XyzReader};
use crate::particle::{Mode, Particle, Vector};
use crate::policy::{self, Never, SlowDescent};
use crate::predict::Polynomial;
use crate::scenario::error::{Problem, ScenarioError};
use crate::scenario::path::Path;
use crate::scenario::read::Origin;
use crate::scenario::schema::{
    Phase, Scenario, SelfCheck, Side, Source, SourceKind,
};
use crate::scenario::validate::MOST_GRAINS;
use crate::setup;

/// The model of a scenario without gravity.
pub type FloatingModel<const D: usize> =
    Parts<ForceFree, Polynomial, Restitution, Never, Cuboid<D>>;
/// The model of a scenario with gravity.
pub type GravityModel<const D: usize> =
    Parts<UniformGravity<D>, Polynomial, Restitution, SlowDescent, Cuboid<D>>;

/// The initial state of a scenario.
#[derive(Clone, Debug)]
pub struct Start<const D: usize> {
    /// The grains, by id.
    pub grains: Vec<Particle<D>>,
    /// Where the world ends.
    pub boundary: Cuboid<D>,
    /// For each source the id after its last grain.
    ends: Vec<usize>,
    /// The frames of grains that were read from files, by source.
    files: Vec<(usize, Frame)>,
}

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
        if !self.gravity.is_down(axes) {
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

    /// Who falls asleep and wakes.
    #[must_use]
    pub fn policy(&self) -> SlowDescent {
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

    /// The model with gravity, sleep and wake.
    #[must_use]
    pub fn gravity_model<const D: usize>(&self, boundary: Cuboid<D>) -> GravityModel<D> {
        let component = |axis, _| self.gravity.component(axis, D);
        Parts {
            dynamics: UniformGravity::new(Vector::from_fn(component)),
            predictor: Polynomial,
            collision_rule: self.collision_rule(),
            state_policy: self.policy(),
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
    fn lateral_box<const D: usize>(&self) -> (Vector<D>, Vector<D>, [bool; D]) {
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

    fn sides<const D: usize>(&self) -> [boundary::Side; D] {
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

impl<const D: usize> Start<D> {
    /// Reads and makes all grains that are there at the start.
    ///
    /// # Errors
    ///
    /// When a file can't be read, or a generator can't make what it is asked for.
    pub fn new(origin: &Origin, scenario: &Scenario) -> Result<Self, ScenarioError> {
        Start::build(origin, scenario, true)
    }

    /// Only the grains that are written out or stand in files: what can be
    /// known without making anything.
    ///
    /// # Errors
    ///
    /// When a file can't be read.
    pub fn given(origin: &Origin, scenario: &Scenario) -> Result<Self, ScenarioError> {
        Start::build(origin, scenario, false)
    }

    fn build(
        origin: &Origin,
        scenario: &Scenario,
        generate: bool,
    ) -> Result<Self, ScenarioError> {
        let sides = scenario.sides();
        let boundary = Cuboid::new(sides)
            .map_err(|error| origin.refuse(Path::root().key("boundaries"), error))?;
        let mut start = Start {
            grains: Vec::new(),
            boundary,
            ends: Vec::new(),
            files: Vec::new(),
        };
        for (index, source) in scenario.grains.iter().enumerate() {
            start.add(origin, scenario, index, source, generate)?;
            start.ends.push(start.grains.len());
            if start.grains.len() > MOST_GRAINS {
                let problem = Problem::Value {
                    found: format!("the source of grain {}", start.grains.len()),
                    allowed: format!("at most {MOST_GRAINS} grains are allowed"),
                };
                return Err(origin.refuse(source_path(index), problem).into());
            }
        }
        Ok(start)
    }

    fn add(
        &mut self,
        origin: &Origin,
        scenario: &Scenario,
        index: usize,
        source: &Source,
        generate: bool,
    ) -> Result<(), ScenarioError> {
        let Ok(kind) = source.kind() else {
            return Ok(());
        };
        let (lengths, corner, periodic) = scenario.lateral_box::<D>();
        let mut random = scenario.random(index);
        let made: Result<Vec<Particle<D>>, SetupError> = match kind {
            SourceKind::Grain(position) => Ok(vec![single(source, position)]),
            SourceKind::File(name) => {
                let frame = read_frame::<D>(origin, index, name)?;
                let grains = frame.particles();
                self.files.push((index, frame));
                Ok(grains)
            }
            SourceKind::OneByOne(_) => Ok(Vec::new()),
            _ if !generate => Ok(Vec::new()),
            SourceKind::Base(base) => {
                let mut base_of = setup::Base {
                    sizes: base.sizes,
                    lengths,
                    origin: corner,
                    periodic,
                };
                base_of.lengths[D - 1] = base.thickness;
                base_of.origin[D - 1] = base.bottom;
                base_of.grains(&mut random)
            }
            SourceKind::Rain(rain) => {
                let mut rain_of = setup::Rain {
                    count: rain.count,
                    sizes: rain.sizes,
                    packing_fraction: rain.packing_fraction,
                    fall_speed: rain.fall_speed,
                    lengths,
                    origin: corner,
                    periodic,
                };
                rain_of.origin[D - 1] = rain.bottom.unwrap_or_else(|| self.ground(scenario));
                rain_of.grains(&mut random)
            }
            SourceKind::Gas(gas) => {
                let aspect = |axis, _| gas.aspect.get(axis).copied().unwrap_or(1.0);
                let gas_of = setup::Gas {
                    count: gas.count,
                    sizes: gas.sizes,
                    packing_fraction: gas.packing_fraction,
                    temperature: gas.temperature,
                    aspect: Vector::from_fn(aspect),
                };
                gas_of.grains(&mut random).and_then(|(grains, lengths)| {
                    let sides = |axis: usize| boundary::Side::periodic(lengths[axis]);
                    self.boundary = Cuboid::new(std::array::from_fn(sides))?;
                    Ok(grains)
                })
            }
        };
        let made = made.map_err(|error| origin.refuse(source_path(index), error))?;
        self.grains.extend(made);
        Ok(())
    }

    /// The highest point of the grains so far, else the floor, else 0.
    fn ground(&self, scenario: &Scenario) -> f64 {
        let floor = match scenario.side(D - 1) {
            Side::Walls { low, .. } => low,
            Side::Open | Side::Periodic { .. } => None,
        };
        crate::analysis::highest_surface(&self.grains)
            .or(floor)
            .unwrap_or(0.0)
    }

    /// The files from which grains came: for each the source's number and what
    /// was in it.
    #[must_use]
    pub fn files(&self) -> &[(usize, Frame)] {
        &self.files
    }

    /// The source that grain `id` came from.
    #[must_use]
    pub fn source_of(&self, id: usize) -> usize {
        self.ends.partition_point(|&end| end <= id)
    }

    /// A refusal of this start for what the engine found wrong with it, told at
    /// the source of the grain in question.
    #[must_use]
    pub fn refuse(&self, origin: &Origin, error: SetupError) -> ScenarioError {
        let of = |id: crate::particle::ParticleId| source_path(self.source_of(id.index()));
        let (path, hint) = match &error {
            SetupError::Particle { id, .. } | SetupError::OutsideWall { id, .. } => (of(*id), None),
            SetupError::Overlap { first, second, .. } => {
                let hint = format!("grain {first} is of {}", of(*first));
                (of(*second), Some(hint))
            }
            SetupError::PeriodTooShort { axis, .. } => {
                (Path::root().key("boundaries").index(*axis), None)
            }
            _ => (Path::root(), None),
        };
        let mut refusal = origin.refuse(path, error);
        refusal.hint = hint;
        refusal.into()
    }
}

fn source_path(index: usize) -> Path {
    Path::root().key("grains").index(index)
}

/// The one grain that a source writes out.
fn single<const D: usize>(source: &Source, position: &[f64]) -> Particle<D> {
    let vector = |given: &[f64]| Vector::from_fn(|axis, _| given.get(axis).copied().unwrap_or(0.0));
    let diameter = source.diameter.unwrap_or(1.0);
    let mass = (0..D).fold(1.0, |mass, _| mass * diameter);
    Particle {
        position: vector(position),
        velocity: vector(source.velocity.as_deref().unwrap_or_default()),
        diameter,
        mass: source.mass.unwrap_or(mass),
        mode: source.mode.unwrap_or(Mode::Normal),
    }
}

/// The last frame of a file that source `index` names.
fn read_frame<const D: usize>(
    origin: &Origin,
    index: usize,
    name: &str,
) -> Result<Frame, ScenarioError> {
    let path = origin.folder.join(name);
    let opened = File::open(&path).map_err(|source| ScenarioError::Unreadable {
        file: path.display().to_string(),
        source,
    })?;
    let at = || source_path(index).key("file");
    let frame = XyzReader::new(BufReader::new(opened))
        .last_frame()
        .map_err(|error| origin.refuse(at(), error))?;
    if D == 2 && frame.grains.iter().any(|grain| grain.position[2] != 0.0) {
        let problem = Problem::Value {
            found: "a file of grains that do not lie in the plane z = 0".to_owned(),
            allowed: "in two dimensions they have to".to_owned(),
        };
        return Err(origin.refuse(at(), problem).into());
    }
    Ok(frame)
}
