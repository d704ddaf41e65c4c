//! Who is found, against looking at everybody.

use proptest::prelude::*;

use crate::boundary::{Cuboid, Side};
use crate::engine::cells::{Cells, Link};
use crate::engine::images::for_each_turns;
use crate::particle::Vector;

/// Images so many periods away are looked at.
const IMAGES: i32 = 12;

/// A box of this length along each axis, periodic or open; each grain's place over it, how
/// far outside it is moved along open axes, and its reach.
type Setting = (Vec<(f64, bool)>, Vec<(Vec<f64>, Vec<f64>, f64)>);

fn setting(dimension: usize) -> impl Strategy<Value = Setting> {
    let sides = proptest::collection::vec((1.0..12.0f64, any::<bool>()), dimension);
    let outside = prop_oneof![4 => Just(0.0), 1 => -60.0..60.0f64];
    let grain = (
        proptest::collection::vec(0.0..1.0f64, dimension),
        proptest::collection::vec(outside, dimension),
        0.1..1.2f64,
    );
    (sides, proptest::collection::vec(grain, 2..25))
}

fn check<const D: usize>(
    (sides, grains): Setting,
    edge: f64,
    farthest: f64,
) -> Result<(), TestCaseError> {
    let boundary = Cuboid::new(std::array::from_fn(|axis| match sides[axis] {
        (length, true) => Side::periodic(length),
        _ => Side::Open,
    }))
    .unwrap();
    let inside = |place: &[f64]| Vector::<D>::from_fn(|axis, _| place[axis] * sides[axis].0);
    let places: Vec<_> = grains.iter().map(|(place, ..)| inside(place)).collect();
    let mut cells = Cells::new(&boundary, &places, edge);
    let mut spots = Vec::new();
    for (particle, (place, outside, reach)) in (0..).zip(&grains) {
        let mut place = inside(place);
        for axis in 0..D {
            // Also along periodic ones: it is filed in its image.
            place[axis] += outside[axis];
        }
        spots.push((cells.refile(particle, &place, *reach), *reach));
    }
    let periodic = |axis: usize| i32::from(sides[axis].1);
    let low: [i32; D] = std::array::from_fn(|axis| -IMAGES * periodic(axis));
    let count = grains.len() as u32;
    for particle in 0..count {
        let (home, own) = spots[particle as usize];
        let apart = |link: Link<D>| {
            let (there, _) = spots[link.particle() as usize];
            there - home + cells.shift(Link::<D>::turns_of(link.image()))
        };
        let mut found = Vec::new();
        cells.for_each_in_reach(particle, &home, farthest, own, |link, certain| {
            let (_, theirs) = spots[link.particle() as usize];
            if certain || apart(link).norm() < own + theirs {
                found.push(link);
            }
        });
        for other in (0..count).filter(|other| *other != particle) {
            for_each_turns(low, low.map(|turns| -turns), |turns| {
                let link = Link::<D>::new(other, Link::<D>::image_of(&turns));
                let apart = apart(link).norm();
                let both = own + spots[other as usize].1;
                let times = found.iter().filter(|named| **named == link).count();
                assert!(times <= 1, "{link:?} is found twice");
                assert!(
                    times == 1 || apart >= both.min(farthest),
                    "{particle} does not find {link:?}, {apart} away"
                );
                assert!(
                    times == 0 || apart <= both + cells.told_error(both),
                    "{particle} finds {link:?}, {apart} away"
                );
            });
        }
        let mut everybody = Vec::new();
        cells.for_each_found(particle, &home, f64::INFINITY, |other| {
            everybody.push(other.particle)
        });
        everybody.sort_unstable();
        everybody.dedup();
        prop_assert_eq!(everybody.len() as u32, count - 1);
        let mut near = Vec::new();
        cells.for_each_found(particle, &home, farthest, |other| near.push(other));
        for link in found {
            let known = near.contains(&cells.found(particle, link));
            prop_assert!(known || farthest < own + 1.2, "{:?} is not near", link);
        }
    }
    Ok(())
}

proptest! {
    #[test]
    fn all_in_reach_are_found_in_the_plane(
        setting in setting(2), edge in 0.7..5.0f64, farthest in 0.2..4.0f64,
    ) {
        check::<2>(setting, edge, farthest)?;
    }

    #[test]
    fn all_in_reach_are_found_in_space(
        setting in setting(3), edge in 0.7..5.0f64, farthest in 2.4..3.0f64,
    ) {
        check::<3>(setting, edge, farthest)?;
    }
}
