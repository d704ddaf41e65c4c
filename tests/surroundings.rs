//! What observers and policies are shown of the world is what a search through
//! all grains finds.

mod common;

use common::{free, gas_grains, heavy, rain_on_base, rule};
use grainfall::boundary::{Cuboid, Side};
use grainfall::collide::Restitution;
use grainfall::engine::{Limits, Simulation};
use grainfall::model::{Boundary, Observer, Occurrence, Surroundings};
use grainfall::policy::SlowDescent;
use grainfall::setup::Sizes;
use grainfall::{Mode, Particle, ParticleId, Vector, WallId};

/// Compares, at every event, what is shown with a search through all grains.
struct Auditor<const D: usize> {
    boundary: Cuboid<D>,
    range: f64,
    shown: usize,
    events: u64,
}

impl<const D: usize> Auditor<D> {
    fn new(sides: [Side; D], range: f64) -> Self {
        Auditor {
            boundary: Cuboid::new(sides).unwrap(),
            range,
            shown: 0,
            events: 0,
        }
    }
}

impl<const D: usize> Observer<D> for Auditor<D> {
    fn observe<S: Surroundings<D>>(&mut self, occurrence: &Occurrence<D>, after: &S) {
        let of = occurrence.particle;
        let centre = after.particle(of);
        let mut wanted: Vec<(ParticleId, Vector<D>, Mode)> = Vec::new();
        for id in (0..after.particle_count() as u32).map(ParticleId) {
            let other = after.particle(id);
            let offset = self
                .boundary
                .displacement(&centre.position, &other.position);
            let contact = 0.5 * (centre.diameter + other.diameter);
            if id != of && offset.norm() < self.range * contact {
                wanted.push((id, offset, other.mode));
            }
        }
        let mut found = Vec::new();
        after.for_each_neighbour(of, self.range, |near| {
            let other = after.particle(near.id);
            let contact = 0.5 * (centre.diameter + other.diameter);
            let relative = near.offset.norm() / contact;
            assert!((relative - near.relative_distance).abs() < 1.0e-12);
            found.push((near.id, near.offset, near.mode));
        });
        found.sort_by_key(|near| near.0);
        self.shown += found.len();
        self.events += 1;
        assert_eq!(found.len(), wanted.len(), "{found:?}, wanted {wanted:?}");
        for (one, two) in found.iter().zip(&wanted) {
            assert_eq!((one.0, one.2), (two.0, two.2));
            assert!((one.1 - two.1).norm() < 1.0e-12);
        }
        let mut walls = Vec::new();
        after.for_each_wall(of, 0.5, |wall| walls.push((wall.id, wall.gap)));
        for (place, wall) in self.boundary.walls().iter().enumerate() {
            let gap = wall.normal.dot(&centre.position) - wall.offset - centre.radius();
            let id = WallId(place as u16);
            let shown = walls.iter().find(|shown| shown.0 == id);
            assert_eq!(shown.map(|wall| wall.1), (gap < 0.5).then_some(gap));
        }
    }
}

#[test]
fn every_neighbour_is_shown_once() {
    // From boxes a little wider than two grains, where each has its neighbours
    // on both sides, to wide ones.
    for (width, range) in [(2.1, 1.1), (3.0, 1.4), (4.3, 1.5), (5.0, 1.5), (9.0, 2.5)] {
        let sides = [
            Side::periodic(width),
            Side::periodic(4.0),
            Side::floor(-0.5, 0.4),
        ];
        let bed = Particle::fixed(Vector::<3>::zeros());
        let mut grains = vec![bed];
        for layer in 0..6 {
            let place = Vector::<3>::new(0.3 * f64::from(layer), 0.1, 1.5 + 1.1 * f64::from(layer));
            grains.push(Particle::new(place, Vector::zeros()));
        }
        let model = heavy(rule(1.0e-3), SlowDescent::default(), sides);
        let mut simulation = Simulation::new(model, grains).unwrap();
        let mut auditor = Auditor::new(sides, range);
        simulation.run(&Limits::events(300), &mut auditor);
        assert!(auditor.shown > 100, "{} shown", auditor.shown);
    }
}

#[test]
fn neighbours_in_a_gas_of_all_sizes_and_in_a_heap() {
    let sizes = Sizes::Uniform {
        least: 0.3,
        most: 1.5,
    };
    let (mut grains, mut sides) = gas_grains::<2>(1, 120, 0.5, sizes);
    // One axis with walls instead of a period: away with those in the way.
    let Side::Periodic { length, .. } = sides[0] else {
        panic!()
    };
    sides[0] = Side::Walls {
        low: Some(0.0),
        high: Some(length),
        restitution: 1.0,
    };
    grains.retain(|grain| {
        let x = grain.position[0];
        x > grain.radius() && x < length - grain.radius()
    });
    let model = free(Restitution::elastic(), sides);
    let mut auditor = Auditor::new(sides, 1.3);
    let mut simulation = Simulation::new(model, grains).unwrap();
    simulation.run(&Limits::events(3000), &mut auditor);
    assert!(auditor.shown > 3000);

    let sides = common::periodic_laterally::<2>(11.0);
    let grains = rain_on_base::<2>(1, 50, 11.0, sizes);
    let model = heavy(rule(1.0e-3), SlowDescent::default(), sides);
    let mut auditor = Auditor::new(sides, 1.05);
    let mut simulation = Simulation::new(model, grains).unwrap();
    simulation.run(&Limits::events(20_000), &mut auditor);
    assert!(auditor.shown > 10_000);
}
