//! Who falls asleep and who wakes.

use std::fmt::Debug;

use serde::{Deserialize, Serialize, de::DeserializeOwned};

use crate::error::SetupError;
use crate::model::{Impact, Surroundings};
use crate::particle::{ParticleId, Vector};

/// Why a decision fell as it did: the condition that settled it, with its
/// numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Reason {
    /// The condition in a few words, such as `speed below V_sleep`.
    pub condition: &'static str,
    /// What was found.
    pub value: f64,
    /// What it was compared with.
    pub limit: f64,
}

impl Reason {
    /// A condition with what was found and what it was compared with.
    #[must_use]
    pub fn new(condition: &'static str, value: f64, limit: f64) -> Self {
        Reason {
            condition,
            value,
            limit,
        }
    }
}

/// Where a grain falls asleep.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "program", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Place {
    /// Half-way in time to its next collision, so that nothing is asleep
    /// exactly at contact (the paper's section 2). A grain that has no next
    /// collision, with grains no farther away than the shortest period, does
    /// not sleep; one that collides before cancels it.
    HalfWay,
    /// Where it is.
    Here,
}

/// The answer to "does this grain fall asleep now?".
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SleepDecision {
    /// No, and the first condition that failed.
    Stay(Reason),
    /// Yes.
    Sleep(Place, Reason),
}

/// How a grain starts when it wakes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waking<const D: usize> {
    /// Its velocity before the collision that woke it is resolved, in √(gd).
    pub velocity: Vector<D>,
    /// Kinetic energy to add after that collision by lengthening its velocity,
    /// in mgd. Without a collision, or without a velocity to lengthen, there is
    /// none to add.
    pub extra_energy: f64,
}

impl<const D: usize> Waking<D> {
    /// From rest.
    #[must_use]
    pub fn at_rest() -> Self {
        Waking::with_velocity(Vector::zeros())
    }

    /// With a velocity, in √(gd).
    #[must_use]
    pub fn with_velocity(velocity: Vector<D>) -> Self {
        Waking {
            velocity,
            extra_energy: 0.0,
        }
    }
}

/// The answer to "does this hit wake the frozen grain?".
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WakeDecision<const D: usize> {
    /// No: it takes the hit as a body of infinite mass.
    Stay(Reason),
    /// Yes: it turns normal and the two collide as mobile grains.
    Wake(Waking<D>, Reason),
}

/// What woke a grain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WakeCause<const D: usize> {
    /// A hit: the collision as the woken grain sees it, with the velocity it
    /// was given to start with, and its velocity after.
    Hit {
        /// Just before the collision.
        impact: Impact<D>,
        /// Velocity just after, in √(gd).
        after: Vector<D>,
    },
    /// The policy's own event, such as a failed self-check.
    Event,
}

/// The answer of a policy to its own event.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Response<const D: usize> {
    /// The event has lost its point (the grain changed its mode since); it is
    /// not counted.
    Ignore,
    /// The check passed: nothing changes.
    Keep,
    /// The grain wakes. Taken as [`Response::Keep`] if it is not frozen.
    Wake(Waking<D>, Reason),
    /// The grain falls asleep where it is. Taken as [`Response::Keep`] if it is
    /// not mobile.
    Sleep(Reason),
}

/// An event that asks for another of its kind waits at least so long for it, in √(d/g):
/// so time goes on, whatever rounding does. The engine and the built-in policies
/// keep to it.
pub const SHORTEST_WAIT: f64 = 1.0e-9;

/// What a policy asks of the engine besides its answer.
#[derive(Clone, Debug)]
pub struct Commands<E> {
    scheduled: Vec<(ParticleId, f64, E)>,
    leaning: Vec<(ParticleId, ParticleId, f64)>,
}

impl<E> Default for Commands<E> {
    fn default() -> Self {
        Commands {
            scheduled: Vec::new(),
            leaning: Vec::new(),
        }
    }
}

impl<E> Commands<E> {
    /// Asks for `event` to be put to [`StatePolicy::on_event`] for a grain
    /// `after` √(d/g), 0 or more; [`SHORTEST_WAIT`] or more if each asks for the next.
    /// Nothing cancels it: a policy that has lost interest answers
    /// [`Response::Ignore`].
    pub fn schedule(&mut self, id: ParticleId, after: f64, event: E) {
        self.scheduled.push((id, after, event));
    }

    /// Lets a grain that sleeps, or falls asleep now, lean on another: from now
    /// on until it wakes, [`StatePolicy::on_support_change`] is asked for `id`
    /// at each instant at which `supporter` wakes, falls asleep or is set free.
    pub fn lean_on(&mut self, id: ParticleId, supporter: ParticleId) {
        self.lean_within(id, supporter, f64::INFINITY);
    }

    /// The same, and it is asked as well when the centre of `supporter` gets as
    /// far from that of `id` as `range` times their distance at contact, to
    /// within 10⁻¹³ of that: at that instant and, if it is answered that all is
    /// well, at the next collision of `supporter` out there. Who leans on one
    /// grain twice does so as it has asked for the first time.
    pub fn lean_within(&mut self, id: ParticleId, supporter: ParticleId, range: f64) {
        self.leaning.push((id, supporter, range));
    }

    /// Who is to lean on whom, within what range, in order; empties the list.
    pub fn drain_leaning(&mut self) -> impl Iterator<Item = (ParticleId, ParticleId, f64)> + '_ {
        self.leaning.drain(..)
    }

    /// The events that have been asked for, in order; empties the list.
    pub fn drain(&mut self) -> impl Iterator<Item = (ParticleId, f64, E)> + '_ {
        self.scheduled.drain(..)
    }

    /// Nothing has been asked for.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.scheduled.is_empty() && self.leaning.is_empty()
    }
}

/// The events of a policy that has none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum NoEvent {}

/// Who falls asleep and who wakes.
///
/// Only the first two methods have to be written. A policy holds parameters;
/// what it has to remember of each grain is its `Memory`, which the engine
/// stores, hands in and saves. It knows other grains by [`Surroundings`] and
/// talks to them by scheduling events for them.
///
/// The generic type names are: `D` the dimension, `S` the surroundings.
pub trait StatePolicy<const D: usize> {
    /// What is remembered of each grain.
    type Memory: Clone + Default + Debug + Serialize + DeserializeOwned;
    /// Events of its own, such as self-checks; [`NoEvent`] for none.
    type Event: Copy + Debug + Serialize + DeserializeOwned;

    /// False if no grain ever falls asleep. Otherwise a grain that is caught
    /// between static ones may be put to sleep by the engine's guards, whatever
    /// [`should_sleep`](StatePolicy::should_sleep) says.
    const SLEEPS: bool = true;

    /// The same for a policy that knows it only by its parameters.
    fn sleeps(&self) -> bool {
        Self::SLEEPS
    }

    /// Does the grain of `impact`, which leaves with velocity `after`, fall
    /// asleep? Asked once for each mobile grain at each of its collisions of
    /// any kind, after the rule and before anything is written; so it is also
    /// the place to keep a history.
    fn should_sleep<S: Surroundings<D>>(
        &self,
        impact: &Impact<D>,
        after: Vector<D>,
        near: &S,
        memory: &mut Self::Memory,
    ) -> SleepDecision;

    /// Does the frozen grain that `impact` hits (its obstacle) wake? Asked
    /// before the rule.
    fn should_wake<S: Surroundings<D>>(
        &self,
        impact: &Impact<D>,
        near: &S,
        struck: &Self::Memory,
    ) -> WakeDecision<D>;

    /// Refuses parameters that are out of range; asked once, before a
    /// simulation starts.
    ///
    /// # Errors
    ///
    /// [`SetupError`] with the parameter, its value and what is allowed.
    fn validate(&self) -> Result<(), SetupError> {
        Ok(())
    }

    /// Says what is wrong with a memory, between events; asked for
    /// [`assert_consistent`](crate::engine::Simulation::assert_consistent), so
    /// as good as always in builds with debug assertions. Costs nothing in
    /// others.
    ///
    /// # Errors
    ///
    /// What no memory of a grain in this state may say.
    fn check_memory<S: Surroundings<D>>(
        &self,
        _id: ParticleId,
        _near: &S,
        _memory: &Self::Memory,
    ) -> Result<(), String> {
        Ok(())
    }

    /// Whether nothing that is asked of the policy depends on this memory any more, now
    /// or later: that is, whether `Memory::default()` would do as well. The engine then
    /// may forget it, and hands in the default from then on; so a heap takes less room. It
    /// asks for grains as they start, and for sleepers now and then: when, says nothing
    /// about the grain.
    fn may_forget<S: Surroundings<D>>(
        &self,
        _id: ParticleId,
        _near: &S,
        _memory: &Self::Memory,
    ) -> bool {
        false
    }

    /// Called once for each grain when the simulation starts, or when the grain
    /// is inserted.
    fn on_start<S: Surroundings<D>>(
        &self,
        _id: ParticleId,
        _near: &S,
        _memory: &mut Self::Memory,
        _commands: &mut Commands<Self::Event>,
    ) {
    }

    /// The grain is about to fall asleep: it still has the velocity it loses.
    fn on_sleep<S: Surroundings<D>>(
        &self,
        _id: ParticleId,
        _near: &S,
        _memory: &mut Self::Memory,
        _commands: &mut Commands<Self::Event>,
    ) {
    }

    /// The grain has woken.
    fn on_wake<S: Surroundings<D>>(
        &self,
        _id: ParticleId,
        _cause: &WakeCause<D>,
        _near: &S,
        _memory: &mut Self::Memory,
        _commands: &mut Commands<Self::Event>,
    ) {
    }

    /// An event this policy has asked for.
    fn on_event<S: Surroundings<D>>(
        &self,
        _id: ParticleId,
        _event: Self::Event,
        _near: &S,
        _memory: &mut Self::Memory,
        _commands: &mut Commands<Self::Event>,
    ) -> Response<D> {
        Response::Ignore
    }

    /// A grain that the sleeper `id` leans on ([`Commands::lean_on`]) has woken,
    /// fallen asleep or been set free, or has got out of the range that was asked
    /// for, at this instant. Nothing is asked unless the policy has let sleepers
    /// lean.
    ///
    /// It is asked after all collisions of the instant. If several sleepers are
    /// concerned they are asked by id, the smallest first; who wakes is a change
    /// for those that lean on it, who are then asked at the same instant.
    fn on_support_change<S: Surroundings<D>>(
        &self,
        _id: ParticleId,
        _supporter: ParticleId,
        _near: &S,
        _memory: &mut Self::Memory,
        _commands: &mut Commands<Self::Event>,
    ) -> Response<D> {
        Response::Ignore
    }
}
