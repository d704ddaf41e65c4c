//! What a policy may forget of sleepers, and that it makes no difference.

mod common;

use std::fmt::Debug;

use common::{heavy, rule, until};
use grainfall::boundary::Side;
use grainfall::engine::Simulation;
use grainfall::model::{
    Commands, Impact, Model, Response, SleepDecision, StatePolicy, Surroundings, WakeCause,
    WakeDecision,
};
use grainfall::observe::TrajectoryHash;
use grainfall::policy::{
    AtRest, EnergyStore, GranularTemperature, IsostaticSupport, SelfCheck, SlowDescent,
};
use grainfall::{Mode, Particle, ParticleId, Vector};

/// The same criterion, but that it never forgets.
struct Elephant<P>(P);

impl<P: StatePolicy<2>> StatePolicy<2> for Elephant<P> {
    type Memory = P::Memory;
    type Event = P::Event;

    fn should_sleep<S: Surroundings<2>>(
        &self,
        impact: &Impact<2>,
        after: Vector<2>,
        near: &S,
        memory: &mut P::Memory,
    ) -> SleepDecision {
        self.0.should_sleep(impact, after, near, memory)
    }

    fn should_wake<S: Surroundings<2>>(
        &self,
        impact: &Impact<2>,
        near: &S,
        struck: &P::Memory,
    ) -> WakeDecision<2> {
        self.0.should_wake(impact, near, struck)
    }

    fn on_start<S: Surroundings<2>>(
        &self,
        id: ParticleId,
        near: &S,
        memory: &mut P::Memory,
        commands: &mut Commands<P::Event>,
    ) {
        self.0.on_start(id, near, memory, commands);
    }

    fn on_sleep<S: Surroundings<2>>(
        &self,
        id: ParticleId,
        near: &S,
        memory: &mut P::Memory,
        commands: &mut Commands<P::Event>,
    ) {
        self.0.on_sleep(id, near, memory, commands);
    }

    fn on_wake<S: Surroundings<2>>(
        &self,
        id: ParticleId,
        cause: &WakeCause<2>,
        near: &S,
        memory: &mut P::Memory,
        commands: &mut Commands<P::Event>,
    ) {
        self.0.on_wake(id, cause, near, memory, commands);
    }

    fn on_event<S: Surroundings<2>>(
        &self,
        id: ParticleId,
        event: P::Event,
        near: &S,
        memory: &mut P::Memory,
        commands: &mut Commands<P::Event>,
    ) -> Response<2> {
        self.0.on_event(id, event, near, memory, commands)
    }
}

/// A rain on a row of fixed grains, of which most wake at least once.
fn rain<P: StatePolicy<2>>(policy: P) -> Simulation<impl Model<2, StatePolicy = P>, 2> {
    let mut grains: Vec<Particle<2>> = (0..5)
        .map(|i| Particle::fixed(Vector::<2>::new(1.2 * f64::from(i), 0.0)))
        .collect();
    grains.extend((0..60).map(|i| {
        let x = 1.3 * f64::from(i % 4) + 0.01 * f64::from(i % 7);
        let y = 1.5 + 4.0 * f64::from(i / 4) + 0.3 * f64::from(i % 3);
        let speed = Vector::<2>::new(0.0, -1.0);
        Particle::new(Vector::<2>::new(x, y), speed).with_mode(Mode::Falling)
    }));
    let model = heavy(rule(1.0e-2), policy, [Side::periodic(6.0), Side::Open]);
    Simulation::new(model, grains).unwrap()
}

/// Hash of the run, wakes by hits, and of how many grains nothing is remembered at the
/// end.
fn outcome<P: StatePolicy<2, Memory: PartialEq>>(policy: P) -> (u64, u64, usize) {
    let mut simulation = rain(policy);
    let mut hash = TrajectoryHash::new();
    simulation.run(&until(60.0), &mut hash);
    let blank = P::Memory::default();
    let all = 0..simulation.snapshot().len() as u32;
    let forgotten = all.filter(|id| *simulation.memory(ParticleId(*id)) == blank);
    (hash.value(), simulation.counts().wake, forgotten.count())
}

#[track_caller]
fn no_difference<P: StatePolicy<2, Memory: PartialEq> + Copy + Debug>(policy: P, forgets: bool) {
    let (hash, wakes, forgotten) = outcome(policy);
    let (kept_hash, kept_wakes, kept) = outcome(Elephant(policy));
    assert_eq!((hash, wakes), (kept_hash, kept_wakes), "{policy:?}");
    assert!(wakes > 20, "{wakes} wakes: {policy:?}");
    // Of some, such as the fixed grains, there is nothing to remember.
    let more = forgotten - kept;
    assert_eq!(more > 20, forgets, "{more} forgotten: {policy:?}");
}

#[test]
fn who_forgets_decides_as_before() {
    let paper = SlowDescent::with_threshold(0.3);
    no_difference(paper, true);
    for energy_store in [EnergyStore::Off, EnergyStore::EnergyAfter] {
        no_difference(
            SlowDescent {
                energy_store,
                ..paper
            },
            true,
        );
    }
    let at_last = SlowDescent {
        keep_history: true,
        ..paper
    };
    no_difference(at_last, false);
    let long = SlowDescent {
        store_time: Some(1.0e3),
        ..paper
    };
    no_difference(long, false);
    let checked = SlowDescent {
        self_check: Some(SelfCheck::default()),
        ..paper
    };
    no_difference(checked, false);
    no_difference(
        IsostaticSupport {
            descent: paper,
            ..IsostaticSupport::default()
        },
        true,
    );
    no_difference(AtRest::new(GranularTemperature::default()), true);
}
