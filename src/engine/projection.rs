//! The limit of a cascade: the velocities nearest to the grains' own among
//! those with which nothing that touches comes nearer.
//!
//! Grains that touch several others at once are handed from one to the other by
//! ever smaller impulses along the contact normals; where that endless sequence
//! leads is, to a small part of the velocity, the projection of all velocities,
//! with the masses for weights, on the cone {n·(u₁ − u₂) ≥ s for every contact}:
//! the plastic impact of many contacts at once (Moreau 1988,
//! doi:10.1007/978-3-7091-2624-0_1).

use crate::particle::Vector;

/// One side of a contact that can move: which grain of the cluster, and its
/// mass.
#[derive(Clone, Copy, Debug)]
pub(super) struct Member {
    pub(super) place: usize,
    pub(super) mass: f64,
}

/// Two surfaces that touch: a grain of the cluster and another, or a static
/// one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch<const D: usize> {
    pub(super) one: Member,
    pub(super) other: Option<Member>,
    /// Unit normal from the other to the one.
    pub(super) normal: Vector<D>,
    /// Speed of a static surface along the normal, in √(gd).
    pub(super) speed: f64,
}

impl<const D: usize> Touch<D> {
    /// Whether it is a contact with a static surface.
    pub(super) fn is_on_static(&self) -> bool {
        self.other.is_none()
    }

    /// Whether a grain of the cluster takes part in it.
    pub(super) fn is_of(&self, place: usize) -> bool {
        self.one.place == place || self.other.is_some_and(|other| other.place == place)
    }

    /// How fast the two separate.
    fn separation(&self, velocities: &[Vector<D>]) -> f64 {
        let mut relative = velocities[self.one.place];
        if let Some(other) = self.other {
            relative -= velocities[other.place];
        }
        relative.dot(&self.normal) - self.speed
    }

    /// Change of `self`'s separation for a unit impulse in `by`.
    fn response(&self, by: &Touch<D>) -> f64 {
        let mut along = 0.0;
        for (mine, my_sign) in [(Some(self.one), 1.0), (self.other, -1.0)] {
            for (theirs, their_sign) in [(Some(by.one), 1.0), (by.other, -1.0)] {
                if let (Some(mine), Some(theirs)) = (mine, theirs)
                    && mine.place == theirs.place
                {
                    along += my_sign * their_sign / mine.mass;
                }
            }
        }
        along * self.normal.dot(&by.normal)
    }

    fn push(&self, impulse: f64, velocities: &mut [Vector<D>]) {
        velocities[self.one.place] += self.normal * (impulse / self.one.mass);
        if let Some(other) = self.other {
            velocities[other.place] -= self.normal * (impulse / other.mass);
        }
    }
}

/// Added to the response of each contact to itself, so that redundant contacts
/// share their impulse.
const SOFTNESS: f64 = 1.0e-13;

/// How fast two surfaces may still close after a projection without exit
/// speed, in √(gd).
const CREEP: f64 = 1.0e-9;

/// The velocities nearest to `velocities` with which every touch separates at
/// `exit` or faster, in √(gd), to a hundredth of a permille; `None` if there
/// are none.
pub(super) fn project<const D: usize>(
    velocities: &[Vector<D>],
    touches: &[Touch<D>],
    exit: f64,
) -> Option<Vec<Vector<D>>> {
    project_within(velocities, touches, exit, CREEP)
}

/// The same, where surfaces may still close as fast as `creep`, in √(gd).
pub(super) fn project_within<const D: usize>(
    velocities: &[Vector<D>],
    touches: &[Touch<D>],
    exit: f64,
    creep: f64,
) -> Option<Vec<Vector<D>>> {
    let count = touches.len();
    let shortfalls: Vec<f64> = touches
        .iter()
        .map(|touch| exit - touch.separation(velocities))
        .collect();
    let scale = shortfalls.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    let tolerance = 1.0e-5 * exit + 1.0e-13 + 1.0e-9 * scale;
    let response = |row: usize, column: usize| {
        let soft = if row == column { SOFTNESS } else { 0.0 };
        touches[row].response(&touches[column]) + soft
    };
    // Active sets as in Lawson & Hanson's non-negative least squares: contacts
    // join while they fall short and leave when they would have to pull.
    let mut impulses = vec![0.0; count];
    let mut active: Vec<usize> = Vec::new();
    for _ in 0..20 * (count + 1) {
        let worst = (0..count)
            .filter(|place| !active.contains(place))
            .map(|place| {
                let gained: f64 = active
                    .iter()
                    .map(|&by| response(place, by) * impulses[by])
                    .sum();
                (place, shortfalls[place] - gained)
            })
            .filter(|(_, shortfall)| *shortfall > tolerance)
            .max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((joining, _)) = worst else {
            let mut moved = velocities.to_vec();
            for (touch, impulse) in touches.iter().zip(&impulses) {
                touch.push(*impulse, &mut moved);
            }
            // Contacts that work against each other only seem to agree, by
            // their softness.
            let free = |touch: &Touch<D>| touch.separation(&moved) > 0.9 * exit - creep;
            return touches.iter().all(free).then_some(moved);
        };
        active.push(joining);
        loop {
            let wanted = solve(&active, response, &shortfalls)?;
            // As far as the first that would have to pull.
            let mut part = 1.0;
            let mut leaving = None;
            for (place, (&contact, &want)) in active.iter().zip(&wanted).enumerate() {
                if want < 0.0 {
                    let step = impulses[contact] / (impulses[contact] - want);
                    if step < part {
                        part = step;
                        leaving = Some(place);
                    }
                }
            }
            for (&contact, &want) in active.iter().zip(&wanted) {
                impulses[contact] += part * (want - impulses[contact]);
            }
            let Some(place) = leaving else { break };
            impulses[active[place]] = 0.0;
            active.remove(place);
        }
    }
    None
}

/// Impulses with which the contacts of `set` just make up their shortfalls.
fn solve(
    set: &[usize],
    response: impl Fn(usize, usize) -> f64,
    shortfalls: &[f64],
) -> Option<Vec<f64>> {
    let size = set.len();
    let matrix =
        nalgebra::DMatrix::from_fn(size, size, |row, column| response(set[row], set[column]));
    let wanted = nalgebra::DVector::from_fn(size, |row, _| shortfalls[set[row]]);
    let solution = matrix.cholesky()?.solve(&wanted);
    Some(solution.iter().copied().collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn touch(x: f64, y: f64, z: f64) -> Touch<3> {
        Touch {
            one: Member {
                place: 0,
                mass: 1.0,
            },
            other: None,
            normal: Vector::<3>::new(x, y, z).normalize(),
            speed: 0.0,
        }
    }

    fn single(velocity: Vector<3>, touches: &[Touch<3>], exit: f64) -> Option<Vector<3>> {
        project(&[velocity], touches, exit).map(|moved| moved[0])
    }

    #[test]
    fn one_contact_takes_the_normal_part() {
        let u = single(
            Vector::<3>::new(1.0, 2.0, -3.0),
            &[touch(0.0, 0.0, 1.0)],
            0.5,
        )
        .unwrap();
        assert!((u - Vector::<3>::new(1.0, 2.0, 0.5)).norm() < 1e-8);
    }

    #[test]
    fn a_groove_keeps_the_motion_along_it() {
        let touches = [touch(1.0, 0.0, 1.0), touch(-1.0, 0.0, 1.0)];
        let u = single(Vector::<3>::new(0.3, 0.7, -1.0), &touches, 0.0).unwrap();
        assert!((u - Vector::<3>::new(0.0, 0.7, 0.0)).norm() < 1e-8);
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
            single(Vector::<3>::new(0.1, 0.0, 0.0), &touches, 1e-5),
            None
        );
        let still = single(Vector::<3>::new(0.1, 0.2, 0.0), &touches, 0.0).unwrap();
        assert!(still.norm() < 1e-8);
    }

    #[test]
    fn a_pressed_pair_shares_its_momentum() {
        // Two grains in a row on a line, the heavier one running into the other.
        let pair = Touch::<3> {
            one: Member {
                place: 0,
                mass: 1.0,
            },
            other: Some(Member {
                place: 1,
                mass: 3.0,
            }),
            normal: Vector::<3>::new(1.0, 0.0, 0.0),
            speed: 0.0,
        };
        let before = [Vector::<3>::zeros(), Vector::<3>::new(1.0, 0.5, 0.0)];
        let after = project(&before, &[pair], 0.0).unwrap();
        assert!((after[0].x - 0.75).abs() < 1e-8 && (after[1].x - 0.75).abs() < 1e-8);
        assert_eq!(after[1].y, 0.5);
    }

    proptest! {
        /// The projection is feasible, and no feasible velocity is nearer:
        /// v − u makes an obtuse angle with every feasible direction.
        #[test]
        fn nothing_allowed_is_nearer(
            v in proptest::array::uniform3(-1.0..1.0f64),
            normals in proptest::collection::vec(proptest::array::uniform3(-1.0..1.0f64), 1..9),
            trial in proptest::array::uniform3(-1.0..1.0f64),
        ) {
            let v = Vector::<3>::from(v);
            let touches: Vec<_> = normals
                .iter()
                .map(|n| touch(n[0], n[1], n[2].abs() + 0.2))
                .collect();
            let u = single(v, &touches, 0.0).unwrap();
            for t in &touches {
                prop_assert!(t.normal.dot(&u) >= -1e-7);
            }
            let trial = Vector::<3>::from(trial);
            if touches.iter().all(|t| t.normal.dot(&trial) >= 0.0) {
                prop_assert!((v - u).dot(&(trial - u)) <= 1e-6);
            }
        }
    }
}
