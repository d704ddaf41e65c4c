//! Whether contacts hold a weight.

use crate::particle::Vector;

/// The most contacts that are looked at: more than a sphere has neighbours of
/// its size; of many small ones, those that come first.
const MOST: usize = 16;

/// Determinants below this are of normals in one plane.
const FLAT: f64 = 1.0e-9;

/// The normals of a grain's contacts, from the obstacle to the grain.
#[derive(Clone, Copy, Debug)]
pub(super) struct Normals<const D: usize> {
    normals: [Vector<D>; MOST],
    count: usize,
}

impl<const D: usize> Normals<D> {
    pub(super) fn new() -> Self {
        Normals {
            normals: [Vector::zeros(); MOST],
            count: 0,
        }
    }

    pub(super) fn add(&mut self, normal: Vector<D>) {
        if self.count < MOST {
            self.normals[self.count] = normal;
            self.count += 1;
        }
    }

    pub(super) fn as_slice(&self) -> &[Vector<D>] {
        &self.normals[..self.count]
    }
}

/// Whether `load` is a sum of the normals with no negative share: pushes along
/// them can carry it. If any can, D of them can (Carathéodory), so every choice
/// of D is tried.
pub(super) fn holds<const D: usize>(normals: &[Vector<D>], load: &Vector<D>) -> bool {
    let count = normals.len();
    if count < D {
        return false;
    }
    let mut chosen: [usize; D] = std::array::from_fn(|place| place);
    loop {
        let columns = std::array::from_fn(|place| normals[chosen[place]]);
        if carried_by(columns, *load) {
            return true;
        }
        // The next choice, in ascending order.
        let Some(place) = (0..D)
            .rev()
            .find(|&place| chosen[place] < count - D + place)
        else {
            return false;
        };
        chosen[place] += 1;
        for later in place + 1..D {
            chosen[later] = chosen[later - 1] + 1;
        }
    }
}

/// Whether the shares of D normals in a load are not negative: elimination with
/// pivots.
fn carried_by<const D: usize>(mut columns: [Vector<D>; D], mut load: Vector<D>) -> bool {
    for step in 0..D {
        let size = |row: &usize| columns[step][*row].abs();
        let Some(pivot) = (step..D).max_by(|a, b| size(a).total_cmp(&size(b))) else {
            return false;
        };
        if columns[step][pivot].abs() < FLAT {
            return false;
        }
        for column in &mut columns {
            column.swap_rows(step, pivot);
        }
        load.swap_rows(step, pivot);
        for row in step + 1..D {
            let factor = columns[step][row] / columns[step][step];
            for column in &mut columns[step..] {
                let above = column[step];
                column[row] -= factor * above;
            }
            load[row] -= factor * load[step];
        }
    }
    for step in (0..D).rev() {
        let share = load[step] / columns[step][step];
        if share < 0.0 {
            return false;
        }
        for row in 0..step {
            load[row] -= share * columns[step][row];
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By Cramer's rule, in space.
    fn by_determinants(normals: &[Vector<3>; 3], load: &Vector<3>) -> bool {
        let det = |a: &Vector<3>, b: &Vector<3>, c: &Vector<3>| a.cross(b).dot(c);
        let [a, b, c] = normals;
        let all = det(a, b, c);
        [det(load, b, c), det(a, load, c), det(a, b, load)]
            .iter()
            .all(|share| share / all >= 0.0)
    }

    #[test]
    fn pits_hold_and_slopes_do_not() {
        let up = Vector::<2>::new(0.0, 1.0);
        let (left, right) = (Vector::<2>::new(0.6, 0.8), Vector::<2>::new(-0.6, 0.8));
        assert!(holds(&[left, right], &up));
        assert!(holds(&[left, right, Vector::<2>::new(1.0, 0.0)], &up));
        assert!(!holds(&[left], &up));
        // Both lean the same way, or from above.
        assert!(!holds(&[left, Vector::<2>::new(0.1, 0.8)], &up));
        assert!(!holds(&[-left, -right], &up));
        assert!(!holds(&[up, up], &Vector::<2>::new(0.1, 1.0)));
    }

    #[test]
    fn shares_are_those_of_cramers_rule() {
        use rand::{RngExt, SeedableRng};
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        let mut draw = || {
            let drawn = Vector::<3>::from_fn(|_, _| random.random::<f64>() - 0.5);
            drawn / drawn.norm()
        };
        let mut held = 0;
        for _ in 0..2000 {
            let normals = [draw(), draw(), draw()];
            let load = draw();
            assert_eq!(holds(&normals, &load), by_determinants(&normals, &load));
            // More contacts hold at least as well, in any order.
            let more = [draw(), normals[2], normals[0], normals[1]];
            assert!(!holds(&normals, &load) || holds(&more, &load));
            held += u32::from(holds(&normals, &load));
        }
        // One octant of eight.
        assert!((200..300).contains(&held), "{held}");
    }
}
