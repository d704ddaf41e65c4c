//! The limit of a cascade: the velocity nearest to a grain's own among those
//! that leave every static contact it touches.
//!
//! A grain that touches two or three static ones at once is handed from one to
//! the other by ever smaller impulses along their normals; the outcome of that
//! endless sequence is, to a few 1e-5 of the velocity, the projection on the
//! cone {u : n·u ≥ s for every contact normal n}.

use crate::particle::Vector;

/// A touched surface: unit normal away from it, and its own velocity along that
/// normal, in √(gd).
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch<const D: usize> {
    pub(super) normal: Vector<D>,
    pub(super) speed: f64,
}

/// Slack of the inequalities, in √(gd): rounding of a sum of a few products.
const TOLERANCE: f64 = 2.0e-14;

/// The velocity nearest to `velocity` with `normal · u ≥ speed + exit` for
/// every touch; `None` if there is none.
pub(super) fn project<const D: usize>(
    velocity: Vector<D>,
    touches: &[Touch<D>],
    exit: f64,
) -> Option<Vector<D>> {
    let shortfall = |u: &Vector<D>, touch: &Touch<D>| touch.speed + exit - touch.normal.dot(u);
    let allowed = |u: &Vector<D>| touches.iter().all(|touch| shortfall(u, touch) <= TOLERANCE);
    if allowed(&velocity) {
        return Some(velocity);
    }
    // By convexity the answer is the nearest point for which some set of at
    // most D contacts holds with equality and pushes outwards.
    let mut chosen = [0usize; D];
    for size in 1..=D.min(touches.len()) {
        for (place, slot) in chosen.iter_mut().enumerate() {
            *slot = place;
        }
        loop {
            let set = &chosen[..size];
            if let Some(pushes) = solve(set, touches, |touch| shortfall(&velocity, touch)) {
                let mut moved = velocity;
                for (touch, push) in set.iter().zip(pushes) {
                    moved += touches[*touch].normal * push;
                }
                if pushes[..size].iter().all(|push| *push >= 0.0) && allowed(&moved) {
                    return Some(moved);
                }
            }
            if !next_subset(&mut chosen[..size], touches.len()) {
                break;
            }
        }
    }
    None
}

/// The pushes along the normals of `set` that make up their shortfalls; `None`
/// if the normals are not independent.
fn solve<const D: usize>(
    set: &[usize],
    touches: &[Touch<D>],
    shortfall: impl Fn(&Touch<D>) -> f64,
) -> Option<[f64; D]> {
    let size = set.len();
    let mut matrix = [[0.0; D]; D];
    let mut pushes = [0.0; D];
    for row in 0..size {
        for column in 0..size {
            matrix[row][column] = touches[set[row]].normal.dot(&touches[set[column]].normal);
        }
        pushes[row] = shortfall(&touches[set[row]]);
    }
    // Gaussian elimination; Gram matrices need no pivoting.
    for pivot in 0..size {
        if matrix[pivot][pivot] < 1.0e-9 {
            return None;
        }
        for row in pivot + 1..size {
            let factor = matrix[row][pivot] / matrix[pivot][pivot];
            for column in pivot..size {
                matrix[row][column] -= factor * matrix[pivot][column];
            }
            pushes[row] -= factor * pushes[pivot];
        }
    }
    for row in (0..size).rev() {
        for column in row + 1..size {
            pushes[row] -= matrix[row][column] * pushes[column];
        }
        pushes[row] /= matrix[row][row];
    }
    Some(pushes)
}

/// The next subset of `0..count` in lexicographic order.
fn next_subset(subset: &mut [usize], count: usize) -> bool {
    let size = subset.len();
    for place in (0..size).rev() {
        if subset[place] + size - place < count {
            subset[place] += 1;
            for later in place + 1..size {
                subset[later] = subset[later - 1] + 1;
            }
            return true;
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::particle::Vector;
    use proptest::prelude::*;

    fn touch(x: f64, y: f64, z: f64) -> Touch<3> {
        Touch {
            normal: Vector::<3>::new(x, y, z).normalize(),
            speed: 0.0,
        }
    }

    #[test]
    fn one_contact_takes_the_normal_part() {
        let touches = [touch(0.0, 0.0, 1.0)];
        let u = project(Vector::<3>::new(1.0, 2.0, -3.0), &touches, 0.5).unwrap();
        assert_eq!(u, Vector::<3>::new(1.0, 2.0, 0.5));
    }

    #[test]
    fn a_groove_keeps_the_motion_along_it() {
        let touches = [touch(1.0, 0.0, 1.0), touch(-1.0, 0.0, 1.0)];
        let u = project(Vector::<3>::new(0.3, 0.7, -1.0), &touches, 0.0).unwrap();
        assert!((u - Vector::<3>::new(0.0, 0.7, 0.0)).norm() < 1e-15);
    }

    #[test]
    fn a_cage_has_no_way_out() {
        let touches = [
            touch(1.0, 0.0, 0.0),
            touch(-1.0, 0.0, 0.0),
            touch(0.0, 1.0, 0.0),
            touch(0.0, -1.0, 0.0),
        ];
        assert_eq!(
            project(Vector::<3>::new(0.1, 0.0, 0.0), &touches, 1e-5),
            None
        );
        let still = project(Vector::<3>::new(0.1, 0.2, 0.0), &touches, 0.0).unwrap();
        assert!(still.norm() < 1e-14);
    }

    proptest! {
        /// The projection is feasible, and no feasible velocity is nearer:
        /// v − u makes an obtuse angle with every feasible direction.
        #[test]
        fn nothing_allowed_is_nearer(
            v in proptest::array::uniform3(-1.0..1.0f64),
            normals in proptest::collection::vec(proptest::array::uniform3(-1.0..1.0f64), 1..7),
            trial in proptest::array::uniform3(-1.0..1.0f64),
        ) {
            let v = Vector::<3>::from(v);
            let touches: Vec<_> = normals
                .iter()
                .map(|n| touch(n[0], n[1], n[2].abs() + 0.2))
                .collect();
            let u = project(v, &touches, 0.0).unwrap();
            for t in &touches {
                prop_assert!(t.normal.dot(&u) >= -1e-12);
            }
            let trial = Vector::<3>::from(trial);
            if touches.iter().all(|t| t.normal.dot(&trial) >= 0.0) {
                prop_assert!((v - u).dot(&(trial - u)) <= 1e-9);
            }
        }
    }
}
