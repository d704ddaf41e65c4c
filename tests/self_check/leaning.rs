//! The support graph in the hands of a criterion of one's own.

use grainfall::boundary::Side;
use grainfall::engine::Simulation;
use grainfall::model::{
    Commands, Impact, NoEvent, OccurrenceKind as Kind, Reason, Response, SleepDecision,
    StatePolicy, Surroundings, WakeDecision, Waking,
};
use grainfall::{Mode, Particle, ParticleId, Vector};

use crate::common::{close, heavy, rule, until, watch};
use crate::{at, story};

/// A criterion of one's own: a sleeper leans on whoever is nearer than 1.5, and
/// wakes when the second of them changes.
#[derive(Clone, Copy)]
struct Second;

impl StatePolicy<2> for Second {
    type Memory = u32;
    type Event = NoEvent;

    fn should_sleep<S: Surroundings<2>>(
        &self,
        _impact: &Impact<2>,
        _after: Vector<2>,
        _near: &S,
        _memory: &mut u32,
    ) -> SleepDecision {
        SleepDecision::Stay(Reason::new("never", 0.0, 0.0))
    }

    fn should_wake<S: Surroundings<2>>(
        &self,
        _impact: &Impact<2>,
        _near: &S,
        _struck: &u32,
    ) -> WakeDecision<2> {
        WakeDecision::Wake(Waking::at_rest(), Reason::new("always", 0.0, 0.0))
    }

    fn on_start<S: Surroundings<2>>(
        &self,
        id: ParticleId,
        near: &S,
        _memory: &mut u32,
        commands: &mut Commands<NoEvent>,
    ) {
        near.for_each_neighbour(id, 1.5, |other| commands.lean_on(id, other.id));
        // Neither on itself nor on nobody.
        commands.lean_on(id, id);
        commands.lean_on(id, ParticleId(999));
    }

    fn on_support_change<S: Surroundings<2>>(
        &self,
        _id: ParticleId,
        supporter: ParticleId,
        near: &S,
        memory: &mut u32,
        _commands: &mut Commands<NoEvent>,
    ) -> Response<2> {
        assert_eq!(near.particle(supporter).mode, Mode::Normal);
        *memory += 1;
        let reason = Reason::new("the second change", f64::from(*memory), 2.0);
        if *memory < 2 {
            Response::Keep
        } else {
            Response::Wake(Waking::with_velocity(at(0.0, 0.125)), reason)
        }
    }
}

#[test]
fn a_criterion_of_ones_own_lets_sleepers_lean() {
    // 0 sleeps between 1 and 2, which are struck from the sides and at rest else.
    let strike = |x: f64, u: f64| Particle::new(at(x, 0.0), at(u, 0.0)).with_mode(Mode::Falling);
    let grains = vec![
        Particle::frozen(at(0.0, 0.0)),
        Particle::frozen(at(-1.2, 0.0)),
        Particle::frozen(at(1.2, 0.0)),
        strike(-2.6, 1.0),
        strike(2.75, -1.0),
    ];
    let model = heavy(rule(0.0), Second, [Side::Open; 2]);
    let mut simulation = Simulation::new(model, grains).unwrap();
    assert!(
        simulation
            .supporters(ParticleId(0))
            .eq([ParticleId(1), ParticleId(2)])
    );
    // Free grains lean on nobody, whatever is asked for.
    assert_eq!(simulation.supporters(ParticleId(3)).count(), 0);
    simulation.run(&until(0.5), &mut ());
    assert_eq!(*simulation.memory(ParticleId(0)), 1);
    assert_eq!(simulation.mode_counts().frozen, 2);
    let (_, events) = watch(&mut simulation, &until(0.6));
    let told = story(&events, 0);
    assert_eq!(told.len(), 1);
    assert_eq!(told[0].0, Kind::CheckWake);
    close(told[0].1, 0.55, 1.0e-12, "the second change");
    let counts = simulation.counts();
    assert_eq!((counts.check, counts.support, counts.check_wake), (0, 2, 1));
}
