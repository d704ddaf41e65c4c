//! Grains that come later, and grains that are refused.

use crate::common::{hash, heavy, rain_on_base, rule, until, watch, what};
use grainfall::boundary::Side;
use grainfall::engine::Simulation;
use grainfall::model::Model;
use grainfall::observe::TrajectoryHash;
use grainfall::policy::SlowDescent;
use grainfall::setup::Sizes;
use grainfall::{Mode, Particle, ParticleId, SetupError, Vector};

/// A few grains on a base, in two dimensions, and one that comes last.
fn bed_and_late_one() -> (Vec<Particle<2>>, Particle<2>) {
    let grains = rain_on_base::<2>(6, 12, 8.0, Sizes::default());
    // Binary fractions: it is at exactly this place at any quarter of time.
    let late = Particle::new(Vector::<2>::new(3.25, 14.5), Vector::<2>::new(0.0, -2.5))
        .with_mode(Mode::Falling);
    (grains, late)
}

fn bed(grains: Vec<Particle<2>>) -> Simulation<impl Model<2>, 2> {
    let sides = [Side::periodic(8.0), Side::Open];
    Simulation::new(heavy(rule(1.0e-3), SlowDescent::default(), sides), grains).unwrap()
}

#[test]
fn a_grain_inserted_on_its_way_is_one_that_was_there_from_the_start() {
    let (mut grains, late) = bed_and_late_one();
    // A shower, so that one of them fell freely until then, for long.
    for grain in &mut grains {
        if grain.mode == Mode::Falling {
            grain.position[1] += 4.0;
        }
    }
    let mut whole = grains.clone();
    whole.push(late);
    let (_, wanted) = watch(&mut bed(whole), &until(30.0));

    let mut simulation = bed(grains);
    let (_, mut found) = watch(&mut simulation, &until(0.75));
    let mut now = late;
    now.position[1] -= 2.5 * 0.75;
    let id = simulation.insert(now).unwrap();
    assert_eq!(id.index(), simulation.snapshot().len() - 1);
    found.extend(watch(&mut simulation, &until(30.0)).1);

    let mut touched = 0;
    // A dense heap doubles an error at every collision: hold the first ones to
    // it, among which the late one has had its part.
    for (place, (one, two)) in wanted.iter().zip(&found).take(150).enumerate() {
        assert_eq!(what(one), what(two), "event {place}");
        let off = (one.time - two.time).abs();
        assert!(off < 1.0e-9, "event {place} off by {off:e}");
        touched += usize::from(one.particle == id || one.other == Some(id));
    }
    assert!(touched > 2, "the late one took part {touched} times");
}

#[test]
fn a_refused_grain_leaves_no_trace() {
    let (grains, late) = bed_and_late_one();
    let mut through = bed(grains.clone());
    let straight = hash(&mut through, &until(10.0));

    let mut refusing = bed(grains);
    let mut hash = TrajectoryHash::new();
    refusing.run(&until(3.0), &mut hash);
    let there = refusing.particle(ParticleId(0));
    let refused = [
        (late.with_mass(-1.0), "mass"),
        (late.with_diameter(f64::NAN), "diameter"),
        (late.with_diameter(1.5), "diameter"),
    ];
    for (grain, wanted) in refused {
        let error = refusing.insert(grain).unwrap_err();
        let SetupError::Particle { field, .. } = error else {
            panic!("{error}")
        };
        assert_eq!(field, wanted);
    }
    let onto = Particle {
        position: there.position + Vector::<2>::new(0.25, 0.0),
        ..late
    };
    let error = refusing.insert(onto).unwrap_err();
    assert!(
        matches!(
            error,
            SetupError::Overlap {
                first: ParticleId(0),
                ..
            }
        ),
        "{error}"
    );
    assert_eq!(refusing.snapshot().len(), refusing.mode_counts().total());
    refusing.run(&until(10.0), &mut hash);
    assert_eq!(hash.value(), straight);
}
