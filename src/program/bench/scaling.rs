//! `grainfall bench scaling`: the cost of an event against the number of grains.

use crate::analysis::lowest_surface;
use crate::engine::{Limits, Simulation};
use crate::error::SetupError;
use crate::model::Parts;
use crate::particle::{Mode, Particle, Vector};
use crate::policy::Criterion;
use crate::program::bench::arguments::{GasStart, ScalingArguments, ScalingSubject};
use crate::program::bench::deposition::Rain;
use crate::program::bench::gas::{Plan, usual_collisions, usual_equilibration};
use crate::program::bench::memory::Memory;
use crate::program::bench::table::Table;
use crate::program::bench::timing::{Cost, timed};
use crate::program::error::ProgramError;
use crate::program::progress::Progress;
use crate::scenario::GravityModel;
use crate::setup::{Gas, seeded};
use crate::time::Time;

const COLUMNS: [&str; 7] = [
    "system",
    "grains",
    "frozen",
    "normal",
    "events",
    "nanoseconds_per_event",
    "over_the_first",
];

/// Sizes of the gas.
const GASES: [usize; 4] = [1372, 10_976, 97_556, 1_000_188];
const SMALL_GASES: [usize; 3] = [108, 256, 500];
/// Frozen grains that are put under a heap.
const BURIED: [usize; 5] = [0, 1000, 10_000, 100_000, 1_000_000];
/// The packing fraction of the gas.
const PACKING_FRACTION: f64 = 0.3;
/// How often each is timed; the least counts.
const REPEATS: u64 = 3;

pub(super) fn measure(arguments: &ScalingArguments) -> Result<u8, ProgramError> {
    let mut table = Table::new(&COLUMNS, arguments.out.as_deref())?;
    let wanted = |subject| arguments.only.is_none_or(|only| only == subject);
    if wanted(ScalingSubject::Gas) {
        gases(arguments, &mut table)?;
    }
    if wanted(ScalingSubject::Frozen) {
        heaps(arguments, &mut table)?;
    }
    Ok(0)
}

/// Collisions of a gas of fixed density.
fn gases(arguments: &ScalingArguments, table: &mut Table) -> Result<(), ProgramError> {
    let sizes: &[usize] = if arguments.quick {
        &SMALL_GASES
    } else {
        &GASES
    };
    let mut first = None;
    for &count in sizes.iter().filter(|&&count| count <= arguments.largest) {
        let plan = Plan {
            count,
            packing_fraction: PACKING_FRACTION,
            start: GasStart::Crystal,
            seed: arguments.seed,
            equilibrate: usual_equilibration(count, PACKING_FRACTION),
            collisions: if arguments.quick {
                2000
            } else {
                usual_collisions(count)
            },
            repeats: REPEATS,
        };
        let mut progress = Progress::new(false, None);
        let outcome = plan.run(&mut progress)?;
        progress.finish();
        let cost = outcome.nanoseconds_per_collision;
        table.row(&[
            "gas".to_owned(),
            count.to_string(),
            "0".to_owned(),
            count.to_string(),
            outcome.collisions.to_string(),
            format!("{cost:.1}"),
            format!("{:.3}", cost / *first.get_or_insert(cost)),
        ])?;
    }
    Ok(())
}

/// Events on top of one and the same growing heap, under which lie ever more
/// frozen grains that nothing reaches: all go the same way.
fn heaps(arguments: &ScalingArguments, table: &mut Table) -> Result<(), ProgramError> {
    let small = arguments.quick;
    let rain = Rain {
        count: if small { 200 } else { 1500 },
        width: if small { 4.0 } else { 10.0 },
        sleep_speed: 0.1,
        elastic_speed: if small { 1.0e-3 } else { 1.0e-4 },
        seed: arguments.seed,
    };
    let half_way = Time::from_units(0.5 * rain.last_landing());
    let events = if small { 5000 } else { 500_000 };
    let buried: &[usize] = if small { &BURIED[..3] } else { &BURIED };

    let mut progress = Progress::new(false, None);
    let mut growing = rain.simulation(&Memory::before())?;
    timed(
        &mut growing,
        &Limits::until(half_way),
        &mut (),
        &mut progress,
    );
    let mut first = None;
    for &count in buried.iter().filter(|&&count| count <= arguments.largest) {
        let mut heap = growing.snapshot();
        let under = block(count, &heap, rain.width, arguments.seed)?;
        heap.extend(under);
        let total = heap.len();
        let mut simulation = on_top_of(heap, &growing)?;
        let modes = simulation.mode_counts();
        let mut least: Option<Cost> = None;
        for _ in 0..REPEATS {
            let limits = Limits::events(simulation.counts().total() + events);
            let (cost, _) = timed(&mut simulation, &limits, &mut (), &mut progress);
            if least.is_none_or(|so_far| cost.nanoseconds() < so_far.nanoseconds()) {
                least = Some(cost);
            }
        }
        progress.finish();
        let cost = least.unwrap_or_default().nanoseconds();
        table.row(&[
            "frozen".to_owned(),
            total.to_string(),
            modes.frozen.to_string(),
            modes.normal.to_string(),
            simulation.counts().total().to_string(),
            format!("{cost:.1}"),
            format!("{:.3}", cost / *first.get_or_insert(cost)),
        ])?;
    }
    Ok(())
}

/// A simulation of these grains, otherwise like another.
fn on_top_of(
    heap: Vec<Particle<3>>,
    like: &Simulation<GravityModel<Criterion, 3>, 3>,
) -> Result<Simulation<GravityModel<Criterion, 3>, 3>, SetupError> {
    let model = like.model();
    let model = Parts {
        dynamics: model.dynamics,
        predictor: model.predictor,
        collision_rule: model.collision_rule,
        state_policy: model.state_policy,
        boundary: model.boundary.clone(),
    };
    Simulation::with_settings(model, heap, *like.settings())
}

/// So many frozen grains at random, densely, in layers under a heap on a
/// periodic square base. (The lower layers are copies of the upper ones.)
fn block(
    count: usize,
    heap: &[Particle<3>],
    width: f64,
    seed: u64,
) -> Result<Vec<Particle<3>>, SetupError> {
    let height = 2.0 * width;
    let volume = width * width * height;
    let sphere = crate::analysis::ball_volume::<3>(0.5);
    let each = (0.57 * volume / sphere) as usize;
    let gas = Gas::<3> {
        count: each,
        // Exactly as large as to fill the base.
        packing_fraction: each as f64 * sphere / volume,
        aspect: Vector::<3>::new(1.0, 1.0, 2.0),
        ..Gas::default()
    };
    let (mut grains, _) = gas.grains(&mut seeded(seed))?;
    grains.sort_by(|a, b| b.position[2].total_cmp(&a.position[2]));
    // One diameter below, for grains reach beyond the box by up to a radius.
    let top = lowest_surface(heap).unwrap_or(0.0) - 1.0;
    Ok((0..count)
        .map(|index| {
            let grain = grains[index % each];
            let depth = height * (index / each + 1) as f64;
            let mut position = grain.position;
            position[2] += top - depth;
            Particle {
                position,
                velocity: Vector::zeros(),
                mode: Mode::Frozen,
                ..grain
            }
        })
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observe::TrajectoryHash;

    #[test]
    fn what_is_buried_changes_nothing() {
        let rain = Rain {
            count: 60,
            width: 4.0,
            sleep_speed: 0.1,
            elastic_speed: 1.0e-3,
            seed: 1,
        };
        let mut growing = rain.simulation(&Memory::before()).unwrap();
        growing.run(&Limits::until(Time::from_units(4.0)), &mut ());
        let hashes = [0, 100, 1000].map(|count| {
            let mut heap = growing.snapshot();
            let above = heap.len();
            heap.extend(block(count, &heap, rain.width, 1).unwrap());
            assert_eq!(heap.len(), above + count);
            let mut simulation = on_top_of(heap, &growing).unwrap();
            let mut hash = TrajectoryHash::new();
            simulation.run(&Limits::events(3000), &mut hash);
            hash.value()
        });
        assert_eq!(hashes, [hashes[0]; 3]);
    }
}
