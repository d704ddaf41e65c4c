//! All pairs of grains that are near each other.

use crate::analysis::{AnalysisError, Container};
use crate::particle::{Particle, Vector};

/// The place of each cell along each axis, at most.
const MOST_CELLS: usize = 1024;

/// Calls `visit(i, j, separation)` once for each pair i < j whose centres are at
/// most `range` apart, by nearest images; the separation goes from i to j, in d.
/// The order depends on the places alone.
///
/// # Errors
///
/// When the range is not above 0, or longer than half a period, where a grain
/// would see two images of another; when a place is not finite.
pub fn for_each_pair<const D: usize>(
    particles: &[Particle<D>],
    container: &Container<D>,
    range: f64,
    mut visit: impl FnMut(usize, usize, Vector<D>),
) -> Result<(), AnalysisError> {
    check(particles, container, range)?;
    let grid = Grid::new(particles, container, range);
    for (number, particle) in particles.iter().enumerate() {
        grid.for_each_near(&particle.position, |other| {
            if other <= number {
                return;
            }
            let way = container.separation(&particle.position, &particles[other].position);
            if way.norm_squared() <= range * range {
                visit(number, other, way);
            }
        });
    }
    Ok(())
}

fn check<const D: usize>(
    particles: &[Particle<D>],
    container: &Container<D>,
    range: f64,
) -> Result<(), AnalysisError> {
    if !(range > 0.0 && range.is_finite()) {
        return Err(AnalysisError::Parameter {
            field: "the distance of pairs",
            value: range,
            allowed: "a finite number greater than 0 is allowed",
        });
    }
    for axis in 0..D {
        let allowed = 0.5 * container.lengths[axis];
        if container.periodic[axis] && range > allowed {
            return Err(AnalysisError::Distance {
                distance: range,
                allowed,
                reason: "half of the shortest period",
            });
        }
    }
    for particle in particles {
        if let Some(value) = particle.position.iter().find(|place| !place.is_finite()) {
            return Err(AnalysisError::Parameter {
                field: "the position of a grain",
                value: *value,
                allowed: "finite numbers are allowed",
            });
        }
    }
    Ok(())
}

/// Cells not shorter than the range, with the numbers of the grains in them.
struct Grid<const D: usize> {
    low: Vector<D>,
    lengths: Vector<D>,
    counts: [usize; D],
    wraps: [bool; D],
    /// Where each cell begins in `numbers`.
    starts: Vec<usize>,
    numbers: Vec<usize>,
}

impl<const D: usize> Grid<D> {
    fn new(particles: &[Particle<D>], container: &Container<D>, range: f64) -> Self {
        let mut grid = Grid {
            low: container.origin,
            lengths: container.lengths,
            counts: [1; D],
            wraps: container.periodic,
            starts: Vec::new(),
            numbers: vec![0; particles.len()],
        };
        // About one grain a cell is enough.
        let root = libm::ceil(libm::pow(particles.len() as f64, 1.0 / D as f64)) as usize;
        let most = (4 * root).clamp(4, MOST_CELLS);
        for axis in 0..D {
            if !container.periodic[axis] {
                let places = || particles.iter().map(|particle| particle.position[axis]);
                grid.low[axis] = places().fold(f64::INFINITY, f64::min);
                let high = places().fold(f64::NEG_INFINITY, f64::max);
                grid.lengths[axis] = (high - grid.low[axis]).max(range);
            }
            // Below three cells each would be its own neighbour on both sides.
            let count = ((grid.lengths[axis] / range) as usize).min(most);
            grid.counts[axis] = if count < 3 { 1 } else { count };
        }
        let cells: Vec<usize> = particles
            .iter()
            .map(|particle| grid.index(grid.cell(&particle.position)))
            .collect();
        grid.starts = vec![0; grid.counts.iter().product::<usize>() + 1];
        for &cell in &cells {
            grid.starts[cell + 1] += 1;
        }
        for cell in 1..grid.starts.len() {
            grid.starts[cell] += grid.starts[cell - 1];
        }
        let mut next = grid.starts.clone();
        for (number, &cell) in cells.iter().enumerate() {
            grid.numbers[next[cell]] = number;
            next[cell] += 1;
        }
        grid
    }

    fn cell(&self, place: &Vector<D>) -> [usize; D] {
        std::array::from_fn(|axis| {
            let mut share = (place[axis] - self.low[axis]) / self.lengths[axis];
            if self.wraps[axis] {
                share -= libm::floor(share);
            }
            let cell = (share * self.counts[axis] as f64) as usize;
            cell.min(self.counts[axis] - 1)
        })
    }

    fn index(&self, cell: [usize; D]) -> usize {
        (0..D).fold(0, |index, axis| index * self.counts[axis] + cell[axis])
    }

    /// Calls `visit` for the grains in the cell of a place and in those beside
    /// it.
    fn for_each_near(&self, place: &Vector<D>, mut visit: impl FnMut(usize)) {
        let centre = self.cell(place);
        let around = 3usize.pow(D as u32);
        'cells: for step in 0..around {
            let mut rest = step;
            let mut cell = centre;
            for (axis, part) in cell.iter_mut().enumerate() {
                let (by, count) = (rest % 3, self.counts[axis]);
                rest /= 3;
                // by − 1 cells on: one back, none, one on.
                let moved = *part + by;
                *part = match moved {
                    _ if count == 1 && by != 1 => continue 'cells,
                    _ if (1..=count).contains(&moved) => moved - 1,
                    _ if !self.wraps[axis] => continue 'cells,
                    0 => count - 1,
                    _ => 0,
                };
            }
            let index = self.index(cell);
            for &number in &self.numbers[self.starts[index]..self.starts[index + 1]] {
                visit(number);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn check_against_brute_force<const D: usize>(
        places: &[Vec<f64>],
        periodic: [bool; D],
        range: f64,
    ) -> Result<(), TestCaseError> {
        let lengths = Vector::<D>::from_fn(|axis, _| 4.0 + axis as f64);
        let container = Container::new(Vector::repeat(-1.0), lengths, periodic).unwrap();
        let grains: Vec<Particle<D>> = places
            .iter()
            .map(|place| {
                // Some lie outside of the primary cell, whose images count.
                let at = |axis: usize| 1.4 * lengths[axis] * place[axis] - 1.5;
                Particle::fixed(Vector::from_fn(|axis, _| at(axis)))
            })
            .collect();
        let mut found = Vec::new();
        for_each_pair(&grains, &container, range, |i, j, way| {
            assert!(way.norm_squared() <= range * range);
            found.push((i, j));
        })
        .unwrap();
        found.sort_unstable();
        let mut known = Vec::new();
        for i in 0..grains.len() {
            for j in i + 1..grains.len() {
                let way = container.separation(&grains[i].position, &grains[j].position);
                if way.norm_squared() <= range * range {
                    known.push((i, j));
                }
            }
        }
        prop_assert_eq!(found, known);
        Ok(())
    }

    proptest! {
        #[test]
        fn every_pair_is_found_once(
            places in prop::collection::vec(prop::collection::vec(0.0..1.0f64, 3), 0..60),
            periodic in any::<[bool; 3]>(),
            range in 0.1..2.0f64,
        ) {
            check_against_brute_force::<3>(&places, periodic, range)?;
            check_against_brute_force::<2>(&places, [periodic[0], periodic[1]], range)?;
        }
    }

    #[test]
    fn ranges_beyond_half_a_period_are_refused() {
        let lengths = Vector::<2>::new(4.0, 100.0);
        let container = Container::new(Vector::zeros(), lengths, [true, false]).unwrap();
        let error = for_each_pair(&[], &container, 2.1, |_, _, _| {}).unwrap_err();
        assert!(error.to_string().contains("2 is the longest"), "{error}");
        assert!(for_each_pair(&[], &container, -1.0, |_, _, _| {}).is_err());
        let lost = Particle::fixed(Vector::<2>::new(0.0, f64::NAN));
        assert!(for_each_pair(&[lost], &container, 1.0, |_, _, _| {}).is_err());
    }
}
