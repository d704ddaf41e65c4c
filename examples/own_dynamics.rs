//! Dynamics of one's own: charged grains in a field, which fly on parabolas of
//! their own, and grains with drag, whose flight is no polynomial and brings its
//! predictor along. Each is written once, for the plane and for space.
//!
//! cargo run --release --example own_dynamics

use grainfall::boundary::{Cuboid, Side};
use grainfall::collide::Restitution;
use grainfall::dynamics::{Parabola, Straight};
use grainfall::engine::{Limits, Simulation};
use grainfall::model::{
    Approach, Dynamics, Encounter, Flight, Forecast, Model, Motion, Observer, Parts, Predictor,
    Shape, Wall,
};
use grainfall::policy::Never;
use grainfall::predict::{Polynomial, wall_by_distance};
use grainfall::{Mode, Particle, SetupError, Time, Vector, along};

/// Gravity, and a uniform field that pulls each grain by its own charge. Grains act
/// on each other only when they collide.
#[derive(Clone, Debug)]
struct Charged<const D: usize> {
    gravity: Vector<D>,
    /// The field times the charge over the mass, in g, grain by grain; those that
    /// are not on the list have no charge.
    pulls: Vec<Vector<D>>,
}

impl<const D: usize> Dynamics<D> for Charged<D> {
    type Flight = Parabola<D>;

    // The field is not part of gravity, so its work is added up in flight.
    const DRIVES: bool = true;

    fn flight(&self, motion: &Motion<D>, _since: Time) -> Parabola<D> {
        let pull = self.pulls.get(motion.id.index());
        Parabola {
            position: motion.position,
            velocity: motion.velocity,
            acceleration: match motion.mode {
                Mode::Normal => self.gravity + pull.unwrap_or(&Vector::zeros()),
                // The rain falls at constant velocity, static grains do not fall.
                Mode::Falling | Mode::Frozen | Mode::Fixed => Vector::zeros(),
            },
        }
    }

    fn gravity(&self, _time: Time) -> Vector<D> {
        self.gravity
    }

    fn validate(&self) -> Result<(), SetupError> {
        let parts = self
            .pulls
            .iter()
            .chain([&self.gravity])
            .flat_map(Vector::iter);
        for &value in parts {
            if value.is_nan() || value.abs() > 1.0e9 {
                return Err(SetupError::Parameter {
                    field: "pull",
                    value,
                    allowed: "components between -1e9 and 1e9 are allowed",
                });
            }
        }
        Ok(())
    }
}

/// Gravity down the last axis, and a fluid at rest that slows grains down by
/// (v − v_∞)/τ (Stokes). They tend to v_∞ = g τ.
#[derive(Clone, Copy, Debug)]
struct Drag {
    /// τ, in √(d/g), the same for all grains.
    time: f64,
}

/// x(t) = x₀ + v_∞ t + (v₀ − v_∞) s, with s = τ (1 − exp(−t/τ)).
#[derive(Clone, Copy, Debug)]
struct Sinking<const D: usize> {
    position: Vector<D>,
    /// v_∞, in √(gd).
    last: Vector<D>,
    /// v₀ − v_∞, in √(gd).
    excess: Vector<D>,
    /// τ; infinite for a grain that keeps its velocity, all of which is excess.
    time: f64,
}

impl<const D: usize> Sinking<D> {
    /// s at a time: how far the excess carries, over itself, in √(d/g).
    fn carried(&self, after: f64) -> f64 {
        if self.time.is_infinite() {
            return after;
        }
        -self.time * libm::expm1(-after / self.time)
    }

    /// The time at which it has carried so far: t = −τ ln(1 − s/τ).
    fn time_of(&self, carried: f64) -> f64 {
        if self.time.is_infinite() {
            return carried;
        }
        -self.time * libm::log1p(-carried / self.time)
    }

    /// As others with the same drag see it, with s for the time.
    fn straight(&self) -> Straight<D> {
        Straight {
            position: self.position,
            velocity: self.excess,
        }
    }

    /// A bound on its acceleration, in g.
    fn deceleration(&self) -> f64 {
        self.excess.norm() / self.time
    }
}

impl<const D: usize> Flight<D> for Sinking<D> {
    fn position(&self, after: f64) -> Vector<D> {
        self.position + self.last * after + self.excess * self.carried(after)
    }

    fn velocity(&self, after: f64) -> Vector<D> {
        self.last + self.excess * libm::exp(-after / self.time)
    }

    fn advanced(&self, after: f64) -> Self {
        Sinking {
            position: self.position(after),
            excess: self.excess * libm::exp(-after / self.time),
            ..*self
        }
    }

    fn speed_bound(&self, _within: f64) -> f64 {
        // Velocities lie between the first and the last.
        self.last.norm().max((self.last + self.excess).norm())
    }

    fn is_at_rest(&self) -> bool {
        self.last == Vector::<D>::zeros() && self.excess == Vector::<D>::zeros()
    }
}

impl<const D: usize> Dynamics<D> for Drag {
    type Flight = Sinking<D>;

    const DRIVES: bool = true;

    fn flight(&self, motion: &Motion<D>, _since: Time) -> Sinking<D> {
        let (last, time) = match motion.mode {
            Mode::Normal => (along(D - 1, -self.time), self.time),
            Mode::Falling | Mode::Frozen | Mode::Fixed => (Vector::zeros(), f64::INFINITY),
        };
        Sinking {
            position: motion.position,
            last,
            excess: motion.velocity - last,
            time,
        }
    }

    fn gravity(&self, _time: Time) -> Vector<D> {
        along(D - 1, -1.0)
    }

    fn validate(&self) -> Result<(), SetupError> {
        if (1.0e-3..=1.0e6).contains(&self.time) {
            return Ok(());
        }
        Err(SetupError::Parameter {
            field: "drag time",
            value: self.time,
            allowed: "1e-3 … 1e6 is allowed",
        })
    }
}

/// When grains with drag meet, of diameters that do not grow.
#[derive(Clone, Copy, Debug)]
struct WithDrag;

/// A grain at rest, as a wall.
struct Round<const D: usize> {
    centre: Vector<D>,
    velocity: Vector<D>,
    radius: f64,
}

impl<const D: usize> Wall<D> for Round<D> {
    fn distance(&self, position: &Vector<D>, time: Time) -> f64 {
        (position - self.centre - self.velocity * time.units()).norm() - self.radius
    }

    fn normal(&self, position: &Vector<D>, time: Time) -> Vector<D> {
        (position - self.centre - self.velocity * time.units()).normalize()
    }

    fn velocity(&self, _position: &Vector<D>, _time: Time) -> Vector<D> {
        self.velocity
    }

    fn restitution(&self) -> f64 {
        1.0
    }

    fn shape(&self) -> Shape<D> {
        Shape::General {
            // Bent away from who comes.
            curvature: 0.0,
            speed: self.velocity.norm(),
            acceleration: 0.0,
        }
    }
}

impl<const D: usize> Predictor<D, Sinking<D>> for WithDrag {
    fn pair(&self, approach: &Approach<D, Sinking<D>>) -> Forecast {
        let (first, second) = (&approach.first, &approach.second);
        if first.time == second.time {
            // What they sink with is common to both: as seen from each other they
            // fly straight, with s for the time.
            let forecast = Polynomial.pair(&Approach {
                first: first.straight(),
                second: second.straight(),
                shift: approach.shift,
                distance: approach.distance,
                growth: approach.growth,
                touching: approach.touching,
                horizon: first.carried(approach.horizon),
            });
            return match forecast {
                // They would meet, but not ever get there.
                Forecast::Contact(s) if s >= first.time => Forecast::Never,
                Forecast::Contact(s) => Forecast::Contact(first.time_of(s)),
                Forecast::AskAgain(s) if s >= first.time => Forecast::Never,
                Forecast::AskAgain(s) => Forecast::AskAgain(first.time_of(s)),
                Forecast::Never => Forecast::Never,
            };
        }
        // One of them keeps its velocity: it is a round wall for the other.
        let (sinks, keeps, side) = if first.time.is_finite() {
            (first, second, 1.0)
        } else {
            (second, first, -1.0)
        };
        let wall = Round {
            centre: keeps.position + approach.shift * side,
            velocity: keeps.excess,
            radius: 0.5 * approach.distance,
        };
        let encounter = Encounter {
            flight: *sinks,
            wall: &wall,
            since: Time::ZERO,
            radius: 0.5 * approach.distance,
            growth: approach.growth,
            touching: approach.touching,
            horizon: approach.horizon,
        };
        wall_by_distance(&encounter, sinks.deceleration())
    }

    fn wall<W: Wall<D>>(&self, encounter: &Encounter<'_, D, Sinking<D>, W>) -> Forecast {
        let flight = &encounter.flight;
        if let Shape::Plane { normal, offset } = encounter.wall.shape() {
            // Does the excess, all of it, not carry it there, and v_∞ away from it?
            let gap = normal.dot(&flight.position) - offset - encounter.radius;
            let carried = match normal.dot(&flight.excess) {
                excess if excess < 0.0 => excess * flight.time,
                _ => 0.0,
            };
            if normal.dot(&flight.last) >= 0.0 && gap + carried > 1.0e-9 {
                return Forecast::Never;
            }
        }
        wall_by_distance(encounter, flight.deceleration())
    }
}

/// A model of these dynamics in a box of 12 d with walls on all sides.
fn in_a_box<Y, P, const D: usize>(
    dynamics: Y,
    predictor: P,
    grains: Vec<Particle<D>>,
) -> Result<Simulation<impl Model<D>, D>, SetupError>
where
    Y: Dynamics<D>,
    P: Predictor<D, Y::Flight>,
{
    let sides = [Side::Walls {
        low: Some(0.0),
        high: Some(12.0),
        restitution: 0.7,
    }; D];
    let model = Parts {
        dynamics,
        predictor,
        collision_rule: Restitution {
            elastic_speed: 1.0e-3,
            ..Restitution::constant(0.7)
        },
        state_policy: Never,
        boundary: Cuboid::new(sides)?,
    };
    Simulation::new(model, grains)
}

/// 6^D grains on a lattice, at rest.
fn lattice<const D: usize>() -> Vec<Particle<D>> {
    let count = 6_usize.pow(D as u32);
    let place = |site: usize| {
        Vector::from_fn(|axis, _| {
            let row = site / 6_usize.pow(axis as u32) % 6;
            // Not quite in line.
            1.0 + 2.0 * row as f64 + 0.02 * ((site * (axis + 1)) % 7) as f64
        })
    };
    (0..count)
        .map(|site| Particle::new(place(site), Vector::zeros()))
        .collect()
}

/// The sign of a grain's charge.
fn is_positive(site: usize) -> bool {
    (site / 6).is_multiple_of(2)
}

/// Charges of both signs, six of one, then six of the other, in a field along the
/// first axis.
fn alternating<const D: usize>(count: usize) -> Charged<D> {
    let pull = |site| along(0, if is_positive(site) { 0.3 } else { -0.3 });
    Charged {
        gravity: along(D - 1, -1.0),
        pulls: (0..count).map(pull).collect(),
    }
}

/// Lets a simulation run up to a time and says where the energy has gone.
fn report<M: Model<D>, const D: usize>(
    mut simulation: Simulation<M, D>,
    until: f64,
    observer: &mut impl Observer<D>,
) -> Vec<Particle<D>> {
    simulation.run(&Limits::until(Time::from_units(until)), observer);
    let ledger = simulation.energy_ledger();
    println!(
        "  {D}D: {} events; energy {:+.3} mgd = in flight {:+.3}, pairs {:+.3}, walls {:+.3}; \
         not explained: {:.0e} of it; overlap at most {:.0e} d",
        simulation.counts().total(),
        ledger.change(),
        ledger.field,
        ledger.pair,
        ledger.wall,
        ledger.relative_error().abs(),
        simulation.max_overlap()
    );
    simulation.snapshot()
}

/// Charges of both signs go apart: the mean distance of the two clouds, in d.
fn sorted<const D: usize>() -> Result<f64, SetupError> {
    let grains = lattice::<D>();
    let count = grains.len();
    let simulation = in_a_box(alternating(count), Polynomial, grains)?;
    let after = report(simulation, 6.0, &mut ());
    let mean = |sign: bool| {
        let places = after.iter().enumerate();
        let chosen = places.filter(|(site, _)| is_positive(*site) == sign);
        let sum: f64 = chosen.map(|(_, grain)| grain.position[0]).sum();
        sum / (count / 2) as f64
    };
    Ok(mean(true) - mean(false))
}

/// The speed at which a grain with drag hits the floor, `height` d below it.
fn sunk<const D: usize>(drag: Drag, height: f64) -> Result<f64, SetupError> {
    let mut place = Vector::repeat(6.0);
    place[D - 1] = 0.5 + height;
    let grain = Particle::new(place, Vector::zeros());
    let mut simulation = in_a_box(drag, WithDrag, vec![grain])?;
    let mut speed = 0.0;
    let mut note = |hit: &grainfall::model::Occurrence<D>| speed = hit.impact_speed;
    simulation.run(&Limits::events(1), &mut note);
    Ok(speed)
}

fn main() -> Result<(), SetupError> {
    println!("charges of both signs in a field of 0.3 g, for 6 √(d/g)");
    println!("  2D: {:.2} d apart", sorted::<2>()?);
    println!("  3D: {:.2} d apart", sorted::<3>()?);

    println!("drag: speed at the floor, 10 d below");
    for time in [100.0, 1.0, 0.1] {
        let drag = Drag { time };
        let (plane, space) = (sunk::<2>(drag, 10.0)?, sunk::<3>(drag, 10.0)?);
        println!("  τ = {time:5}: {plane:.9} (2D), {space:.9} (3D)");
    }
    let drag = Drag { time: 1.0 };
    report(in_a_box(drag, WithDrag, lattice::<2>())?, 6.0, &mut ());
    report(in_a_box(drag, WithDrag, lattice::<3>())?, 6.0, &mut ());
    Ok(())
}

#[cfg(test)]
#[path = "../tests/own/dynamics.rs"]
mod tests;
