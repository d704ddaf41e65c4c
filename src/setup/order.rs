//! The order in which grains are numbered.

use crate::particle::{Particle, Vector};

/// Digits of a place along each axis: as many as three of them have room for.
const DIGITS: u32 = 21;

/// Sorts grains along a curve that fills space (Morton's), so that those with
/// numbers next to each other lie, mostly, near each other.
///
/// A simulation keeps grains in memory in the order of their ids. In a large
/// system (beyond 10⁴ grains, say) an event then finds the grains it looks at close
/// together in the cache. It is as if they had been drawn in this order: a
/// trajectory is the same but for their names, and for what depends on them, the
/// order of events at exactly equal times.
///
/// The curve runs through cells with the largest diameter as their edge, counted
/// from the lowest place along each axis; in one cell the order stays as it was.
///
/// ```
/// use grainfall::setup::{Rain, seeded, sort_in_space};
///
/// let rain = Rain::<3> { count: 500, ..Rain::default() };
/// let mut grains = rain.grains(&mut seeded(1))?;
/// sort_in_space(&mut grains);
/// # Ok::<(), grainfall::SetupError>(())
/// ```
pub fn sort_in_space<const D: usize>(grains: &mut [Particle<D>]) {
    let edge = grains
        .iter()
        .map(|grain| grain.diameter)
        .fold(0.0, f64::max);
    let corner = grains
        .iter()
        .fold(Vector::<D>::repeat(f64::INFINITY), |corner, grain| {
            corner.inf(&grain.position)
        });
    grains.sort_by_cached_key(|grain| {
        let cell = (grain.position - corner) / edge;
        // What is not a number, or too far away, is put at an end.
        let digits: [u64; D] =
            std::array::from_fn(|axis| (cell[axis] as u64).min((1 << DIGITS) - 1));
        place_on_curve(&digits)
    });
}

/// The digits of all axes, by turns, the highest first.
fn place_on_curve<const D: usize>(cell: &[u64; D]) -> u64 {
    (0..DIGITS).rev().fold(0, |place, digit| {
        cell.iter()
            .fold(place, |place, along| place << 1 | (along >> digit & 1))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::particle::Mode;
    use crate::setup::{Rain, seeded};

    #[test]
    fn the_curve_goes_through_one_octant_after_the_other() {
        let mut cells = Vec::new();
        for x in 0..4 {
            for y in 0..4 {
                for z in 0..4 {
                    cells.push([x, y, z]);
                }
            }
        }
        cells.sort_by_key(place_on_curve);
        for eight in cells.chunks(8) {
            let octant = eight[0].map(|along| along / 2);
            assert!(
                eight
                    .iter()
                    .all(|cell| cell.map(|along| along / 2) == octant)
            );
        }
        assert_eq!(cells[..3], [[0, 0, 0], [0, 0, 1], [0, 1, 0]]);
    }

    /// How far apart, in the order, grains nearer than 1.5 d are on the average.
    fn spread<const D: usize>(grains: &[Particle<D>]) -> f64 {
        let (mut sum, mut pairs) = (0.0, 0.0);
        for (i, one) in grains.iter().enumerate() {
            for (j, other) in grains[..i].iter().enumerate() {
                if (one.position - other.position).norm() < 1.5 {
                    sum += (i - j) as f64;
                    pairs += 1.0;
                }
            }
        }
        sum / pairs
    }

    #[test]
    fn neighbours_have_numbers_near_each_other() {
        fn check<const D: usize>(count: usize) {
            let rain = Rain::<D> {
                count,
                lengths: Vector::repeat(20.0),
                packing_fraction: 0.2,
                ..Rain::default()
            };
            let drawn = rain.grains(&mut seeded(3)).unwrap();
            let mut sorted = drawn.clone();
            sort_in_space(&mut sorted);
            let (before, after) = (spread(&drawn), spread(&sorted));
            assert!(after < 0.2 * before, "{before} … {after}");
            // The same grains: each is there once.
            let key = |grain: &Particle<D>| grain.position.map(f64::to_bits).data.0;
            let (mut one, mut other) = (drawn, sorted);
            one.sort_by_key(key);
            other.sort_by_key(key);
            assert_eq!(one, other);
        }
        check::<2>(3000);
        check::<3>(3000);
    }

    #[test]
    fn nothing_and_one_cell_stay_as_they_are() {
        sort_in_space::<3>(&mut []);
        let before: Vec<_> = [0.6, 0.2, 0.9]
            .map(|along| Particle {
                position: Vector::<3>::repeat(along),
                velocity: Vector::zeros(),
                diameter: 1.0,
                mass: 1.0,
                mode: Mode::Normal,
            })
            .into();
        let mut same = before.clone();
        sort_in_space(&mut same);
        assert_eq!(same, before);
    }
}
