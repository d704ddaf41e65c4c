//! A sleep rule of one's own, written once and used in two and three dimensions.
//!
//! A policy answers two questions: does this grain fall asleep at this
//! collision, and does this hit wake that sleeping one? Here a grain sleeps
//! after a number of slow collisions in a row, whatever its direction.
//!
//! cargo run --release --example own_sleep_rule

use grainfall::analysis::{highest_surface, packing_fraction};
use grainfall::boundary::{Cuboid, Side};
use grainfall::collide::Restitution;
use grainfall::dynamics::UniformGravity;
use grainfall::engine::{Limits, Simulation};
use grainfall::model::{
    Impact, NoEvent, Parts, Place, Reason, SleepDecision, StatePolicy, Surroundings, WakeDecision,
    Waking,
};
use grainfall::predict::Polynomial;
use grainfall::setup::{Base, Rain, seeded};
use grainfall::{Mode, Vector};

/// Asleep at the third slow collision in a row, if it is with a static grain;
/// woken by a hit twice as fast as "slow".
struct Tired {
    speed: f64,
}

// `Memory` is what is kept of each grain, here how many collisions in a row were
// slow. The reason goes into the records of the run.
impl<const D: usize> StatePolicy<D> for Tired {
    type Memory = u32;
    type Event = NoEvent;
    fn should_sleep<S: Surroundings<D>>(
        &self,
        hit: &Impact<D>,
        _after: Vector<D>,
        _near: &S,
        slow: &mut u32,
    ) -> SleepDecision {
        let reason = Reason::new("third slow hit", hit.arriving_speed(), self.speed);
        *slow = (*slow + 1) * u32::from(reason.value < reason.limit);
        if *slow < 3 || !hit.is_on_static() {
            return SleepDecision::Stay(reason);
        }
        SleepDecision::Sleep(Place::HalfWay, reason)
    }
    fn should_wake<S: Surroundings<D>>(&self, hit: &Impact<D>, _: &S, _: &u32) -> WakeDecision<D> {
        let reason = Reason::new("hard hit", hit.closing_speed(), 2.0 * self.speed);
        if reason.value <= reason.limit {
            return WakeDecision::Stay(reason);
        }
        WakeDecision::Wake(Waking::at_rest(), reason)
    }
}

/// A small deposit under this rule: nothing here says how many dimensions.
fn deposit<const D: usize>(count: usize, width: f64) -> Result<(), Box<dyn std::error::Error>> {
    let mut rng = seeded(1);
    let mut lengths = Vector::<D>::repeat(width);
    lengths[D - 1] = 2.0;
    let mut grains = Base {
        lengths,
        ..Base::default()
    }
    .grains(&mut rng)?;
    let mut rain = Rain::<D> {
        count,
        lengths,
        ..Rain::default()
    };
    rain.origin[D - 1] = highest_surface(&grains).unwrap_or(0.0);
    grains.extend(rain.grains(&mut rng)?);

    let mut sides = [Side::periodic(width); D];
    sides[D - 1] = Side::Open;
    let model = Parts {
        dynamics: UniformGravity::<D>::down(),
        predictor: Polynomial,
        collision_rule: Restitution {
            elastic_speed: 1.0e-3,
            ..Restitution::default()
        },
        state_policy: Tired { speed: 0.1 },
        boundary: Cuboid::new(sides)?,
    };
    let mut simulation = Simulation::new(model, grains)?;
    let why = simulation.run(&Limits::all_frozen(), &mut ());

    let heap = simulation.snapshot();
    let asleep = heap
        .iter()
        .filter(|grain| grain.mode == Mode::Frozen)
        .count();
    let area = (1..D).fold(1.0, |area, _| area * width);
    println!(
        "{D}D: {asleep} of {count} asleep at t = {:.1} after {} events ({why:?})",
        simulation.time().units(),
        simulation.counts().total()
    );
    if let Some(slab) = packing_fraction(&heap, area) {
        println!("    φ = {:.3}", slab.value);
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    deposit::<2>(200, 20.0)?;
    deposit::<3>(300, 6.0)
}
