//! Random sequential insertion: grains are put one after the other at uniform
//! random places where they touch none of those already there.

use rand_chacha::ChaCha8Rng;

use crate::error::SetupError;
use crate::particle::Vector;
use crate::setup::region::Region;

/// Inserted grains stay apart by this much of their distance at contact, so
/// that the rounding of a later shift can't make them overlap.
const MARGIN: f64 = 1.0e-9;

/// Tries allowed for N grains: this many each …
const TRIES_EACH: usize = 200;
/// … and this many to share.
const TRIES_SHARED: usize = 100_000;

/// No grain.
const NOBODY: u32 = u32::MAX;

/// Places for grains of these diameters, in the same order.
///
/// The largest go first, while there is room. The work is proportional to the
/// number of grains: there is a fixed number of tries, and a try looks at the
/// 3^D cells around it.
///
/// # Errors
///
/// When the tries run out: random insertion jams near φ = 0.38 in three
/// dimensions and 0.55 in two, and is slow well before.
pub(super) fn insert<const D: usize>(
    region: &Region<D>,
    diameters: &[f64],
    rng: &mut ChaCha8Rng,
) -> Result<Vec<Vector<D>>, SetupError> {
    let wanted = diameters.len();
    if wanted >= NOBODY as usize {
        return Err(SetupError::TooManyParticles {
            count: wanted,
            most: NOBODY as usize - 1,
        });
    }
    let mut order: Vec<u32> = (0..wanted as u32).collect();
    order.sort_by(|&a, &b| diameters[b as usize].total_cmp(&diameters[a as usize]));
    let largest = order.first().map_or(1.0, |&i| diameters[i as usize]);

    let mut grid = Grid::new(region, wanted, largest);
    let mut places = vec![Vector::<D>::zeros(); wanted];
    let mut tries = TRIES_EACH * wanted + TRIES_SHARED;
    for (placed, &id) in order.iter().enumerate() {
        let diameter = diameters[id as usize];
        loop {
            if tries == 0 {
                return Err(SetupError::NoRoom {
                    placed,
                    wanted,
                    reason: "there is no room left for random insertion; a larger box, fewer \
                             grains or a lower packing fraction would help",
                });
            }
            tries -= 1;
            let mut place = Vector::<D>::zeros();
            for axis in 0..D {
                place[axis] = region.random_coordinate(axis, 0.5 * diameter, rng);
            }
            let free = grid.all_near(&place, |other| {
                let contact = 0.5 * (diameter + diameters[other as usize]) * (1.0 + MARGIN);
                region.distance_squared(&place, &places[other as usize]) > contact * contact
            });
            if free {
                places[id as usize] = place;
                grid.add(&place, id);
                break;
            }
        }
    }
    Ok(places)
}

/// Cells with a chain of grains each.
struct Grid<const D: usize> {
    region: Region<D>,
    cells: [usize; D],
    first: Vec<u32>,
    next: Vec<u32>,
}

impl<const D: usize> Grid<D> {
    /// Cells no narrower than the largest grain, and no more than about one a
    /// grain.
    fn new(region: &Region<D>, count: usize, largest: f64) -> Self {
        let each = libm::pow(region.volume() / count.max(1) as f64, 1.0 / D as f64);
        let edge = each.max(largest * (1.0 + 2.0 * MARGIN));
        let mut cells = [1; D];
        let mut total = 1;
        for (along, length) in cells.iter_mut().zip(region.lengths.iter()) {
            *along = ((length / edge) as usize).clamp(1, count.max(1));
            total *= *along;
        }
        Grid {
            region: *region,
            cells,
            first: vec![NOBODY; total],
            next: vec![NOBODY; count],
        }
    }

    fn cell_along(&self, axis: usize, place: &Vector<D>) -> usize {
        let share = (place[axis] - self.region.origin[axis]) / self.region.lengths[axis];
        ((share * self.cells[axis] as f64) as usize).min(self.cells[axis] - 1)
    }

    fn add(&mut self, place: &Vector<D>, id: u32) {
        let mut cell = 0;
        for axis in 0..D {
            cell = cell * self.cells[axis] + self.cell_along(axis, place);
        }
        self.next[id as usize] = self.first[cell];
        self.first[cell] = id;
    }

    /// Whether `holds` for every grain in the cells around a place. Grains may
    /// be asked about twice where an axis has but two cells.
    fn all_near(&self, place: &Vector<D>, mut holds: impl FnMut(u32) -> bool) -> bool {
        let mut own = [0; D];
        for (axis, along) in own.iter_mut().enumerate() {
            *along = self.cell_along(axis, place);
        }
        'cells: for mut code in 0..3usize.pow(D as u32) {
            let mut cell = 0;
            for (axis, own) in own.into_iter().enumerate() {
                let count = self.cells[axis];
                // One cell further than wanted, so that it can't be negative.
                let shifted = own + code % 3;
                code /= 3;
                let along = if self.region.periodic[axis] {
                    (shifted + count - 1) % count
                } else if shifted == 0 || shifted > count {
                    continue 'cells;
                } else {
                    shifted - 1
                };
                cell = cell * count + along;
            }
            let mut id = self.first[cell];
            while id != NOBODY {
                if !holds(id) {
                    return false;
                }
                id = self.next[id as usize];
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup::seeded;
    use proptest::prelude::*;

    fn least_gap<const D: usize>(
        region: &Region<D>,
        diameters: &[f64],
        places: &[Vector<D>],
    ) -> f64 {
        let mut least = f64::INFINITY;
        for i in 0..places.len() {
            for j in 0..i {
                let mut difference = places[i] - places[j];
                for axis in 0..D {
                    if region.periodic[axis] {
                        let length = region.lengths[axis];
                        while difference[axis] > 0.5 * length {
                            difference[axis] -= length;
                        }
                        while difference[axis] < -0.5 * length {
                            difference[axis] += length;
                        }
                    }
                }
                least = least.min(difference.norm() - 0.5 * (diameters[i] + diameters[j]));
            }
        }
        least
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Narrow boxes, few cells, walls and periods: nobody overlaps.
        #[test]
        fn nobody_overlaps(
            seed in 0u64..1000,
            x in 3.0..8.0f64,
            y in 3.0..8.0f64,
            z in 3.0..40.0f64,
            px: bool, py: bool, pz: bool,
            share in 0.02..0.2f64,
        ) {
            let region = Region {
                origin: Vector::<3>::new(-3.0, 0.5, 100.0),
                lengths: Vector::<3>::new(x, y, z),
                periodic: [px, py, pz],
            };
            let mut rng = seeded(seed);
            let mut diameters = Vec::new();
            let mut volume = 0.0;
            while volume < share * region.volume() {
                let diameter = 0.5 + crate::setup::random::uniform(&mut rng);
                volume += std::f64::consts::FRAC_PI_6 * diameter * diameter * diameter;
                diameters.push(diameter);
            }
            if let Ok(places) = insert(&region, &diameters, &mut rng) {
                prop_assert!(least_gap(&region, &diameters, &places) > 0.0);
                for (place, diameter) in places.iter().zip(&diameters) {
                    for axis in 0..3 {
                        let inset = if region.periodic[axis] { 0.0 } else { 0.5 * diameter };
                        let low = region.origin[axis] + inset;
                        let high = region.origin[axis] + region.lengths[axis] - inset;
                        prop_assert!(place[axis] >= low && place[axis] <= high);
                    }
                }
            } else {
                // Only narrow walled boxes lack room for 20 %.
                prop_assert!(share > 0.1 && !(px && py && pz));
            }
        }
    }

    #[test]
    fn too_dense_is_refused() {
        let region = Region {
            origin: Vector::<3>::zeros(),
            lengths: Vector::<3>::repeat(8.0),
            periodic: [true; 3],
        };
        let error = insert(&region, &[1.0; 600], &mut seeded(1)).unwrap_err();
        let SetupError::NoRoom { placed, wanted, .. } = error else {
            panic!("{error}");
        };
        // Jamming is near φ = 0.38, which is 370 grains.
        assert!(wanted == 600 && placed > 250 && placed < 400, "{placed}");
    }
}
