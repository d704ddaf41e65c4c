//! Bases, and what falls on them.

use crate::{BIMODAL, lateral, least_gap};
use grainfall::analysis::{highest_surface, lowest_surface, slab_fraction};
use grainfall::setup::{Base, OneByOne, Rain, Sizes, seeded};
use grainfall::{Mode, Particle, SetupError, Vector};

// ---------------------------------------------------------------- the base

/// Drops grains of this diameter at random places; all have to be stopped.
fn assert_no_holes<const D: usize>(base: &Base<D>, grains: &[Particle<D>], diameter: f64) {
    use rand_chacha::rand_core::Rng;
    let mut rng = seeded(99);
    for _ in 0..20_000 {
        let mut place = Vector::<D>::zeros();
        for axis in 0..D - 1 {
            let inset = if base.periodic[axis] {
                0.0
            } else {
                0.5 * diameter
            };
            let share = f64::from(rng.next_u32()) / 4_294_967_296.0;
            place[axis] = base.origin[axis] + inset + (base.lengths[axis] - 2.0 * inset) * share;
        }
        let stopped = grains.iter().any(|grain| {
            let mut square = 0.0;
            for axis in 0..D - 1 {
                let mut offset = grain.position[axis] - place[axis];
                if base.periodic[axis] {
                    offset -= base.lengths[axis] * (offset / base.lengths[axis]).round();
                }
                square += offset * offset;
            }
            let contact = 0.5 * (grain.diameter + diameter);
            square < contact * contact
        });
        assert!(stopped, "a grain falls through at {place}");
    }
}

#[test]
fn the_papers_base() {
    // Made in about 0.1 s in a release build.
    for seed in 0..5 {
        let mut base = Base::<3>::default();
        base.origin[2] = -7.0;
        let grains = base.grains(&mut seeded(seed)).unwrap();
        assert!(
            grains
                .iter()
                .all(|g| g.mode == Mode::Fixed && g.velocity.norm() == 0.0)
        );
        assert_eq!(lowest_surface(&grains), Some(-7.0));
        let top = highest_surface(&grains).unwrap() + 7.0;
        assert!(top > 2.7 && top < 3.0, "{top}");
        // φ = 0.60 is 229 centres in 200 d³; the cut changes that by a few.
        assert!((200..260).contains(&grains.len()), "{}", grains.len());
        assert!(least_gap(&grains, &base.lengths, lateral(true)) > 0.0);
        assert_no_holes(&base, &grains, 1.0);
        // Inside the slab, where no cut is near, it is as dense as a heap.
        let inside = slab_fraction(&grains, 100.0, -6.2, -4.8);
        assert!(inside > 0.5 && inside < 0.65, "{inside}");
    }
}

#[test]
fn bases_of_other_kinds() {
    fn check<const D: usize>(sizes: Sizes, lengths: Vector<D>, periodic: bool) {
        let base = Base::<D> {
            sizes,
            lengths,
            origin: Vector::repeat(1.5),
            periodic: [periodic; D],
        };
        let grains = base.grains(&mut seeded(4)).unwrap();
        assert!((lowest_surface(&grains).unwrap() - 1.5).abs() < 1e-15);
        let centres = |fold: fn(f64, f64) -> f64| {
            grains
                .iter()
                .map(|g| g.position[D - 1])
                .reduce(fold)
                .unwrap()
        };
        assert!(centres(f64::max) - centres(f64::min) <= lengths[D - 1]);
        assert!(least_gap(&grains, &lengths, lateral(periodic)) > 0.0);
        assert_no_holes(&base, &grains, sizes.smallest());
        if !periodic {
            for grain in &grains {
                for axis in 0..D - 1 {
                    assert!(grain.position[axis] - grain.radius() >= 1.5);
                    assert!(grain.position[axis] + grain.radius() <= 1.5 + lengths[axis]);
                }
            }
        }
    }
    check::<3>(BIMODAL, Vector::<3>::new(8.0, 5.0, 2.5), true);
    check::<3>(Sizes::default(), Vector::<3>::new(6.0, 3.0, 2.0), false);
    check::<2>(Sizes::default(), Vector::<2>::new(30.0, 2.0), true);
    check::<2>(BIMODAL, Vector::<2>::new(20.0, 2.5), false);
    check::<2>(Sizes::default(), Vector::<2>::new(1.2, 2.0), false);
    check::<3>(Sizes::default(), Vector::<3>::new(1.3, 1.3, 2.0), false);
    check::<1>(Sizes::default(), Vector::<1>::new(2.0), true);
}

#[test]
fn impossible_bases_are_refused() {
    let thin = Base::<3> {
        lengths: Vector::<3>::new(5.0, 5.0, 0.0),
        ..Base::default()
    };
    let error = thin.grains(&mut seeded(1)).unwrap_err();
    assert!(matches!(
        error,
        SetupError::Parameter {
            field: "thickness",
            ..
        }
    ));
    let narrow = Base::<3> {
        lengths: Vector::<3>::new(5.0, 1.5, 2.0),
        ..Base::default()
    };
    let error = narrow.grains(&mut seeded(1)).unwrap_err();
    assert!(matches!(error, SetupError::PeriodTooShort { axis: 1, .. }));
    // Grains that fill the width between two walls can't be grown there.
    let column = Base::<2> {
        lengths: Vector::<2>::new(1.0, 2.0),
        periodic: [false; 2],
        ..Base::default()
    };
    let error = column.grains(&mut seeded(1)).unwrap_err();
    assert!(matches!(error, SetupError::NoRoom { .. }), "{error}");
}

#[test]
fn a_rain_on_a_base_touches_it_and_no_more() {
    let mut rng = seeded(8);
    let base = Base::<3>::default().grains(&mut rng).unwrap();
    let mut rain = Rain::<3> {
        count: 300,
        ..Rain::default()
    };
    rain.origin[2] = highest_surface(&base).unwrap();
    let mut grains = base;
    grains.extend(rain.grains(&mut rng).unwrap());
    assert!(least_gap(&grains, &rain.lengths, lateral(true)) > 0.0);
}

// ---------------------------------------------------------------- one by one

#[test]
fn one_by_one_starts_above_the_top() {
    let source = OneByOne::<3> {
        sizes: BIMODAL,
        periodic: [true, false, false],
        origin: Vector::<3>::new(-5.0, 2.0, 0.0),
        ..OneByOne::default()
    };
    let mut rng = seeded(1);
    let mut sums = Vector::<3>::zeros();
    for _ in 0..2000 {
        let grain = source.grain(12.0, &mut rng).unwrap();
        assert_eq!(grain.mode, Mode::Falling);
        assert_eq!(grain.velocity, Vector::<3>::new(0.0, 0.0, -2.5));
        assert!((grain.position[2] - grain.radius() - 14.0).abs() < 1e-14);
        assert!((-5.0..5.0).contains(&grain.position[0]));
        assert!(grain.position[1] >= 2.0 + grain.radius());
        assert!(grain.position[1] <= 12.0 - grain.radius());
        sums += grain.position / 2000.0;
    }
    // Uniform: the mean is off by five of 10/√12/√2000 at most.
    assert!(
        sums[0].abs() < 0.33 && (sums[1] - 7.0).abs() < 0.33,
        "{sums}"
    );
    assert!(source.grain(f64::NAN, &mut rng).is_err());
}
