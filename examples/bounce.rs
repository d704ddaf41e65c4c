//! Fig. 1: a ball that bounces on a floor, in three models.
//!
//! With a constant restitution the bounces pile up before a finite time t*, the
//! inelastic collapse. A regularised model makes slow bounces elastic, so the
//! ball never comes to rest. The paper's model puts it to sleep.
//!
//! cargo run --release --example bounce

use grainfall::boundary::{Cuboid, Side};
use grainfall::collide::Restitution;
use grainfall::dynamics::UniformGravity;
use grainfall::engine::{Limits, Simulation};
use grainfall::model::{Observer, Occurrence, OccurrenceKind, Parts, StatePolicy, Surroundings};
use grainfall::policy::{Never, SlowDescent};
use grainfall::predict::Polynomial;
use grainfall::{Particle, ParticleId, SetupError, Time, Vector};

const RESTITUTION: f64 = 0.4;
const IMPACT_SPEED: f64 = 1.0;

/// Drops the ball so that it first hits the floor at t = 1 with speed 1.
fn drop_ball<P: StatePolicy<1>>(
    elastic_speed: f64,
    policy: P,
) -> Result<Simulation<impl grainfall::model::Model<1>, 1>, SetupError> {
    // The model is put together from its five parts. One dimension is enough:
    // the last axis is always "up".
    let model = Parts {
        dynamics: UniformGravity::<1>::down(),
        predictor: Polynomial,
        collision_rule: Restitution {
            elastic_speed,
            ..Restitution::default()
        },
        state_policy: policy,
        boundary: Cuboid::new([Side::floor(0.0, RESTITUTION)])?,
    };
    // Its centre is half a diameter above its lowest point, which falls 1/2 d.
    let ball = Particle::new(Vector::<1>::new(0.5 + 0.5), Vector::<1>::zeros());
    Simulation::new(model, vec![ball])
}

/// Writes down when the ball hits the floor.
#[derive(Default)]
struct Bounces(Vec<f64>);

impl Observer<1> for Bounces {
    fn observe<S: Surroundings<1>>(&mut self, occurrence: &Occurrence<1>, _after: &S) {
        if occurrence.kind == OccurrenceKind::Wall {
            self.0.push(occurrence.time.units());
        }
    }
}

fn main() -> Result<(), SetupError> {
    // The end of the bounces, counted from the first: t* = 2 α V₀ / ((1 − α) g).
    let collapse = 1.0 + 2.0 * RESTITUTION * IMPACT_SPEED / (1.0 - RESTITUTION);

    // Constant restitution: the n-th bounce comes at t* − (t* − 1) αⁿ, and there
    // are infinitely many of them, so we stop after twelve.
    let mut bounces = Bounces::default();
    drop_ball(0.0, Never)?.run(&Limits::events(12), &mut bounces);
    println!("constant restitution: the bounces pile up at t* = {collapse:.7}");
    let mut power = 1.0;
    for (n, time) in bounces.0.iter().enumerate() {
        let formula = collapse - (collapse - 1.0) * power;
        println!(
            "  bounce {:2} at t = {time:.9}   (formula {formula:.9})",
            n + 1
        );
        power *= RESTITUTION;
    }

    // Elastic below V_c = 0.005: it bounces for ever, always equally high.
    let mut bounces = Bounces::default();
    let mut ball = drop_ball(0.005, Never)?;
    ball.run(&Limits::until(Time::from_units(4.0)), &mut bounces);
    let (early, late): (Vec<f64>, Vec<f64>) = bounces.0.iter().partition(|t| **t < collapse);
    println!(
        "elastic below V_c: {} bounces before t*, {} more until t = 4, and so on",
        early.len(),
        late.len()
    );

    // The paper's model: below V_sleep, descending, and slower than at the
    // bounce before. It falls asleep half-way to its next bounce, so it does not
    // lie exactly at contact. A floor counts as a support only if asked for.
    let policy = SlowDescent {
        sleep_speed: 0.01,
        wall_supports: true,
        ..SlowDescent::default()
    };
    let mut ball = drop_ball(0.0, policy)?;
    let mut asleep_at = f64::NAN;
    let why = ball.run(&Limits::all_frozen(), &mut |occurrence: &Occurrence<1>| {
        if occurrence.kind == OccurrenceKind::Sleep {
            asleep_at = occurrence.time.units();
        }
    });
    let height = ball.particle(ParticleId(0)).position[0] - 0.5;
    println!(
        "asleep below V_sleep: at t = {asleep_at:.7}, {height:.6e} d above the floor ({why:?})"
    );
    Ok(())
}
