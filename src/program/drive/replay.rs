//! A run gone through again, in memory: nothing is written.

use std::collections::BTreeMap;

use crate::boundary::Cuboid;
use crate::engine::{Limits, Simulation, StopReason};
use crate::error::SetupError;
use crate::model::{Model, Observer, Occurrence, OccurrenceKind, Surroundings};
use crate::observe::TrajectoryHash;
use crate::particle::{Mode, Particle, ParticleId, Vector};
use crate::program::drive::dropper::Dropper;
use crate::program::drive::state::{SavedRun, Unusable};
use crate::program::drive::{Job, Watch, end_of};
use crate::program::error::ProgramError;
use crate::program::means::NormalMean;
use crate::scenario::{Scenario, Start};
use crate::time::Time;

/// A grain that is asleep again so near to where it woke, in d, need not have
/// been woken.
const SAME_PLACE: f64 = 0.05;

/// What is kept of a run that is gone through again.
#[derive(Clone, Debug, Default)]
pub(in crate::program) struct Diary {
    /// Whose changes of mode are kept.
    pub(in crate::program) grain: Option<ParticleId>,
    /// Its last change of mode: to what, and when.
    pub(in crate::program) change: Option<(Mode, Time)>,
    /// Who fell asleep last, and the velocity that was lost; the last entries are
    /// not used in the plane.
    pub(in crate::program) asleep: Option<(ParticleId, [f64; 3])>,
    /// Where those who are awake now woke.
    woken: BTreeMap<u32, [f64; 3]>,
    /// How many have woken.
    pub(in crate::program) wakes: u64,
    /// How many of them fell asleep again where they had woken.
    pub(in crate::program) false_wakes: u64,
}

fn numbers<const D: usize>(vector: &Vector<D>) -> [f64; 3] {
    std::array::from_fn(|axis| vector.as_slice().get(axis).copied().unwrap_or(0.0))
}

impl<const D: usize> Observer<D> for Diary {
    fn observe<S: Surroundings<D>>(&mut self, occurrence: &Occurrence<D>, after: &S) {
        if let Some(grain) = self.grain
            && (occurrence.particle == grain || occurrence.other == Some(grain))
        {
            let mode = after.particle(grain).mode;
            if self.change.is_none_or(|(before, _)| before != mode) {
                self.change = Some((mode, occurrence.time));
            }
        }
        let woken = match occurrence.kind {
            OccurrenceKind::Wake => occurrence.other,
            OccurrenceKind::CheckWake => Some(occurrence.particle),
            _ => None,
        };
        if let Some(woken) = woken {
            self.wakes += 1;
            let place = after.particle(woken).position;
            self.woken.insert(woken.0, numbers(&place));
        }
        if occurrence.kind == OccurrenceKind::Sleep {
            let grain = after.particle(occurrence.particle);
            let lost = occurrence.velocity - occurrence.impulse / grain.mass;
            self.asleep = Some((occurrence.particle, numbers(&lost)));
            if let Some(place) = self.woken.remove(&occurrence.particle.0) {
                let moved = Vector::<D>::from_fn(|axis, _| grain.position[axis] - place[axis]);
                let is_near = moved.norm_squared() < SAME_PLACE * SAME_PLACE;
                self.false_wakes += u64::from(is_near);
            }
        }
    }
}

/// A run gone through again.
pub(in crate::program) struct Replay<M: Model<D>, const D: usize> {
    pub(in crate::program) simulation: Simulation<M, D>,
    watch: Watch,
    dropper: Option<Dropper<D>>,
    all_frozen: bool,
    end: Time,
    events: u64,
    broke_off: bool,
}

impl<M: Model<D>, const D: usize> Replay<M, D> {
    /// From the start.
    pub(in crate::program) fn new(
        job: &Job,
        mut start: Start<D>,
        model: impl FnOnce(Cuboid<D>) -> M,
    ) -> Result<Self, ProgramError> {
        let scenario = &job.scenario;
        let grains = std::mem::take(&mut start.grains);
        let model = model(start.boundary.clone());
        let simulation = Simulation::with_settings(model, grains, scenario.settings())
            .map_err(|error| start.refuse(&job.origin, scenario, error))?;
        Ok(Replay::of(simulation, Dropper::new(scenario), scenario))
    }

    /// From what a checkpoint holds; `None` if it is unusable.
    pub(in crate::program) fn from_state(
        scenario: &Scenario,
        state: &[u8],
        model: impl FnOnce(Cuboid<D>) -> M,
    ) -> Result<Option<Self>, ProgramError> {
        let restored = match SavedRun::<M, D>::read(state) {
            Ok(None) => return Ok(None),
            Ok(Some(saved)) => saved.restore_system(scenario, model),
            Err(unusable) => Err(unusable),
        };
        match restored {
            Ok((simulation, dropper)) => Ok(Some(Replay::of(simulation, dropper, scenario))),
            Err(Unusable::State(_)) => Ok(None),
            Err(Unusable::Program(error)) => Err(error),
        }
    }

    /// From these grains, for as long as it is asked to go on.
    pub(in crate::program) fn without_end(
        model: M,
        grains: Vec<Particle<D>>,
        scenario: &Scenario,
    ) -> Result<Self, SetupError> {
        let simulation = Simulation::with_settings(model, grains, scenario.settings())?;
        let replay = Replay::of(simulation, None, scenario);
        Ok(Replay {
            end: Time::NEVER,
            events: u64::MAX,
            ..replay
        })
    }

    fn of(simulation: Simulation<M, D>, dropper: Option<Dropper<D>>, scenario: &Scenario) -> Self {
        let now = simulation.time();
        Replay {
            watch: Watch {
                hash: TrajectoryHash::new(),
                normal: NormalMean::new(&simulation.snapshot(), now),
                latest: now,
                log: None,
                diary: Some(Diary::default()),
            },
            simulation,
            dropper,
            all_frozen: scenario.stop.all_frozen.unwrap_or(true),
            end: end_of(scenario),
            events: scenario.stop.events.unwrap_or(u64::MAX),
            broke_off: false,
        }
    }

    /// Keeps the changes of a grain's mode, and the answers about it.
    pub(in crate::program) fn follow(&mut self, grain: ParticleId) {
        self.simulation.listen(grain);
        let mode = self.simulation.particle(grain).mode;
        self.watch.diary = Some(Diary {
            grain: Some(grain),
            change: Some((mode, self.simulation.time())),
            ..Diary::default()
        });
    }

    pub(in crate::program) fn diary(&self) -> Diary {
        self.watch.diary.clone().unwrap_or_default()
    }

    /// Whether it can't go on: a collapse, or a grain that has left for good.
    pub(in crate::program) fn broke_off(&self) -> bool {
        self.broke_off
    }

    /// On to a time, or until so many events have happened in all; false if the
    /// run has come to its end before.
    pub(in crate::program) fn advance(&mut self, until: Time, events: u64) -> bool {
        loop {
            let more = self.dropper.as_ref().is_some_and(Dropper::has_more);
            let limits = Limits {
                time: until.min(self.end),
                events: events.min(self.events),
                all_frozen: self.all_frozen || more,
            };
            match self.simulation.run(&limits, &mut self.watch) {
                StopReason::Time => return until <= self.end,
                StopReason::Events => return events <= self.events,
                StopReason::AllFrozen => {
                    let dropper = self.dropper.as_mut().filter(|dropper| dropper.has_more());
                    let dropped = dropper.map(|dropper| dropper.drop_into(&mut self.simulation));
                    match dropped {
                        Some(Ok(grain)) => {
                            self.watch.normal.add(&grain, self.simulation.time());
                        }
                        _ => return false,
                    }
                }
                StopReason::Collapse(_) | StopReason::Escaped(_) => {
                    self.broke_off = true;
                    return false;
                }
                StopReason::NothingLeft => return false,
            }
        }
    }
}
