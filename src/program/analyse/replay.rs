//! What needs the collisions between frames: the run is carried out again, and
//! watched, without writing to its folder.

use std::path::Path;

use crate::analysis::{Bins, Container, Stress, StressMeter};
use crate::boundary::Cuboid;
use crate::engine::{Limits, Simulation, StopReason};
use crate::model::{Boundary, Model};
use crate::observe::ForceMeter;
use crate::particle::{Mode, Particle, ParticleId, Vector, WallId};
use crate::program::error::ProgramError;
use crate::scenario::{Gravity, Origin, Scenario, Start, read};
use crate::time::Time;

/// So many intervals of time, each with a mean force and a snapshot.
pub(super) const INTERVALS: u32 = 100;

/// What is to be watched.
#[derive(Clone, Copy, Debug)]
pub(super) struct Watched<'a, const D: usize> {
    pub(super) container: Container<D>,
    /// The axis of the slabs, and these.
    pub(super) axis: usize,
    pub(super) bins: Bins,
    pub(super) from: Time,
    pub(super) to: Time,
    /// The grains at the end, if there is a frame of them.
    pub(super) frame: Option<&'a [Particle<D>]>,
}

/// Mean forces in an interval of time, in mg.
#[derive(Clone, Debug)]
pub(super) struct Forces<const D: usize> {
    /// Its middle.
    pub(super) time: f64,
    /// On the fixed grains, on those asleep, and by falling asleep.
    pub(super) fixed: Vector<D>,
    pub(super) asleep: Vector<D>,
    pub(super) by_sleep: Vector<D>,
    /// On each wall.
    pub(super) walls: Vec<Vector<D>>,
}

/// What was measured while the run went on again.
#[derive(Clone, Debug)]
pub(super) struct Replayed<const D: usize> {
    pub(super) stresses: Vec<Stress<D>>,
    pub(super) forces: Vec<Forces<D>>,
    /// From when to when it was watched.
    pub(super) from: Time,
    pub(super) to: Time,
    /// Whether it has come to the same frame; `None` if there is none to compare.
    pub(super) same: Option<bool>,
}

/// Carries out the run in a folder again and watches it.
pub(super) fn replay<const D: usize>(
    run: &Path,
    watched: &Watched<'_, D>,
) -> Result<Replayed<D>, ProgramError> {
    let refuse = |reason: &str| ProgramError::NotAnalysed {
        run: run.display().to_string(),
        reason: reason.to_owned(),
    };
    let file = run.join("scenario.toml");
    if !file.is_file() {
        return Err(refuse(
            "stress and force need the collisions between frames: the folder of a run, with its \
             scenario.toml, is wanted",
        ));
    }
    let (origin, scenario) = read(&file, Vec::new())?;
    if scenario.axes() != D {
        return Err(refuse(
            "its scenario.toml has other dimensions than its frames",
        ));
    }
    if scenario.one_by_one().is_some() {
        return Err(refuse(
            "its grains are dropped one by one, which is not carried out again for stress and force",
        ));
    }
    let policy = scenario.criterion().ok_or_else(|| {
        refuse("its sleep criterion is not a built-in one, so it can't be carried out again here")
    })?;
    let start = Start::<D>::new(&origin, &scenario)?;
    match (&scenario.gravity, &scenario.rotation) {
        (Gravity::None, _) => {
            let model = |boundary| scenario.floating_model(boundary);
            watch(run, &origin, &scenario, start, model, watched)
        }
        (_, Some(rotation)) => {
            let model = |boundary| scenario.turning_model(rotation, policy, boundary);
            watch(run, &origin, &scenario, start, model, watched)
        }
        (_, None) => {
            let model = |boundary| scenario.gravity_model(policy, boundary);
            watch(run, &origin, &scenario, start, model, watched)
        }
    }
}

fn watch<M: Model<D>, const D: usize>(
    run: &Path,
    origin: &Origin,
    scenario: &Scenario,
    mut start: Start<D>,
    model: impl FnOnce(Cuboid<D>) -> M,
    watched: &Watched<'_, D>,
) -> Result<Replayed<D>, ProgramError> {
    let grains = std::mem::take(&mut start.grains);
    let model = model(start.boundary.clone());
    let mut simulation = Simulation::with_settings(model, grains, scenario.settings())
        .map_err(|error| start.refuse(origin, scenario, error))?;
    let limits = |time| Limits {
        time,
        all_frozen: scenario.stop.all_frozen.unwrap_or(true),
        ..Limits::default()
    };
    if watched.from > simulation.time() {
        simulation.run(&limits(watched.from), &mut ());
    }
    let begun = simulation.time();
    let Watched {
        container,
        axis,
        bins,
        to,
        ..
    } = *watched;
    let meter = StressMeter::new(container, axis, bins, begun)?;
    let mut watching = (meter, ForceMeter::new(begun));
    let mut forces = Vec::new();
    let interval = (to - begun) / f64::from(INTERVALS);
    for number in 1..=INTERVALS {
        let since = simulation.time();
        watching.1 = ForceMeter::new(since);
        let until = match number {
            INTERVALS => to,
            _ => begun + interval * f64::from(number),
        };
        let why = simulation.run(&limits(until), &mut watching);
        watching.0.sample(&simulation.snapshot());
        if simulation.time() > since {
            forces.push(of_interval(&simulation, &watching.1, since));
        }
        if why != StopReason::Time {
            break;
        }
    }
    if forces.is_empty() {
        return Err(ProgramError::NotAnalysed {
            run: run.display().to_string(),
            reason: format!("nothing moves after t = {}", begun.units()),
        });
    }
    let same = watched.frame.map(|frame| {
        let grains = simulation.snapshot();
        simulation.time() == to && grains.as_slice() == frame
    });
    Ok(Replayed {
        stresses: watching.0.stresses(simulation.time()),
        forces,
        from: begun,
        to: simulation.time(),
        same,
    })
}

fn of_interval<M: Model<D>, const D: usize>(
    simulation: &Simulation<M, D>,
    meter: &ForceMeter<D>,
    since: Time,
) -> Forces<D> {
    let now = simulation.time();
    let fixed = |id: ParticleId| simulation.particle(id).mode == Mode::Fixed;
    let walls = simulation.model().boundary().walls().len() as u16;
    Forces {
        time: since.units() + 0.5 * (now - since),
        fixed: meter.on_grains(fixed, now),
        asleep: meter.on_grains(|id| !fixed(id), now),
        by_sleep: meter.by_sleep(now),
        walls: (0..walls)
            .map(|wall| meter.on_wall(WallId(wall), now))
            .collect(),
    }
}
