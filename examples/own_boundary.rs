//! Boundaries of one's own: a round container, and a hopper that is filled and
//! opened. Each is written once, for the plane and for space.
//!
//! cargo run --release --example own_boundary
//! cargo run --release --example own_boundary -- FOLDER     with pictures

use grainfall::boundary::Plane;
use grainfall::collide::Restitution;
use grainfall::dynamics::{ForceFree, UniformGravity};
use grainfall::engine::{Limits, Simulation, StopReason};
use grainfall::model::{Boundary, Parts, Period, Shape, Wall};
use grainfall::policy::{Never, SlowDescent};
use grainfall::predict::Polynomial;
use grainfall::{Mode, Particle, ParticleId, SetupError, Time, Vector, along};
use serde::{Deserialize, Serialize};
#[cfg(feature = "program")]
use {
    grainfall::boundary::Cuboid,
    grainfall::model::{Dynamics, Model, Predictor, StatePolicy},
    grainfall::program::Refit,
};

/// The inside of a sphere about the origin; of a circle in the plane.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Bowl {
    /// Its radius, in d.
    radius: f64,
    /// Coefficient of restitution.
    restitution: f64,
}

impl<const D: usize> Wall<D> for Bowl {
    fn distance(&self, position: &Vector<D>, _time: Time) -> f64 {
        self.radius - position.norm()
    }

    fn normal(&self, position: &Vector<D>, _time: Time) -> Vector<D> {
        // The centre has none of its own: any will do there.
        let inward = -position.normalize();
        if inward[0].is_nan() {
            along(0, 1.0)
        } else {
            inward
        }
    }

    fn restitution(&self) -> f64 {
        self.restitution
    }

    fn shape(&self) -> Shape<D> {
        Shape::General {
            // Of the sphere one diameter farther in, which is curved most.
            curvature: 1.0 / (self.radius - 1.0),
            speed: 0.0,
            acceleration: 0.0,
        }
    }
}

/// A single wall and no period.
#[derive(Clone, Copy, Debug)]
struct Single<W>([W; 1]);

impl<const D: usize, W: Wall<D>> Boundary<D> for Single<W> {
    type Wall = W;

    fn period(&self, _axis: usize) -> Option<Period> {
        None
    }

    fn walls(&self) -> &[W] {
        &self.0
    }
}

/// For the whole program in a bowl, with the fields as parameters in scenarios.
#[cfg(feature = "program")]
impl Refit for Bowl {
    fn refit<Y, P, S, const D: usize>(
        &self,
        parts: Parts<Y, P, Restitution, S, Cuboid<D>>,
    ) -> impl Model<D>
    where
        Y: Dynamics<D>,
        P: Predictor<D, Y::Flight>,
        S: StatePolicy<D>,
    {
        parts.with_boundary(Single([*self]))
    }
}

/// A block with a hole that widens upwards: a cone about the last axis, in the
/// plane two slopes. The rim of the hole is at height 0.
#[derive(Clone, Copy, Debug)]
struct Cone {
    /// Radius of the hole, in d.
    hole: f64,
    /// Up along the slope and into the free side, as seen in a half-plane through
    /// the axis: outwards and upwards.
    slope: [f64; 2],
    normal: [f64; 2],
    restitution: f64,
}

impl Cone {
    /// A slope of so many degrees against the horizontal.
    fn new(hole: f64, degrees: f64, restitution: f64) -> Result<Self, SetupError> {
        // Nearer to the axis than one diameter the cone's curvature has no bound.
        if hole.is_nan() || hole <= 1.0 {
            return Err(SetupError::Parameter {
                field: "hole",
                value: hole,
                allowed: "a radius greater than 1 is allowed",
            });
        }
        let (sine, cosine) = libm::sincos(degrees.to_radians());
        Ok(Cone {
            hole,
            slope: [cosine, sine],
            normal: [-sine, cosine],
            restitution,
        })
    }

    /// The distance of a point, and the direction in which it grows, outwards and
    /// upwards.
    fn nearest<const D: usize>(&self, position: &Vector<D>) -> (f64, [f64; 2]) {
        let (out, up) = (from_axis(position).norm() - self.hole, position[D - 1]);
        // Above the slope, and below the block.
        let above = out * self.normal[0] + up * self.normal[1];
        let below = -(out * self.slope[0] + up * self.slope[1]);
        if below <= 0.0 || (above <= 0.0 && above > below) {
            (above, self.normal)
        } else if above <= 0.0 {
            (below, self.slope.map(|part| -part))
        } else {
            // The rim is nearest.
            let distance = (out * out + up * up).sqrt();
            (distance, [out / distance, up / distance])
        }
    }
}

/// From the last axis to a point.
fn from_axis<const D: usize>(position: &Vector<D>) -> Vector<D> {
    let mut out = *position;
    out[D - 1] = 0.0;
    out
}

impl<const D: usize> Wall<D> for Cone {
    fn distance(&self, position: &Vector<D>, _time: Time) -> f64 {
        self.nearest(position).0
    }

    fn normal(&self, position: &Vector<D>, _time: Time) -> Vector<D> {
        let [out, up] = self.nearest(position).1;
        let radial = from_axis(position);
        let length = radial.norm();
        let mut normal = if length > 0.0 {
            radial * (out / length)
        } else {
            along(0, out)
        };
        normal[D - 1] = up;
        normal
    }

    fn restitution(&self) -> f64 {
        self.restitution
    }

    fn shape(&self) -> Shape<D> {
        Shape::General {
            curvature: 1.0 / (self.hole - 1.0),
            speed: 0.0,
            acceleration: 0.0,
        }
    }
}

/// All walls of a boundary are of one type: an enum, where they differ.
#[derive(Clone, Copy, Debug)]
enum Side<const D: usize> {
    Cone(Cone),
    Plane(Plane<D>),
}

impl<const D: usize> Side<D> {
    fn wall(&self) -> &dyn Wall<D> {
        match self {
            Side::Cone(cone) => cone,
            Side::Plane(plane) => plane,
        }
    }
}

impl<const D: usize> Wall<D> for Side<D> {
    fn distance(&self, position: &Vector<D>, time: Time) -> f64 {
        self.wall().distance(position, time)
    }

    fn normal(&self, position: &Vector<D>, time: Time) -> Vector<D> {
        self.wall().normal(position, time)
    }

    fn restitution(&self) -> f64 {
        self.wall().restitution()
    }

    fn shape(&self) -> Shape<D> {
        self.wall().shape()
    }
}

/// A hopper over a floor.
#[derive(Clone, Copy, Debug)]
struct Hopper<const D: usize> {
    sides: [Side<D>; 2],
}

impl<const D: usize> Hopper<D> {
    /// With the floor at this height, in d: at 0 it closes the hole.
    fn new(cone: Cone, floor: f64) -> Self {
        let floor = Plane {
            normal: along(D - 1, 1.0),
            offset: floor,
            restitution: cone.restitution,
        };
        Hopper {
            sides: [Side::Cone(cone), Side::Plane(floor)],
        }
    }
}

impl<const D: usize> Boundary<D> for Hopper<D> {
    type Wall = Side<D>;

    fn period(&self, _axis: usize) -> Option<Period> {
        None
    }

    fn walls(&self) -> &[Side<D>] {
        &self.sides
    }
}

/// The chords of a billiard in a bowl: the times of impact and, after each, how far
/// the centre is from where an exact polygon has it, in d.
fn billiard<const D: usize>(radius: f64, impacts: u64) -> Result<Vec<(f64, f64)>, SetupError> {
    let bowl = Bowl {
        radius,
        restitution: 1.0,
    };
    let model = Parts {
        dynamics: ForceFree,
        predictor: Polynomial,
        collision_rule: Restitution::elastic(),
        state_policy: Never,
        boundary: Single([bowl]),
    };
    // From the wall, at 40° from the normal there, in the plane of the first and
    // the last axis.
    let reach = radius - 0.5;
    let angle = 40.0_f64.to_radians();
    let start: Vector<D> = along(0, -reach);
    let mut velocity = along(0, libm::cos(angle));
    velocity[D - 1] = libm::sin(angle);
    let grain = Particle::new(start, velocity);
    let mut simulation = Simulation::new(model, vec![grain])?;
    let mut found = Vec::new();
    for impact in 1..=impacts {
        simulation.run(&Limits::events(impact), &mut ());
        // Each chord turns by π − 2 angle about the centre.
        let turned = impact as f64 * (std::f64::consts::PI - 2.0 * angle);
        let (sine, cosine) = libm::sincos(turned);
        let mut corner = along(0, -reach * cosine);
        corner[D - 1] = reach * sine;
        let off = simulation.particle(ParticleId(0)).position - corner;
        found.push((simulation.time().units(), off.norm()));
    }
    Ok(found)
}

/// What has become of a hopper full of grains.
#[derive(Debug)]
struct Emptied {
    /// When all were asleep in it.
    asleep_at: f64,
    /// The deepest that any of them then was in a wall, in d.
    deepest: f64,
    /// Grains still above the hole, one √(d/g) after the other, once it is open.
    above: Vec<usize>,
}

/// Is shown the grains, by a name, at a time and in a hopper.
type Show<'a, const D: usize> = dyn FnMut(&str, &[Particle<D>], Time, &Hopper<D>) + 'a;

/// Pours grains into a closed hopper, lets them fall asleep and opens it; `show` is
/// shown the grains on the way.
fn hopper<const D: usize>(
    cone: Cone,
    layers: usize,
    show: &mut Show<'_, D>,
) -> Result<Emptied, SetupError> {
    let closed = Hopper::<D>::new(cone, 0.0);
    let model = Parts {
        dynamics: UniformGravity::<D>::down(),
        predictor: Polynomial,
        collision_rule: Restitution {
            elastic_speed: 1.0e-3,
            ..Restitution::default()
        },
        state_policy: SlowDescent {
            wall_supports: true,
            ..SlowDescent::with_threshold(0.3)
        },
        boundary: closed,
    };
    let mut full = Simulation::new(model, poured(&closed, layers))?;
    let limits = Limits {
        time: Time::from_units(60.0),
        ..Limits::all_frozen()
    };
    let why = full.run(&limits, &mut ());
    let asleep_at = full.time().units();
    let mut grains = full.snapshot();
    show("full", &grains, full.time(), &closed);
    let deepest = grains
        .iter()
        .flat_map(|grain| closed.walls().iter().map(move |wall| (grain, wall)))
        .map(|(grain, wall)| grain.radius() - wall.distance(&grain.position, full.time()))
        .fold(f64::NEG_INFINITY, f64::max);
    if why != StopReason::AllFrozen {
        println!("    {:?} are still awake", full.mode_counts());
    }

    // The gate opens: the same grains, awake, over a floor 12 d below.
    for grain in &mut grains {
        grain.mode = Mode::Normal;
    }
    let open = Hopper::<D>::new(cone, -12.0);
    let model = model.with_boundary(open).with_policy(Never);
    let mut emptying = Simulation::new(model, grains)?;
    let mut above = Vec::new();
    for time in 0..=12 {
        emptying.run(&Limits::until(Time::from_units(f64::from(time))), &mut ());
        let grains = emptying.snapshot();
        above.push(
            grains
                .iter()
                .filter(|grain| grain.position[D - 1] > 0.0)
                .count(),
        );
        if time == 3 {
            show("open", &grains, emptying.time(), &open);
        }
    }
    Ok(Emptied {
        asleep_at,
        deepest,
        above,
    })
}

/// Grains on a lattice, in layers, as far as there is room between the walls.
fn poured<const D: usize>(hopper: &Hopper<D>, layers: usize) -> Vec<Particle<D>> {
    let mut grains = Vec::new();
    let across: i32 = 20;
    let sites = (2 * across + 1).pow(D as u32 - 1);
    for layer in 0..layers {
        for site in 0..sites {
            let mut place = Vector::zeros();
            place[D - 1] = 1.0 + 1.2 * layer as f64;
            let mut rest = site;
            for axis in 0..D - 1 {
                // Off the axis, and layers against each other, lest all be symmetric.
                let shifted = 0.1 * ((layer * (axis + 2)) % 5) as f64;
                place[axis] = 1.2 * f64::from(rest % (2 * across + 1) - across) + shifted;
                rest /= 2 * across + 1;
            }
            let free = |wall: &Side<D>| wall.distance(&place, Time::ZERO) > 0.55;
            if hopper.walls().iter().all(free) {
                grains.push(Particle::new(place, Vector::zeros()));
            }
        }
    }
    grains
}

/// Writes a picture and a snapshot of the grains into the folder that was named.
#[cfg(feature = "program")]
fn record<const D: usize>(name: &str, grains: &[Particle<D>], time: Time, boundary: &Hopper<D>) {
    let Some(folder) = std::env::args().nth(1).map(std::path::PathBuf::from) else {
        return;
    };
    let frame = grainfall::output::Frame::new(grains, time, boundary);
    let mut snapshot = Vec::new();
    let written = std::fs::create_dir_all(&folder)
        .and_then(|()| frame.write(&mut snapshot))
        .and_then(|()| std::fs::write(folder.join(format!("{name}{D}d.xyz")), snapshot))
        .and_then(|()| {
            let picture = grainfall::draw::svg(&frame);
            std::fs::write(folder.join(format!("{name}{D}d.svg")), picture)
        });
    if let Err(error) = written {
        eprintln!("{}: {error}", folder.display());
    }
}

/// Without the program's parts there are no pictures.
#[cfg(not(feature = "program"))]
fn record<const D: usize>(_: &str, _: &[Particle<D>], _: Time, _: &Hopper<D>) {}

fn main() -> Result<(), SetupError> {
    println!("a billiard in a bowl of radius 5 d: time of impact, distance from the polygon");
    for (dimension, found) in [
        ("2D", billiard::<2>(5.0, 1000)?),
        ("3D", billiard::<3>(5.0, 1000)?),
    ] {
        for impact in [1, 10, 100, 1000] {
            let (time, off) = found[impact - 1];
            println!("  {dimension}: impact {impact:4} at t = {time:11.6}, {off:.1e} d off");
        }
    }

    println!("a hopper of 50°, its hole 5 d wide");
    let cone = Cone::new(2.5, 50.0, 0.4)?;
    let plane = hopper::<2>(cone, 8, &mut record)?;
    let space = hopper::<3>(cone, 3, &mut record)?;
    for (dimension, found) in [("2D", plane), ("3D", space)] {
        println!(
            "  {dimension}: {} grains, all asleep at t = {:.2}, {:.0e} d from a wall at least; \
             opened:",
            found.above[0], found.asleep_at, -found.deepest
        );
        println!(
            "    above the hole after 0, 1, 2 … √(d/g): {:?}",
            found.above
        );
    }
    Ok(())
}

#[cfg(test)]
#[path = "../tests/own/boundary.rs"]
mod tests;
