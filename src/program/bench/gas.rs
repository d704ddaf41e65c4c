//! `grainfall bench gas`: collisions of elastic equal spheres.

use std::f64::consts::PI;

use serde::Serialize;

use crate::analysis::carnahan_starling;
use crate::boundary::{Cuboid, Side};
use crate::collide::Restitution;
use crate::dynamics::ForceFree;
use crate::engine::{Guards, Limits, Settings, Simulation};
use crate::model::Parts;
use crate::observe::TrajectoryHash;
use crate::particle::{Particle, Vector};
use crate::policy::Never;
use crate::predict::Polynomial;
use crate::program::bench::arguments::{GasArguments, GasStart};
use crate::program::bench::memory::Memory;
use crate::program::error::ProgramError;
use crate::program::processor::ProcessorClock;
use crate::program::progress::Progress;
use crate::program::rain::MANY;
use crate::program::show::say_result;
use crate::program::timing::timed;
use crate::setup::{Crystal, Gas, seeded, sort_in_space};
use crate::time::Time;

/// The gas of a simulation.
pub(super) type Elastic = Parts<ForceFree, Polynomial, Restitution, Never, Cuboid<3>>;

/// A gas, and how it is measured.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plan {
    pub(super) count: usize,
    pub(super) packing_fraction: f64,
    pub(super) start: GasStart,
    pub(super) seed: u64,
    /// Time before the timed part.
    pub(super) equilibrate: f64,
    /// Collisions in each timed part.
    pub(super) collisions: u64,
    /// Timed parts.
    pub(super) repeats: u64,
}

impl Plan {
    fn of(arguments: &GasArguments) -> Self {
        let count = arguments
            .count
            .unwrap_or(if arguments.quick { 1372 } else { 10_976 });
        let fraction = arguments.packing_fraction;
        let share = if arguments.quick { 0.5 } else { 1.0 };
        Plan {
            count,
            packing_fraction: fraction,
            start: arguments.start,
            seed: arguments.seed,
            equilibrate: arguments
                .equilibrate
                .unwrap_or_else(|| share * usual_equilibration(count, fraction)),
            collisions: arguments.collisions.unwrap_or(if arguments.quick {
                20_000
            } else {
                usual_collisions(count)
            }),
            repeats: arguments.repeats,
        }
    }

    /// The grains and the edges of their box.
    fn grains(&self) -> Result<(Vec<Particle<3>>, Vector<3>), ProgramError> {
        let mut rng = seeded(self.seed);
        match self.start {
            GasStart::Crystal => {
                let cells = Crystal::cells_of(self.count).ok_or_else(|| {
                    let (below, above) = Crystal::counts_around(self.count);
                    ProgramError::CrystalCount {
                        count: self.count,
                        below,
                        above,
                    }
                })?;
                let crystal = Crystal {
                    cells,
                    packing_fraction: self.packing_fraction,
                    temperature: 1.0,
                };
                Ok(crystal.grains(&mut rng)?)
            }
            GasStart::Fluid => {
                let gas = Gas::<3> {
                    count: self.count,
                    packing_fraction: self.packing_fraction,
                    ..Gas::default()
                };
                Ok(gas.grains(&mut rng)?)
            }
        }
    }

    /// The gas in motion.
    fn simulation(&self, memory: &Memory) -> Result<Simulation<Elastic, 3>, ProgramError> {
        let (mut grains, edges) = self.grains()?;
        if grains.len() > MANY {
            sort_in_space(&mut grains);
        }
        memory.forget_peak();
        let model = Parts {
            dynamics: ForceFree,
            predictor: Polynomial,
            collision_rule: Restitution::elastic(),
            state_policy: Never,
            boundary: Cuboid::new(std::array::from_fn(|axis| Side::periodic(edges[axis])))?,
        };
        // Guards are against grains that come to rest; here none does.
        let settings = Settings {
            guards: Guards::none(),
            ..Settings::default()
        };
        Ok(Simulation::with_settings(model, grains, settings)?)
    }

    /// Until the gas has forgotten how it was made.
    fn equilibrate(&self, simulation: &mut Simulation<Elastic, 3>, progress: &mut Progress) {
        let limits = Limits::until(Time::from_units(self.equilibrate));
        timed(simulation, &limits, &mut (), progress);
    }

    /// Measures it.
    pub(super) fn run(&self, progress: &mut Progress) -> Result<Outcome, ProgramError> {
        let memory = Memory::before();
        let clock = ProcessorClock::start();
        let mut simulation = self.simulation(&memory)?;
        let setup_seconds = clock.seconds();
        let energy = simulation.kinetic_energy();
        self.equilibrate(&mut simulation, progress);
        let (before, since) = (*simulation.counts(), simulation.time());
        let mut parts = Vec::new();
        for _ in 0..self.repeats {
            let limits = Limits::events(simulation.counts().total() + self.collisions);
            let (cost, _) = timed(&mut simulation, &limits, &mut (), progress);
            parts.push(cost);
        }
        let peak_bytes = memory.peak_each(self.count);
        let bytes = memory.now_each(self.count);
        parts.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
        let (least, median) = (parts[0], parts[parts.len() / 2]);
        let collisions = simulation.counts().pair - before.pair;
        let simulated = simulation.time() - since;
        let rate = 2.0 * collisions as f64 / (self.count as f64 * simulated);
        Ok(Outcome {
            benchmark: "gas",
            start: match self.start {
                GasStart::Crystal => "crystal",
                GasStart::Fluid => "fluid",
            },
            count: self.count,
            packing_fraction: self.packing_fraction,
            seed: self.seed,
            equilibrated: self.equilibrate,
            setup_seconds,
            collisions_before: before.pair,
            collisions,
            simulated_time: simulated,
            repeats: self.repeats,
            processor_seconds: parts.iter().map(|part| part.seconds).sum(),
            nanoseconds_per_collision: least.nanoseconds(),
            median_nanoseconds_per_collision: median.nanoseconds(),
            collisions_per_second: least.rate(),
            lists_made: simulation.counts().transfer - before.transfer,
            peak_bytes_per_particle: peak_bytes,
            bytes_per_particle: bytes,
            energy_drift: simulation.kinetic_energy() / energy - 1.0,
            // Exact for Maxwellian velocities of temperature 1.
            compressibility: 1.0 + rate * PI.sqrt() / 6.0,
            carnahan_starling: carnahan_starling(self.packing_fraction),
            deepest_overlap: simulation.max_overlap(),
            trajectory_hash: None,
        })
    }

    /// The hash of the timed part.
    fn hash(&self, progress: &mut Progress) -> Result<TrajectoryHash, ProgramError> {
        let mut simulation = self.simulation(&Memory::before())?;
        self.equilibrate(&mut simulation, progress);
        let mut hash = TrajectoryHash::new();
        let more = self.collisions * self.repeats;
        let limits = Limits::events(simulation.counts().total() + more);
        timed(&mut simulation, &limits, &mut hash, progress);
        Ok(hash)
    }
}

/// The times before the timed part with which other programs were measured.
pub(super) fn usual_equilibration(count: usize, packing_fraction: f64) -> f64 {
    let times = match count {
        ..30_000 => [3.0, 2.0, 1.0],
        30_000..300_000 => [1.0, 0.5, 0.1],
        _ => [0.1, 0.1, 0.03],
    };
    times[usize::from(packing_fraction > 0.2) + usize::from(packing_fraction > 0.4)]
}

pub(super) fn usual_collisions(count: usize) -> u64 {
    match count {
        ..30_000 => 300_000,
        30_000..300_000 => 500_000,
        _ => 1_000_000,
    }
}

/// What came out. Times of the fastest part, if there were several.
#[derive(Debug, Serialize)]
pub(super) struct Outcome {
    benchmark: &'static str,
    start: &'static str,
    pub(super) count: usize,
    packing_fraction: f64,
    seed: u64,
    equilibrated: f64,
    setup_seconds: f64,
    collisions_before: u64,
    pub(super) collisions: u64,
    simulated_time: f64,
    repeats: u64,
    processor_seconds: f64,
    pub(super) nanoseconds_per_collision: f64,
    median_nanoseconds_per_collision: f64,
    pub(super) collisions_per_second: f64,
    lists_made: u64,
    /// Null where it is not known.
    pub(super) peak_bytes_per_particle: Option<f64>,
    bytes_per_particle: Option<f64>,
    energy_drift: f64,
    /// Z = PV/NkT from the rate of collisions.
    compressibility: f64,
    carnahan_starling: f64,
    deepest_overlap: f64,
    trajectory_hash: Option<String>,
}

impl std::fmt::Display for Outcome {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(
            f,
            "elastic gas, {} spheres at φ = {}, from a {}",
            self.count, self.packing_fraction, self.start
        )?;
        writeln!(f, "  set-up           {:.2} s", self.setup_seconds)?;
        writeln!(
            f,
            "  before           time {}, {} collisions",
            self.equilibrated, self.collisions_before
        )?;
        writeln!(
            f,
            "  timed            {} collisions in time {:.4}: {:.3} s of processor time",
            self.collisions, self.simulated_time, self.processor_seconds
        )?;
        write!(
            f,
            "  a collision      {:.1} ns, {:.0} a second",
            self.nanoseconds_per_collision, self.collisions_per_second
        )?;
        if self.repeats > 1 {
            write!(
                f,
                " (least of {}; median {:.1} ns)",
                self.repeats, self.median_nanoseconds_per_collision
            )?;
        }
        writeln!(f)?;
        writeln!(
            f,
            "  lists made       {:.4} a collision",
            self.lists_made as f64 / self.collisions as f64
        )?;
        writeln!(
            f,
            "  memory           {}",
            bytes_of(self.peak_bytes_per_particle, self.bytes_per_particle)
        )?;
        writeln!(
            f,
            "  energy           changed by {:+.1e} of it since the start",
            self.energy_drift
        )?;
        writeln!(
            f,
            "  deepest overlap  {:.1e} d since the start",
            self.deepest_overlap
        )?;
        write!(
            f,
            "  PV/NkT           {:.3} from the rate of collisions; a fluid has {:.3} (Carnahan-Starling)",
            self.compressibility, self.carnahan_starling
        )?;
        if let Some(hash) = &self.trajectory_hash {
            write!(f, "\n  trajectory hash  {hash}")?;
        }
        Ok(())
    }
}

/// Bytes a grain, in words.
pub(super) fn bytes_of(peak: Option<f64>, now: Option<f64>) -> String {
    match (peak, now) {
        (Some(peak), Some(now)) => {
            format!("{peak:.0} bytes a grain at the peak, {now:.0} at the end")
        }
        _ => "not known".to_owned(),
    }
}

pub(super) fn measure(arguments: &GasArguments) -> Result<u8, ProgramError> {
    let plan = Plan::of(arguments);
    let mut progress = Progress::new(false, None);
    let mut outcome = plan.run(&mut progress)?;
    if arguments.hash {
        let hash = plan.hash(&mut progress)?;
        outcome.trajectory_hash = Some(format!("{:016x}", hash.value()));
    }
    progress.finish();
    say_result(&outcome, arguments.json)?;
    Ok(0)
}
