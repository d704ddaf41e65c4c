//! A collision rule of one's own: grains that are the softer the slower they
//! collide, as viscoelastic spheres are. Written once, for disks and spheres.
//!
//! cargo run --release --example own_collision_rule

use grainfall::boundary::{Cuboid, Side};
use grainfall::dynamics::UniformGravity;
use grainfall::engine::{Limits, Simulation};
use grainfall::model::{
    CollisionRule, Impact, Model, Obstacle, Occurrence, OccurrenceKind, Parts, Rebound, Spins,
    StatePolicy,
};
use grainfall::policy::{Never, SlowDescent};
use grainfall::predict::Polynomial;
use grainfall::{Particle, SetupError, Vector};

/// Smooth viscoelastic spheres. Their coefficient of restitution falls with the
/// normal speed v at which they collide,
///
/// ε = 1 − 1.15 (v/v₀)^(1/5) + 0.80 (v/v₀)^(2/5) ∓ … ,
///
/// and is computed from the Padé approximant of that series (Müller & Pöschel 2011,
/// doi:10.1103/PhysRevE.84.021302), which holds for all speeds.
#[derive(Clone, Copy, Debug)]
struct Viscoelastic {
    /// v₀, in √(gd), of two grains of mass 1 and diameter 1: what is much slower
    /// is nearly elastic.
    speed: f64,
}

impl Viscoelastic {
    /// ε at a normal speed, for a reduced mass, in m, and a reduced radius, in d.
    fn restitution(&self, speed: f64, mass: f64, radius: f64) -> f64 {
        // v₀ goes with the square of the reduced mass over the reduced radius; those
        // of two equal grains are 1/2 and 1/4.
        let stiff = (2.0 * mass) * (2.0 * mass) / (4.0 * radius);
        let x = libm::pow(speed / (self.speed * stiff), 0.1);
        let above = 1.0 + 0.501086 * x;
        above / (1.0 + x * (0.501086 + x * (1.15345 + x * (0.577977 + x * 0.532178))))
    }
}

impl<const D: usize> CollisionRule<D> for Viscoelastic {
    type Spin = ();

    fn collide(&self, impact: &Impact<D>, _spins: Spins<'_, ()>) -> Rebound<D> {
        let (mass, radius) = (impact.particle.mass, impact.particle.radius());
        // The share of this grain in the reduced mass, and the reduced radius.
        let (share, reduced_radius) = match &impact.obstacle {
            Obstacle::Wall { .. } => (1.0, radius),
            Obstacle::Particle { particle, .. } => {
                let other = particle.radius();
                let reduced_radius = radius * other / (radius + other);
                if particle.mode.is_static() {
                    (1.0, reduced_radius)
                } else {
                    (particle.mass / (mass + particle.mass), reduced_radius)
                }
            }
        };
        let closing = impact.closing_speed();
        let restitution = self.restitution(closing, mass * share, reduced_radius);
        // The change of the relative velocity; each grain takes its share of it.
        let unit = impact.normal.norm_squared();
        let change = impact.normal * ((1.0 + restitution) * closing / unit);
        Rebound {
            velocity: impact.particle.velocity + change * share,
            other_velocity: impact.obstacle_velocity() - change * (1.0 - share),
            elastic: false,
            spared_energy: 0.0,
        }
    }

    fn validate(&self) -> Result<(), SetupError> {
        if self.speed > 0.0 && self.speed.is_finite() {
            return Ok(());
        }
        Err(SetupError::Parameter {
            field: "speed",
            value: self.speed,
            allowed: "a positive number is allowed",
        })
    }
}

/// Grains on a floor, under this rule.
fn on_floor<const D: usize, S: StatePolicy<D>>(
    rule: Viscoelastic,
    policy: S,
    grains: Vec<Particle<D>>,
) -> Result<Simulation<impl Model<D>, D>, SetupError> {
    let mut sides = [Side::periodic(10.0); D];
    // The floor's own restitution is not asked for by this rule.
    sides[D - 1] = Side::floor(0.0, 0.0);
    let model = Parts {
        dynamics: UniformGravity::<D>::down(),
        predictor: Polynomial,
        collision_rule: rule,
        state_policy: policy,
        boundary: Cuboid::new(sides)?,
    };
    Simulation::new(model, grains)
}

/// A grain of mass and diameter 1, so high that it hits the floor with this speed.
fn dropped<const D: usize>(speed: f64) -> Particle<D> {
    let mut place = Vector::repeat(5.0);
    place[D - 1] = 0.5 + 0.5 * speed * speed;
    Particle::new(place, Vector::zeros())
}

/// The speeds at which a grain hits the floor, bounce by bounce.
fn bounces<const D: usize>(rule: Viscoelastic, count: usize) -> Result<Vec<f64>, SetupError> {
    let mut speeds = Vec::new();
    let mut ball = on_floor(rule, Never, vec![dropped::<D>(1.0)])?;
    ball.run(&Limits::events(count as u64), &mut |bounce: &Occurrence<
        D,
    >| {
        speeds.push(bounce.impact_speed);
    });
    Ok(speeds)
}

/// A ball goes to sleep: when, and after how many bounces.
fn to_rest<const D: usize>(rule: Viscoelastic) -> Result<(f64, usize), SetupError> {
    let policy = SlowDescent {
        wall_supports: true,
        ..SlowDescent::with_threshold(0.01)
    };
    let mut hits = 0;
    let mut ball = on_floor(rule, policy, vec![dropped::<D>(1.0)])?;
    ball.run(&Limits::all_frozen(), &mut |event: &Occurrence<D>| {
        hits += usize::from(event.kind == OccurrenceKind::Wall);
    });
    Ok((ball.time().units(), hits))
}

fn main() -> Result<(), SetupError> {
    let rule = Viscoelastic { speed: 20.0 };
    println!("a ball on a floor, v₀ = {}: speed of impact", rule.speed);
    println!("bounce   in 2D      in 3D      by hand    ε of it   with ε = 0.7");
    let (plane, space) = (bounces::<2>(rule, 12)?, bounces::<3>(rule, 12)?);
    let (mut by_hand, mut constant) = (1.0, 1.0);
    for (n, (plane, space)) in plane.iter().zip(&space).enumerate() {
        let restitution = rule.restitution(by_hand, 1.0, 0.5);
        println!(
            "{:6}   {plane:.6}   {space:.6}   {by_hand:.6}   {restitution:.4}    {constant:.6}",
            n + 1
        );
        by_hand *= restitution;
        constant *= 0.7;
    }
    let (time, hits) = to_rest::<3>(rule)?;
    println!("asleep at t = {time:.4}, after {hits} bounces");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainfall::ParticleId;

    const RULE: Viscoelastic = Viscoelastic { speed: 5.0 };

    fn follows_the_recurrence<const D: usize>() {
        let mut by_hand: f64 = 1.0;
        for (n, speed) in bounces::<D>(RULE, 40).unwrap().into_iter().enumerate() {
            assert!((speed / by_hand - 1.0).abs() < 1.0e-11, "bounce {n}");
            by_hand *= RULE.restitution(by_hand, 1.0, 0.5);
        }
    }

    #[test]
    fn a_ball_bounces_as_by_hand() {
        follows_the_recurrence::<2>();
        follows_the_recurrence::<3>();
    }

    /// Of the series 1 − C₁ x² + C₂ x⁴ − …, x = (v/v₀)^(1/10), with C₁ = 1.15344 and
    /// C₂ = 3 C₁²/5 (Ramírez and others 1999, doi:10.1103/PhysRevE.60.4465).
    #[test]
    fn slow_collisions_are_those_of_the_series() {
        for exponent in [-15, -13, -11] {
            let speed = libm::exp10(f64::from(exponent));
            let soft = libm::pow(speed / 5.0, 0.2);
            let series = 1.0 - 1.15344 * soft + 0.6 * 1.15344 * 1.15344 * soft * soft;
            let found = RULE.restitution(speed, 0.5, 0.25);
            // The next term is 0.27 x⁵.
            let rest = 0.3 * libm::pow(soft, 2.5) + 2.0e-5 * soft;
            assert!((found - series).abs() < rest, "{found} {series}");
        }
    }

    /// Oblique, of unequal masses and sizes: momentum is kept, only the normal part
    /// of the relative velocity changes, and the ledger knows what it has cost.
    #[test]
    fn a_pair_keeps_its_momentum() {
        let one = Particle {
            mass: 2.0,
            ..Particle::new(Vector::<2>::new(2.0, 50.0), Vector::<2>::new(1.0, 0.0))
        };
        let other = Particle {
            diameter: 0.6,
            ..Particle::new(Vector::<2>::new(4.0, 50.4), Vector::<2>::new(-1.0, 0.0))
        };
        let mut pair = on_floor(RULE, Never, vec![one, other]).unwrap();
        let mut seen = None;
        pair.run(&Limits::events(1), &mut |event: &Occurrence<2>| {
            seen = Some(*event);
        });
        let event = seen.unwrap();
        assert_eq!(event.kind, OccurrenceKind::Pair);
        let fallen = Vector::<2>::new(0.0, -event.time.units());
        let before = [one.velocity + fallen, other.velocity + fallen];
        let after = [event.velocity, event.other_velocity];
        let kept = (after[0] - before[0]) * one.mass + (after[1] - before[1]) * other.mass;
        assert!(kept.norm() < 1.0e-14);
        let apart = pair.particle(ParticleId(0)).position - pair.particle(ParticleId(1)).position;
        let normal = apart / apart.norm();
        assert!((apart.norm() - 0.8).abs() < 1.0e-14);
        let (came, left) = (before[0] - before[1], after[0] - after[1]);
        let restitution = RULE.restitution(event.impact_speed, 2.0 / 3.0, 0.15 / 0.8);
        let wanted = came - normal * ((1.0 + restitution) * came.dot(&normal));
        assert!((left - wanted).norm() < 1.0e-13);
        let lost = 0.5 * (2.0 / 3.0) * (1.0 - restitution * restitution);
        let ledger = pair.energy_ledger();
        let speed = event.impact_speed;
        assert!((ledger.pair + lost * speed * speed).abs() < 1.0e-13);
    }

    #[test]
    fn a_speed_of_zero_is_refused() {
        let refused = on_floor(Viscoelastic { speed: 0.0 }, Never, vec![dropped::<2>(1.0)]);
        let said = refused.err().map(|error| error.to_string());
        let wanted = "speed is 0; a positive number is allowed";
        assert_eq!(said.as_deref(), Some(wanted));
    }
}
