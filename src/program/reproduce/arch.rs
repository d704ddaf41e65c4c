//! Fig. 2: an arch of two grains.

use crate::boundary::{Cuboid, Side};
use crate::collide::Restitution;
use crate::draw;
use crate::dynamics::UniformGravity;
use crate::engine::{Limits, Simulation};
use crate::error::SetupError;
use crate::model::{Occurrence, OccurrenceKind, Parts};
use crate::output::Frame;
use crate::particle::{Particle, Vector};
use crate::policy::{Criterion, SlowDescent};
use crate::predict::Polynomial;
use crate::program::error::ProgramError;
use crate::program::estimate::Estimate;
use crate::program::reproduce::pictures::side_by_side;
use crate::program::reproduce::row::Row;
use crate::program::reproduce::{Context, Report, csv_of};
use crate::time::Time;

/// Starts that are tried along each of two offsets.
const TRIES: i32 = 16;
/// By how much two neighbouring starts differ, in d.
const STEP: f64 = 1.0 / 512.0;

type Arch = Simulation<Parts<UniformGravity<2>, Polynomial, Restitution, Criterion, Cuboid<2>>, 2>;

/// Two grains over two frozen ones, the left one so much to the right and up of
/// a symmetric start.
fn arch(right: f64, up: f64) -> Result<Arch, SetupError> {
    let at = |x: f64, y: f64| Vector::<2>::new(x, y);
    let still = Vector::<2>::zeros();
    let grains = vec![
        Particle::frozen(at(-1.296_875, 0.0)),
        Particle::new(at(-0.523_437_5 + right, 0.660_156_25 + up), still),
        Particle::new(at(0.523_437_5, 0.660_156_25), still),
        Particle::frozen(at(1.296_875, 0.0)),
    ];
    let model = Parts {
        dynamics: UniformGravity::<2>::down(),
        predictor: Polynomial,
        collision_rule: Restitution::default(),
        state_policy: Criterion::SlowDescent(SlowDescent {
            sleep_speed: 0.05,
            wake_speed: 0.5,
            ..SlowDescent::default()
        }),
        boundary: Cuboid::new([Side::Open, Side::Open])?,
    };
    Simulation::new(model, grains)
}

/// The two sleeps that end it: who, and when.
fn sleeps(mut arch: Arch) -> Vec<(u32, f64)> {
    let mut asleep = Vec::new();
    let mut watch = |event: &Occurrence<2>| match event.kind {
        OccurrenceKind::Sleep => asleep.push((event.particle.0, event.time.units())),
        OccurrenceKind::Wake | OccurrenceKind::CheckWake => asleep.clear(),
        _ => {}
    };
    let limits = Limits {
        time: Time::from_units(20.0),
        all_frozen: true,
        ..Limits::default()
    };
    arch.run(&limits, &mut watch);
    // An arch, and not two grains that have fallen through.
    let stands = arch.snapshot()[1..3]
        .iter()
        .all(|grain| grain.position.y > 0.3);
    if stands && asleep.len() == 2 {
        asleep
    } else {
        Vec::new()
    }
}

pub(super) fn report(_: &Context<'_>) -> Result<Report, ProgramError> {
    let (mut left_first, mut right_first) = (Vec::new(), Vec::new());
    let mut table = Vec::new();
    for across in -TRIES..=TRIES {
        for above in -TRIES..=TRIES {
            let (right, up) = (STEP * f64::from(across), STEP * f64::from(above));
            // Starts that overlap are none.
            let Ok(start) = arch(right, up) else { continue };
            if let [(one, first), (_, second)] = sleeps(start)[..] {
                let found = if one == 1 {
                    &mut left_first
                } else {
                    &mut right_first
                };
                found.push((right, up, first, second));
                let row = [right, up, f64::from(one), first, second];
                table.push(row.map(|value| value.to_string()).to_vec());
            }
        }
    }
    let pictures = match left_first.first() {
        None => Vec::new(),
        Some(&(right, up, first, second)) => {
            let mut frames = Vec::new();
            let mut arch = arch(right, up)?;
            let boundary: Cuboid<2> = Cuboid::open();
            // While they converge, when one sleeps, when both do.
            for time in [0.8 * first, 0.5 * (first + second), second + 0.1] {
                arch.run(&Limits::until(Time::from_units(time)), &mut ());
                let frame = Frame::new(&arch.snapshot(), arch.time(), &boundary);
                frames.push(draw::svg(&frame));
            }
            frames
        }
    };
    let of = "Fig. 2";
    let count = |found: &[_]| Estimate::exact(found.len() as f64);
    let words = "The paper says that it can be built in both orders; starts differ by 1/512 d.";
    let tries = ((2 * TRIES + 1) * (2 * TRIES + 1)) as usize;
    Ok(Report {
        rows: vec![
            Row::shown(
                of,
                "arches in which grain 2 sleeps first",
                count(&left_first),
                tries,
                words,
            ),
            Row::shown(
                of,
                "arches in which grain 3 sleeps first",
                count(&right_first),
                tries,
                words,
            ),
        ],
        files: vec![
            ("fig2.svg".to_owned(), side_by_side(&pictures)),
            (
                "fig2.csv".to_owned(),
                csv_of(
                    &["right", "up", "first", "first_sleeps", "second_sleeps"],
                    &table,
                )?,
            ),
        ],
    })
}
