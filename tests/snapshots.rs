//! Two small systems event by event, and how much work larger ones take.
//!
//! All numbers are rounded so far that only a change of the physics, or of the
//! amount of work, changes a snapshot.

mod common;

use common::{deposition, gas, heavy, rule, until, watch};
use grainfall::boundary::Side;
use grainfall::collide::Restitution;
use grainfall::engine::{Counts, Limits, Simulation, StopReason};
use grainfall::model::{Model, Occurrence, OccurrenceKind};
use grainfall::policy::SlowDescent;
use grainfall::setup::Sizes;
use grainfall::{Particle, Vector};

/// One event a line: when, what, how fast along the normal, and whether a sleep
/// was decided.
fn table<const D: usize>(events: &[Occurrence<D>]) -> String {
    let line = |event: &Occurrence<D>| {
        let id = event.particle;
        let what = match (event.kind, event.other, event.wall) {
            (OccurrenceKind::Sleep, ..) => format!("{id} falls asleep"),
            (_, Some(other), _) => format!("{id} hits {other}"),
            (_, _, Some(wall)) => format!("{id} hits wall {wall}"),
            _ => format!("{id} {}", event.kind.name()),
        };
        let decided = match (event.kind, event.reason) {
            (OccurrenceKind::Sleep, _) | (_, None) => "",
            _ => ", is to sleep",
        };
        let time = event.time.units();
        if event.kind == OccurrenceKind::Sleep {
            return format!("{time:.6}  {what}\n");
        }
        let speed = event.impact_speed;
        format!("{time:.6}  {what}  {speed:.6}{decided}\n")
    };
    events.iter().map(line).collect()
}

#[test]
fn bounce() {
    // Fig. 1, on a fixed grain.
    let grains = vec![
        Particle::fixed(Vector::<2>::zeros()),
        Particle::new(Vector::<2>::new(0.0, 1.5), Vector::zeros()),
    ];
    let policy = SlowDescent::with_threshold(0.01);
    let model = heavy(rule(1.0e-4), policy, [Side::Open; 2]);
    let mut simulation = Simulation::new(model, grains).unwrap();
    let (why, events) = watch(&mut simulation, &until(4.0));
    assert_eq!(why, StopReason::Time);
    insta::assert_snapshot!(table(&events), @r"
    1.000000  1 hits 0  1.000000
    1.800000  1 hits 0  0.400000
    2.120000  1 hits 0  0.160000
    2.248000  1 hits 0  0.064000
    2.299200  1 hits 0  0.025600
    2.319680  1 hits 0  0.010240
    2.327872  1 hits 0  0.004096, is to sleep
    2.329510  1 falls asleep
    ");
}

/// Fig. 2: the outer grains sleep, the inner two fall and wedge each other.
/// Mirrored, each takes the other's part.
fn arch(mirror: f64) -> Vec<Occurrence<2>> {
    let at = |x: f64, y: f64| Vector::<2>::new(mirror * x, y);
    let mut grains = vec![
        Particle::frozen(at(-1.296875, 0.0)),
        Particle::new(at(-0.5205078125, 0.6640625), Vector::zeros()),
        Particle::new(at(0.5234375, 0.66015625), Vector::zeros()),
        Particle::frozen(at(1.296875, 0.0)),
    ];
    if mirror < 0.0 {
        grains.reverse();
    }
    let policy = SlowDescent {
        sleep_speed: 0.05,
        wake_speed: 0.5,
        ..SlowDescent::default()
    };
    let model = heavy(rule(1.0e-4), policy, [Side::Open; 2]);
    let mut simulation = Simulation::new(model, grains).unwrap();
    let (why, events) = watch(&mut simulation, &Limits::all_frozen());
    assert_eq!(why, StopReason::AllFrozen);
    events
}

#[test]
fn arch_in_both_orders() {
    let events = arch(1.0);
    insta::assert_snapshot!(table(&events), @r"
    0.229276  2 hits 3  0.145332
    0.259929  1 hits 0  0.163828
    0.376563  1 hits 2  0.335406
    0.385518  2 hits 3  0.257375
    0.392917  1 hits 0  0.235351
    0.398385  1 hits 2  0.313947
    0.402512  1 hits 0  0.123874
    0.408980  2 hits 3  0.123635
    0.434587  1 hits 2  0.056087
    0.487729  2 hits 3  0.036175
    0.487960  1 hits 0  0.040113
    0.533577  1 hits 2  0.045731
    0.534228  2 hits 3  0.044584
    0.535400  1 hits 2  0.017787
    0.535837  1 hits 0  0.055843
    0.535946  1 hits 2  0.049772
    0.536159  1 hits 0  0.011528, is to sleep
    0.536738  2 hits 3  0.029496
    0.538577  1 hits 2  0.010951
    0.540514  1 hits 0  0.005431
    0.547699  1 hits 0  0.002172, is to sleep
    0.549136  1 falls asleep
    0.553865  2 hits 3  0.005967, is to sleep
    0.556029  2 falls asleep
    ");
    // The other way round it is the other one that sleeps first.
    let mirrored = arch(-1.0);
    assert_eq!(events.len(), mirrored.len());
    for (one, two) in events.iter().zip(&mirrored) {
        assert_eq!((one.kind, one.time), (two.kind, two.time));
        let ids = |event: &Occurrence<2>, turned: bool| {
            let turn = |id: u32| if turned { 3 - id } else { id };
            let mut ids = vec![turn(event.particle.0)];
            ids.extend(event.other.map(|id| turn(id.0)));
            ids.sort_unstable();
            ids
        };
        assert_eq!(ids(one, false), ids(two, true));
    }
}

/// A number with two significant digits.
fn about(number: f64) -> String {
    if number == 0.0 {
        return "0".to_owned();
    }
    let digits = libm::floor(libm::log10(number)) as i32 - 1;
    let unit = libm::pow(10.0, f64::from(digits));
    let rounded = (number / unit).round() * unit;
    format!("{rounded:.*}", usize::try_from(-digits).unwrap_or(0))
}

/// What a run took: events, and per thousand of them how many were of each kind,
/// how many elastic, and how often a neighbour list was made.
fn work<M: Model<D>, const D: usize>(simulation: &Simulation<M, D>) -> String {
    let Counts {
        pair,
        frozen,
        wake,
        sleep,
        transfer,
        elastic,
        ..
    } = *simulation.counts();
    let events = simulation.counts().total() as f64;
    let mut lines = format!("events     {}\n", about(events));
    for (name, count) in [
        ("pair", pair),
        ("frozen", frozen),
        ("wake", wake),
        ("sleep", sleep),
        ("elastic", elastic),
        ("transfer", transfer),
    ] {
        let share = about(1000.0 * count as f64 / events);
        lines += &format!("{name:10} {share} in 1000\n");
    }
    lines
}

#[test]
fn work_of_a_deposition() {
    let mut simulation = deposition::<3>(1, 200, 6.0, Sizes::default());
    let why = simulation.run(&Limits::all_frozen(), &mut ());
    assert_eq!(why, StopReason::AllFrozen);
    insta::assert_snapshot!(work(&simulation), @r"
    events     340000
    pair       270 in 1000
    frozen     690 in 1000
    wake       22 in 1000
    sleep      22 in 1000
    elastic    490 in 1000
    transfer   19 in 1000
    ");
}

/// How many neighbour lists an elastic gas of 500 made in its first 50 000
/// collisions.
fn lists<const D: usize>(packing_fraction: f64) -> String {
    let collisions = 50_000;
    let mut simulation = gas::<D>(1, 500, packing_fraction, Restitution::elastic());
    simulation.run(&Limits::events(collisions), &mut ());
    let made = simulation.counts().transfer as f64;
    let share = about(1000.0 * made / collisions as f64);
    format!("{D}D, φ = {packing_fraction:4}: {share} lists made in 1000 collisions\n")
}

#[test]
fn work_of_gases() {
    let lines = lists::<3>(0.05) + &lists::<3>(0.45) + &lists::<2>(0.6);
    insta::assert_snapshot!(lines, @r"
    3D, φ = 0.05: 4900 lists made in 1000 collisions
    3D, φ = 0.45: 330 lists made in 1000 collisions
    2D, φ =  0.6: 220 lists made in 1000 collisions
    ");
}
