//! What is told to whoever watches a run.

use crate::model::{Reason, Surroundings};
use crate::particle::{ParticleId, Vector, WallId};
use crate::time::Time;

/// What happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum OccurrenceKind {
    /// Two mobile grains collided.
    Pair,
    /// A mobile grain hit a static one, which stayed.
    Frozen,
    /// A mobile grain hit a frozen one, which woke.
    Wake,
    /// A grain hit a wall.
    Wall,
    /// A grain fell asleep.
    Sleep,
    /// A policy's own event woke a grain.
    CheckWake,
    /// The end of a cascade of collisions changed the velocity of a grain that
    /// took no part in the last of them. (Of those that did, it is part of the
    /// collision.) Not counted among the physical events.
    Guard,
}

impl OccurrenceKind {
    /// The name used in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            OccurrenceKind::Pair => "pair",
            OccurrenceKind::Frozen => "frozen",
            OccurrenceKind::Wake => "wake",
            OccurrenceKind::Wall => "wall",
            OccurrenceKind::Sleep => "sleep",
            OccurrenceKind::CheckWake => "check_wake",
            OccurrenceKind::Guard => "guard",
        }
    }
}

/// A physical event that has just been carried out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Occurrence<const D: usize> {
    /// When.
    pub time: Time,
    /// What.
    pub kind: OccurrenceKind,
    /// The grain it happened to: of a pair the one with the smaller id, else
    /// the one that hits.
    pub particle: ParticleId,
    /// The other grain, if any.
    pub other: Option<ParticleId>,
    /// The wall, if any.
    pub wall: Option<WallId>,
    /// Normal closing speed before anything is given back, in √(gd); 0 where
    /// nothing collides.
    pub impact_speed: f64,
    /// Momentum that `particle` received, in m√(gd).
    pub impulse: Vector<D>,
    /// Velocity of `particle` after, in √(gd).
    pub velocity: Vector<D>,
    /// Velocity of `other` after, in √(gd); zero if there is none.
    pub other_velocity: Vector<D>,
    /// Made elastic by a cut-off.
    pub elastic: bool,
    /// Why a grain woke, falls asleep, or will do so on its way to its next
    /// collision.
    pub reason: Option<Reason>,
}

/// Watches a run. It is shown what happened after it has happened and can
/// change nothing.
///
/// `()` watches nothing, a pair `(a, b)` shows everything to both, and any
/// closure `FnMut(&Occurrence<D>)` is an observer.
pub trait Observer<const D: usize> {
    /// Something has happened; `after` is the world just after it.
    fn observe<S: Surroundings<D>>(&mut self, occurrence: &Occurrence<D>, after: &S);
}

impl<const D: usize> Observer<D> for () {
    fn observe<S: Surroundings<D>>(&mut self, _: &Occurrence<D>, _: &S) {}
}

impl<const D: usize, F: FnMut(&Occurrence<D>)> Observer<D> for F {
    fn observe<S: Surroundings<D>>(&mut self, occurrence: &Occurrence<D>, _: &S) {
        self(occurrence);
    }
}

impl<const D: usize, A: Observer<D>, B: Observer<D>> Observer<D> for (A, B) {
    fn observe<S: Surroundings<D>>(&mut self, occurrence: &Occurrence<D>, after: &S) {
        self.0.observe(occurrence, after);
        self.1.observe(occurrence, after);
    }
}
