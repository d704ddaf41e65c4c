//! The whole state of a run, to be written down and gone on from.

use nalgebra::Vector2;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use serde::{Deserialize, Serialize};

use crate::boundary::Cuboid;
use crate::engine::{SavedOf, Simulation};
use crate::model::{Boundary, Model};
use crate::observe::TrajectoryHash;
use crate::output::RunFolder;
use crate::program::drive::dropper::Dropper;
use crate::program::drive::files::{Files, SavedFiles};
use crate::program::drive::pace::{Samples, SavedSamples};
use crate::program::drive::{Run, Watch};
use crate::program::error::ProgramError;
use crate::program::means::NormalMean;
use crate::scenario::Scenario;
use crate::time::Time;

/// What is saved of a run: `None` in its place says that nothing has been set
/// up yet.
#[derive(Serialize, Deserialize)]
#[serde(bound = "")]
pub(super) struct SavedRun<M: Model<D>, const D: usize> {
    /// Origin and length of each axis that is periodic.
    periods: Vec<Option<Vector2<f64>>>,
    simulation: SavedOf<M, D>,
    hash: TrajectoryHash,
    normal: NormalMean,
    latest: Time,
    files: SavedFiles,
    samples: SavedSamples,
    dropper: Option<SavedDropper>,
    rain: u64,
    cpu_seconds: f64,
}

#[derive(Serialize, Deserialize)]
struct SavedDropper {
    seed: [u8; 32],
    stream: u64,
    position: u128,
    dropped: u64,
}

/// The state of a run for which nothing has been set up yet.
pub(in crate::program) fn nothing_yet() -> Vec<u8> {
    // How an absent value is written, whatever it would be.
    vec![0]
}

/// Why a state can't be gone on from.
pub(super) enum Unusable {
    /// It does not fit the run.
    State(String),
    /// A file could not be had.
    Program(ProgramError),
}

impl From<ProgramError> for Unusable {
    fn from(error: ProgramError) -> Self {
        Unusable::Program(error)
    }
}

fn unfit(reason: impl Into<String>) -> Unusable {
    Unusable::State(reason.into())
}

impl<M: Model<D>, const D: usize> Run<'_, M, D> {
    /// The state now. Everything in buffers goes to the disk first, for the
    /// lengths of files are part of it.
    pub(super) fn save(&mut self) -> Result<Vec<u8>, ProgramError> {
        let files = self.files.save(self.watch.log.as_mut())?;
        let boundary = self.simulation.model().boundary();
        let periods = (0..D).map(|axis| {
            let period = boundary.period(axis)?;
            Some(Vector2::new(period.origin, period.length))
        });
        let dropper = self.dropper.as_ref().map(|dropper| SavedDropper {
            seed: dropper.random.get_seed(),
            stream: dropper.random.get_stream(),
            position: dropper.random.get_word_pos(),
            dropped: dropper.dropped as u64,
        });
        let saved = Some(SavedRun::<M, D> {
            periods: periods.collect(),
            simulation: self.simulation.save(),
            hash: self.watch.hash,
            normal: self.watch.normal.clone(),
            latest: self.watch.latest,
            files,
            samples: self.samples.save(),
            dropper,
            rain: self.rain as u64,
            cpu_seconds: self.cpu_seconds(),
        });
        postcard::to_stdvec(&saved)
            .map_err(|error| ProgramError::io("checkpoint")(std::io::Error::other(error)))
    }
}

impl<M: Model<D>, const D: usize> SavedRun<M, D> {
    /// Reads a state; `None` if nothing had been set up.
    pub(super) fn read(state: &[u8]) -> Result<Option<Self>, Unusable> {
        match postcard::take_from_bytes(state) {
            Ok((saved, [])) => Ok(saved),
            Ok(_) => Err(unfit("more is in it than there should be")),
            Err(error) => Err(unfit(format!("its content cannot be read: {error}"))),
        }
    }

    /// The box of the run: the lengths of a gas's are not those of the scenario.
    fn boundary(&self, scenario: &Scenario) -> Result<Cuboid<D>, Unusable> {
        let periods: Vec<_> = self
            .periods
            .iter()
            .map(|period| period.map(|period| (period[0], period[1])))
            .collect();
        scenario
            .boundary_with(&periods)
            .map_err(|error| unfit(error.to_string()))
    }

    /// The run that goes on from here. Files are cut only when all else is well.
    pub(super) fn restore<'a>(
        self,
        scenario: &'a Scenario,
        folder: &RunFolder,
        model: impl FnOnce(Cuboid<D>) -> M,
    ) -> Result<Run<'a, M, D>, Unusable> {
        let (simulation, dropper) = restore_system(
            self.boundary(scenario)?,
            self.simulation,
            self.dropper,
            scenario,
            model,
        )?;
        let grains = simulation.mode_counts().total();
        if !self.normal.is_of(grains) || self.rain > grains as u64 {
            return Err(unfit("its sums are not over these grains"));
        }
        let output = &scenario.output;
        let samples = Samples::restore(output.series_every, output.frames_every, &self.samples)
            .ok_or_else(|| unfit("its samples are out of order"))?;
        if !(self.cpu_seconds >= 0.0 && self.cpu_seconds.is_finite()) {
            return Err(unfit("its processor time is none"));
        }
        let (files, log) = Files::continued(folder, scenario, &self.files)?;
        Ok(Run {
            scenario,
            watch: Watch {
                hash: self.hash,
                normal: self.normal,
                latest: self.latest,
                log,
                diary: None,
            },
            rain: self.rain as usize,
            simulation,
            files,
            samples,
            dropper,
            end: super::end_of(scenario),
            resumed: true,
            cpu_before: self.cpu_seconds,
            clock: super::ProcessorClock::start(),
        })
    }
}

impl<M: Model<D>, const D: usize> SavedRun<M, D> {
    /// Only what moves: nothing of its files is touched.
    pub(super) fn restore_system(
        self,
        scenario: &Scenario,
        model: impl FnOnce(Cuboid<D>) -> M,
    ) -> Result<System<M, D>, Unusable> {
        let boundary = self.boundary(scenario)?;
        restore_system(boundary, self.simulation, self.dropper, scenario, model)
    }
}

/// What moves, and what is still to be dropped into it.
type System<M, const D: usize> = (Simulation<M, D>, Option<Dropper<D>>);

fn restore_system<M: Model<D>, const D: usize>(
    boundary: Cuboid<D>,
    simulation: SavedOf<M, D>,
    dropper: Option<SavedDropper>,
    scenario: &Scenario,
    model: impl FnOnce(Cuboid<D>) -> M,
) -> Result<System<M, D>, Unusable> {
    let simulation = Simulation::restore(model(boundary), simulation)
        .map_err(|error| unfit(error.to_string()))?;
    if *simulation.settings() != scenario.settings() {
        return Err(unfit("its settings are not those of the scenario"));
    }
    let dropper = match (Dropper::new(scenario), dropper) {
        (None, None) => None,
        (Some(dropper), Some(saved)) if saved.dropped <= dropper.count as u64 => {
            let mut random = ChaCha8Rng::from_seed(saved.seed);
            random.set_stream(saved.stream);
            random.set_word_pos(saved.position);
            Some(Dropper {
                random,
                dropped: saved.dropped as usize,
                ..dropper
            })
        }
        _ => return Err(unfit("its grains to be dropped are not the scenario's")),
    };
    Ok((simulation, dropper))
}
