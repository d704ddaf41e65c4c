//! Brute-force audits: after every event of small random systems of all kinds,
//! what the book-keeping promises is compared with all pairs in all images.

mod restless;
mod systems;

use crate::engine::settings::{Limits, StopReason};
use crate::engine::simulation::Simulation;
use crate::engine::slot::Partner;
use crate::model::{Boundary, Model, Wall};
use crate::observe::TrajectoryHash;
use crate::particle::{Mode, ParticleId};
use systems::{Case, Outcome};

/// Deeper than this is no rounding.
const DEEP: f64 = 1.0e-9;

/// Every contact must be noted by one of the two, or lie beyond the next entry
/// of one of them.
fn audit_contacts<M: Model<D>, const D: usize>(
    simulation: &mut Simulation<M, D>,
) -> Result<(), String> {
    match simulation.audit().missed.first() {
        Some(missed) => Err(format!("at {}: {missed}", simulation.world.clock)),
        None => Ok(()),
    }
}

/// Every entry of a list is also on the list of the other, if that has one.
fn audit_lists<M: Model<D>, const D: usize>(simulation: &Simulation<M, D>) -> Result<(), String> {
    let near = &simulation.world.near;
    for one in 0..simulation.world.bodies.len() as u32 {
        for entry in near.list(one) {
            if near.is_tied(entry.particle)
                && !near
                    .list(entry.particle)
                    .any(|their| their == entry.seen_from(one))
            {
                return Err(format!("{one} lists {entry:?}, which does not list it"));
            }
        }
        if let Partner::Particle(other) = simulation.slots[one].partner
            && other as usize >= simulation.world.bodies.len()
        {
            return Err(format!("{one} waits for {other}, who is not there"));
        }
    }
    let modes = simulation.mode_counts();
    let mobile = simulation
        .world
        .bodies
        .iter()
        .filter(|body| body.mode.is_mobile());
    if mobile.count() != modes.mobile() {
        return Err(format!("{modes:?} is miscounted"));
    }
    Ok(())
}

/// The deepest overlap now of a mobile grain with anybody or any wall.
fn deepest_overlap<M: Model<D>, const D: usize>(simulation: &Simulation<M, D>) -> f64 {
    let grains = simulation.snapshot();
    let boundary = simulation.model.boundary();
    let mut deepest: f64 = 0.0;
    for (place, one) in grains.iter().enumerate() {
        for wall in boundary.walls() {
            if one.mode.is_mobile() {
                let gap = wall.distance(&one.position, simulation.time()) - one.radius();
                deepest = deepest.max(-gap);
            }
        }
        for other in &grains[..place] {
            if one.mode.is_static() && other.mode.is_static() {
                continue;
            }
            let apart = boundary.displacement(&one.position, &other.position).norm();
            deepest = deepest.max(0.5 * (one.diameter + other.diameter) - apart);
        }
    }
    deepest
}

/// The trajectory's hash if the run is stopped every so often, and whatever
/// the search for neighbours has stored is then made anew.
fn hash_of<M: Model<D>, const D: usize>(
    mut simulation: Simulation<M, D>,
    events: u64,
    slice: Option<f64>,
) -> u64 {
    let mut hash = TrajectoryHash::new();
    let end = simulation.time() + 5.0;
    let mut stop = simulation.time();
    while stop < end {
        stop = slice.map_or(end, |slice| end.min(stop + slice));
        let limits = Limits {
            time: stop,
            ..Limits::events(events)
        };
        if simulation.run(&limits, &mut hash) != StopReason::Time {
            break;
        }
        if slice.is_some() {
            simulation.rebuild_grid();
        }
    }
    hash.value()
}

/// Two equal simulations, one of which is saved and restored every so often,
/// have to stay equal in all that is saved.
fn restart<M: Model<D>, const D: usize>(
    case: &Case<D>,
    model: impl Fn() -> M,
    mut through: Simulation<M, D>,
    mut restored: Simulation<M, D>,
) -> Result<(), String> {
    let written = |simulation: &Simulation<M, D>| postcard::to_stdvec(&simulation.save());
    let mut hashes = [TrajectoryHash::new(); 2];
    let mut newcomers = case.newcomers.iter();
    let end = through.time() + 5.0;
    for step in 1..=case.events {
        if step % 23 == 0
            && let Some(newcomer) = newcomers.next()
            && through.insert(*newcomer).is_ok() != restored.insert(*newcomer).is_ok()
        {
            return Err("one takes a grain that the other refuses".into());
        }
        if step % 5 == 0 {
            let state = written(&restored)
                .and_then(|bytes| postcard::from_bytes(&bytes))
                .map_err(|error| format!("no state comes back: {error}"))?;
            restored = Simulation::restore(model(), state)
                .map_err(|error| format!("not restored: {error}"))?;
        }
        let limits = Limits {
            time: end,
            ..Limits::events(u64::from(step))
        };
        let why = through.run(&limits, &mut hashes[0]);
        if why != restored.run(&limits, &mut hashes[1]) {
            return Err("they stop for different reasons".into());
        }
    }
    if hashes[0] != hashes[1] || written(&through) != written(&restored) {
        return Err("saved and restored, it goes another way".into());
    }
    Ok(())
}

/// Runs a simulation event by event and audits it after each.
fn audit<M: Model<D>, const D: usize>(
    case: &Case<D>,
    mut simulation: Simulation<M, D>,
) -> Result<Outcome, String> {
    let mut outcome = Outcome::default();
    audit_contacts(&mut simulation)?;
    let mut newcomers = case.newcomers.iter();
    for step in 0..case.events {
        if step % 23 == 22
            && let Some(newcomer) = newcomers.next()
            // Refused if there is no room; the simulation is then as before.
            && simulation.insert(*newcomer).is_ok()
        {
            outcome.inserted += 1;
            audit_contacts(&mut simulation)?;
            audit_lists(&simulation)?;
        }
        let limits = if step % 7 == 3 {
            // A stop between events.
            Limits::until(simulation.time() + 0.01)
        } else {
            Limits {
                time: simulation.time() + 20.0,
                ..Limits::events(simulation.counts().total() + 1)
            }
        };
        let before = simulation.time();
        match simulation.run(&limits, &mut ()) {
            StopReason::Collapse(_) => break,
            StopReason::Time if step % 7 != 3 => break,
            _ => {}
        }
        if simulation.time() < before {
            return Err(format!(
                "the clock went back from {before} to {}",
                simulation.time()
            ));
        }
        audit_contacts(&mut simulation)?;
        audit_lists(&simulation)?;
        if !case.crushes {
            let depth = deepest_overlap(&simulation);
            if depth > DEEP {
                return Err(format!("overlap of {depth:e} at {}", simulation.time()));
            }
        }
    }
    outcome.events = simulation.counts().total();
    outcome.sleeps = simulation.counts().sleep;
    outcome.wakes = simulation.counts().wake + simulation.counts().check_wake;
    for id in 0..simulation.world.bodies.len() as u32 {
        let grain = simulation.particle(ParticleId(id));
        if grain.mode != Mode::Fixed && !grain.position.iter().all(|x| x.is_finite()) {
            return Err(format!("{id} is nowhere: {grain:?}"));
        }
    }
    Ok(outcome)
}

fn audit_many<const D: usize>(seeds: std::ops::Range<u64>) {
    let mut total = Outcome::default();
    let mut failures = Vec::new();
    for seed in seeds {
        let case = Case::<D>::random(seed);
        match systems::run(&case) {
            Ok(outcome) => total = total + outcome,
            Err(failure) => failures.push(format!("{D}D seed {seed} ({}): {failure}", case.what)),
        }
    }
    assert!(
        failures.is_empty(),
        "{} failures\n{}",
        failures.len(),
        failures.join("\n")
    );
    // The audit has seen what it is about.
    assert!(total.events > 1000 && total.sleeps > 10 && total.wakes > 10 && total.inserted > 10);
}

#[test]
fn nothing_is_missed_in_space() {
    audit_many::<3>(0..400);
}

#[test]
fn nothing_is_missed_in_the_plane() {
    audit_many::<2>(0..800);
}
