//! What holds of `examples/own_boundary.rs`, of which this is a part.

use super::*;

fn is_on_the_polygon<const D: usize>() {
    for (impact, (time, off)) in (1..).zip(billiard::<D>(5.0, 200).unwrap()) {
        let chord = 2.0 * 4.5 * libm::cos(40.0_f64.to_radians());
        assert!((time / (chord * f64::from(impact)) - 1.0).abs() < 1.0e-13);
        assert!(off < 1.0e-11, "impact {impact}: {off:e}");
    }
}

#[test]
fn a_billiard_follows_a_polygon() {
    is_on_the_polygon::<2>();
    is_on_the_polygon::<3>();
}

fn fills_and_empties<const D: usize>() {
    let cone = Cone::new(2.5, 50.0, 0.4).unwrap();
    let found = hopper::<D>(cone, 3, &mut |_, _, _, _| {}).unwrap();
    assert!(found.asleep_at < 60.0 && found.above[0] > 15, "{found:?}");
    assert!(found.deepest < 1.0e-13, "{found:?}");
    assert_eq!(found.above.last(), Some(&0), "{found:?}");
}

#[test]
fn a_hopper_holds_grains_until_it_is_opened() {
    fills_and_empties::<2>();
    fills_and_empties::<3>();
}

#[test]
fn what_cannot_be_is_refused() {
    let said = Cone::new(0.8, 50.0, 0.4)
        .err()
        .map(|error| error.to_string());
    let wanted = "hole is 0.8; a radius greater than 1 is allowed";
    assert_eq!(said.as_deref(), Some(wanted));
    // The engine looks at walls itself, too.
    let small = |radius, restitution| {
        let model = Parts {
            dynamics: ForceFree,
            predictor: Polynomial,
            collision_rule: Restitution::elastic(),
            state_policy: Never,
            boundary: Single([Bowl {
                radius,
                restitution,
            }]),
        };
        let grain = Particle::new(Vector::<2>::new(3.0, 0.0), Vector::zeros());
        Simulation::new(model, vec![grain])
            .err()
            .map(|error| error.to_string())
    };
    assert_eq!(small(5.0, 1.0), None);
    let wanted = "wall 0: restitution is 1.5; 0 … 1 is allowed";
    assert_eq!(small(5.0, 1.5).as_deref(), Some(wanted));
    let wanted = "wall 0: curvature is -2; a bound, 0 or more, is allowed";
    assert_eq!(small(0.5, 1.0).as_deref(), Some(wanted));
    let wanted = "grain 0 reaches 5e-1 d beyond wall 0; it may touch, to within 1e-9 d";
    assert_eq!(small(3.0, 1.0).as_deref(), Some(wanted));
}

/// In a plane through the axis of a cone a grain bounces as between two planes,
/// which the predictor knows in closed form.
#[test]
fn bounces_in_a_cone_are_those_between_two_slopes() {
    /// Time, velocity and place, outwards and upwards, just after each impact.
    fn impacts<const D: usize, B: Boundary<D>>(boundary: B, out: usize) -> Vec<[f64; 5]> {
        let model = Parts {
            dynamics: UniformGravity::<D>::down(),
            predictor: Polynomial,
            collision_rule: Restitution::elastic(),
            state_policy: Never,
            boundary,
        };
        let mut place: Vector<D> = along(D - 1, 5.5);
        place[out] = 9.0;
        let mut simulation =
            Simulation::new(model, vec![Particle::new(place, Vector::zeros())]).unwrap();
        let state = |impact| {
            simulation.run(&Limits::events(impact), &mut ());
            let Particle {
                position: x,
                velocity: v,
                ..
            } = simulation.particle(ParticleId(0));
            [
                simulation.time().units(),
                v[out],
                v[D - 1],
                x[out],
                x[D - 1],
            ]
        };
        (1..=12).map(state).collect()
    }
    #[derive(Debug)]
    struct Slopes([Plane<2>; 2]);
    impl Boundary<2> for Slopes {
        type Wall = Plane<2>;
        fn period(&self, _axis: usize) -> Option<Period> {
            None
        }
        fn walls(&self) -> &[Plane<2>] {
            &self.0
        }
    }
    let cone = Cone::new(2.5, 30.0, 0.5).unwrap();
    let [out, up] = cone.normal;
    let slope = |side: f64| Plane {
        normal: Vector::<2>::new(side * out, up),
        offset: 2.5 * out,
        restitution: 0.5,
    };
    let wanted = impacts(Slopes([slope(1.0), slope(-1.0)]), 0);
    let in_the_plane = impacts(Hopper::<2>::new(cone, -40.0), 0);
    let in_space = impacts(Hopper::<3>::new(cone, -40.0), 1);
    for (hit, wanted) in wanted.iter().enumerate() {
        for (part, value) in wanted.iter().enumerate() {
            let off = [in_the_plane[hit][part] - value, in_space[hit][part] - value];
            assert!(off.iter().all(|off| off.abs() < 1.0e-11), "{hit}: {off:?}");
        }
    }
}
