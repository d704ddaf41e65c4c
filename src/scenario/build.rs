//! From a scenario to grains, a boundary and the parts of a model.

mod crowd;
mod model;

pub use model::{Drumming, FloatingModel, GravityModel, TurningModel};

use std::fs::File;
use std::io::BufReader;

use crate::boundary::{self, Cuboid};
use crate::error::SetupError;
use crate::output::{Frame, XyzReader};
use crate::particle::{Mode, Particle, ParticleId, Vector};
use crate::scenario::build::crowd::pairs_in_reach;
use crate::scenario::error::{Problem, ScenarioError};
use crate::scenario::path::Path;
use crate::scenario::read::Origin;
use crate::scenario::schema::{Numbering, Scenario, Side, Source, SourceKind};
use crate::scenario::validate::MOST_GRAINS;
use crate::setup;

/// The most pairs of grains that are looked at before a run starts.
const MOST_PAIRS: f64 = 2.0e9;

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

    fn build(origin: &Origin, scenario: &Scenario, generate: bool) -> Result<Self, ScenarioError> {
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
        start.refuse_crowds(origin)?;
        Ok(start)
    }

    /// Refuses what would take hours to be looked through before it starts.
    fn refuse_crowds(&self, origin: &Origin) -> Result<(), ScenarioError> {
        let pairs = pairs_in_reach(&self.grains);
        if pairs <= MOST_PAIRS {
            return Ok(());
        }
        let largest = (0..self.grains.len())
            .max_by(|&a, &b| self.grains[a].diameter.total_cmp(&self.grains[b].diameter))
            .unwrap_or(0);
        let problem = Problem::Value {
            found: format!(
                "the source of grain {largest}, of diameter {}, which brings {pairs:.1e} pairs of \
                 grains within reach of each other",
                self.grains[largest].diameter
            ),
            allowed: format!(
                "at most {MOST_PAIRS:e} pairs are allowed: too many small grains beside too large \
                 ones, or too many at one place"
            ),
        };
        Err(origin
            .refuse(source_path(self.source_of(largest)), problem)
            .into())
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
            SourceKind::Drum(drum) => setup::Drum::from(*drum).grains(&mut random),
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
        let mut made = made.map_err(|error| origin.refuse(source_path(index), error))?;
        let generated = !matches!(kind, SourceKind::Grain(_) | SourceKind::File(_));
        if generated && scenario.numbering == Numbering::Space {
            setup::sort_in_space(&mut made);
        }
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
    pub fn refuse(&self, origin: &Origin, scenario: &Scenario, error: SetupError) -> ScenarioError {
        let of = |id: ParticleId| {
            let index = self.source_of(id.index());
            let path = source_path(index);
            match scenario.grains.get(index).map(Source::kind) {
                Some(Ok(SourceKind::Grain(_))) => path.key("position"),
                _ => path,
            }
        };
        let (path, hint) = match &error {
            SetupError::Particle { id, .. } => (of(*id), None),
            SetupError::OutsideWall { id, wall, .. } => {
                // Walls of one's own are not in the scenario.
                let known = origin.parts.is_none();
                let hint = wall_place(scenario, wall.index()).filter(|_| known);
                (of(*id), hint)
            }
            SetupError::Overlap { first, second, .. } => {
                let place = of(*first).to_string();
                (
                    of(*second),
                    Some(format!("grain {first} is that of {place}")),
                )
            }
            SetupError::PeriodTooShort { axis, .. } => {
                (Path::root().key("boundaries").index(*axis), None)
            }
            SetupError::Parameter { field, .. } if origin.parts.is_some() => {
                // Those of built-in parts were checked when they were read.
                let own = origin.parts.map_or("", |parts| parts.name);
                (Path::root().key("parts").key(own).key(field), None)
            }
            _ => (Path::root(), None),
        };
        let mut refusal = origin.refuse(path, error);
        refusal.hint = hint;
        refusal.into()
    }
}

/// Where in the scenario a wall stands: they are numbered axis by axis, the
/// lower before the upper.
fn wall_place(scenario: &Scenario, wall: usize) -> Option<String> {
    let walls = (0..scenario.axes()).flat_map(|axis| {
        let (low, high) = match scenario.side(axis) {
            Side::Walls { low, high, .. } => (low, high),
            Side::Periodic { .. } | Side::Open => (None, None),
        };
        let place = move |name: &str| format!("boundaries[{axis}].walls.{name}");
        let low = low.map(|_| place("low"));
        let high = high.map(|_| place("high"));
        low.into_iter().chain(high)
    });
    let place = walls.into_iter().nth(wall)?;
    Some(format!("wall {wall} is {place}"))
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
