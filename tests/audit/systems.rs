//! Random systems: a room with a flat or a rough floor, grains of all modes and
//! sizes, and a policy.

use grainfall::boundary::{Cuboid, Side};
use grainfall::engine::Simulation;
use grainfall::model::{Boundary, Place};
use grainfall::policy::{
    Comparison, EnergyStore, SelfCheck, SlowDescent, SpeedRead, Timing, WakeRead,
};
use grainfall::{Mode, Particle, Vector};
use proptest::prelude::*;

use crate::auditor::Heap;
use crate::common::{heavy, rule};

/// Raw numbers of a grain: place in the room (0 … 1), velocity, diameter, mass,
/// and what makes its mode.
pub(crate) type Raw = ([f64; 3], [f64; 3], f64, f64, u8);

pub(crate) fn raw() -> impl Strategy<Value = Raw> {
    (
        [0.0..1.0f64, 0.0..1.0, 0.0..1.0],
        [-2.0..2.0f64, -2.0..2.0, -2.0..2.0],
        0.5..1.4f64,
        0.2..4.0f64,
        0..10u8,
    )
}

pub(crate) fn policy() -> impl Strategy<Value = SlowDescent> {
    (
        0.01..0.6f64,
        0.0..0.6f64,
        0..3u8,
        0..2u8,
        0..2u8,
        0..2u8,
        0..2u8,
        any::<bool>(),
        prop_oneof![
            Just(None),
            Just(Some(Timing::Polled)),
            Just(Some(Timing::Events))
        ],
    )
        .prop_map(
            |(sleep_speed, wake_speed, comparison, speed, wake, place, store, walls, check)| {
                SlowDescent {
                    sleep_speed,
                    wake_speed,
                    comparison: [
                        Comparison::AnyCollision,
                        Comparison::StaticCollisions,
                        Comparison::None,
                    ][usize::from(comparison)],
                    speed_read: [SpeedRead::Arriving, SpeedRead::Leaving][usize::from(speed)],
                    wake_read: [WakeRead::Normal, WakeRead::Relative][usize::from(wake)],
                    place: [Place::HalfWay, Place::Here][usize::from(place)],
                    energy_store: [EnergyStore::VelocityBefore, EnergyStore::EnergyAfter]
                        [usize::from(store)],
                    wall_supports: walls,
                    self_check: check.map(|timing| SelfCheck {
                        timing,
                        ..SelfCheck::default()
                    }),
                    ..SlowDescent::default()
                }
            },
        )
}

/// The box of a system, and what its floor is like.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Room {
    lengths: [f64; 3],
    periodic: [bool; 3],
    /// A layer of fixed grains instead of a flat wall.
    rough: bool,
}

pub(crate) fn room() -> impl Strategy<Value = Room> {
    (
        [2.9..5.5f64, 2.9..4.5, 0.0..1.0],
        any::<[bool; 3]>(),
        0..4u8,
    )
        .prop_map(|(lengths, periodic, rough)| Room {
            lengths,
            periodic,
            rough: rough > 0,
        })
}

impl Room {
    fn sides<const D: usize>(&self) -> [Side; D] {
        std::array::from_fn(|axis| {
            let length = self.lengths[axis];
            if axis == D - 1 && self.rough {
                Side::Open
            } else if axis == D - 1 {
                Side::floor(0.0, 0.6)
            } else if self.periodic[axis] {
                Side::Periodic {
                    origin: -0.5,
                    length,
                }
            } else {
                Side::Walls {
                    low: Some(-0.5),
                    high: Some(length - 0.5),
                    restitution: 0.8,
                }
            }
        })
    }

    /// The least and the largest place of a grain's centre along a lateral axis.
    fn range(&self, axis: usize, radius: f64) -> (f64, f64) {
        let inset = if self.periodic[axis] { 0.0 } else { radius };
        (inset - 0.5, self.lengths[axis] - 0.5 - inset)
    }

    /// Fixed grains side by side, no hole wide enough for another.
    fn bed<const D: usize>(&self) -> Vec<Particle<D>> {
        if !self.rough {
            return Vec::new();
        }
        let mut places = vec![Vector::<D>::zeros()];
        for axis in 0..D - 1 {
            let (low, high) = self.range(axis, 0.4);
            let count = ((high - low) / 0.9).ceil();
            let mut more = Vec::new();
            for place in &places {
                for step in 0..=count as u32 {
                    let mut place: Vector<D> = *place;
                    place[axis] = low + (high - low) * f64::from(step) / count;
                    more.push(place);
                }
            }
            places = more;
        }
        let fixed = |place| Particle::fixed(place).with_diameter(0.8);
        places.into_iter().map(fixed).collect()
    }
}

/// Puts grains into a room, as many as find a place.
pub(crate) fn put_together<const D: usize>(
    raws: &[Raw],
    room: Room,
    elastic_speed: f64,
    policy: SlowDescent,
) -> Heap<D> {
    let sides = room.sides::<D>();
    let boundary = Cuboid::new(sides).unwrap();
    let mut grains = room.bed::<D>();
    for (place, velocity, diameter, mass, mode) in raws {
        let mode = match mode {
            0 => Mode::Fixed,
            1 | 2 => Mode::Frozen,
            3 => Mode::Falling,
            _ => Mode::Normal,
        };
        let radius = 0.5 * diameter;
        let position = Vector::<D>::from_fn(|axis, _| {
            let (low, high) = if axis == D - 1 {
                (radius, 6.0 - D as f64)
            } else {
                room.range(axis, radius)
            };
            low + place[axis] * (high - low)
        });
        let free = grains.iter().all(|other| {
            let apart = boundary.displacement(&position, &other.position);
            apart.norm() > radius + other.radius()
        });
        if free {
            grains.push(Particle {
                position,
                velocity: Vector::from_fn(|axis, _| match mode {
                    Mode::Fixed | Mode::Frozen => 0.0,
                    // Down, so that it does not gain energy.
                    Mode::Falling if axis == D - 1 => -velocity[axis].abs(),
                    Mode::Falling | Mode::Normal => velocity[axis],
                }),
                diameter: *diameter,
                mass: *mass,
                mode,
            });
        }
    }
    Simulation::new(heavy(rule(elastic_speed), policy, sides), grains).unwrap()
}
