//! How many pairs of grains a start makes the engine look at.

use std::collections::BTreeMap;

use crate::particle::Particle;

/// The number of ordered pairs of grains in the same or in neighbouring cells,
/// if cells are as large as the largest grain: what it costs to see that no two
/// overlap. It is great if very many grains are near a very large one, or all
/// at one place.
pub(super) fn pairs_in_reach<const D: usize>(grains: &[Particle<D>]) -> f64 {
    let reach = grains
        .iter()
        .map(|grain| grain.diameter)
        .fold(0.0, f64::max);
    let mut cells: BTreeMap<[i64; D], u64> = BTreeMap::new();
    for grain in grains {
        let cell = std::array::from_fn(|axis| libm::floor(grain.position[axis] / reach) as i64);
        *cells.entry(cell).or_insert(0) += 1;
    }
    let mut pairs = 0.0;
    for (cell, count) in &cells {
        let mut near = 0;
        for number in 0..3_usize.pow(D as u32) {
            let mut rest = number;
            let neighbour = cell.map(|place| {
                let step = (rest % 3) as i64 - 1;
                rest /= 3;
                place.saturating_add(step)
            });
            near += cells.get(&neighbour).copied().unwrap_or(0);
        }
        pairs += *count as f64 * near as f64;
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::particle::Vector;

    #[test]
    fn pairs_are_those_of_neighbouring_cells() {
        let at = |x: f64| Particle::<2>::fixed(Vector::<2>::new(x, 0.5));
        assert_eq!(pairs_in_reach::<2>(&[]), 0.0);
        // Cells 0, 1, 3: two of them next to each other.
        assert_eq!(pairs_in_reach(&[at(0.5), at(1.5), at(3.5)]), 5.0);
        let crowd = vec![at(0.5); 100];
        assert_eq!(pairs_in_reach(&crowd), 1.0e4);
        let giant = at(-50.0).with_diameter(100.0);
        let line: Vec<_> = (0..50)
            .map(|k| at(f64::from(k) + 0.5))
            .chain([giant])
            .collect();
        assert_eq!(pairs_in_reach(&line), 51.0 * 51.0);
    }
}
