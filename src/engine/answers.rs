//! What the policy last said about one grain, for a diagnosis. Listening changes
//! nothing.

use crate::engine::simulation::Simulation;
use crate::model::{Model, Reason};
use crate::particle::ParticleId;
use crate::time::Time;

/// An answer of the policy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// When it was asked.
    pub time: Time,
    /// The condition that settled it.
    pub reason: Reason,
}

/// The last answers about a grain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Answers {
    /// The last time that it was to fall asleep.
    pub slept: Option<Answer>,
    /// The last time that it was not.
    pub stayed_awake: Option<Answer>,
    /// The last time that a hit woke it.
    pub woke: Option<Answer>,
    /// The last time that a hit did not.
    pub slept_on: Option<Answer>,
}

/// Whom the simulation listens for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ear {
    particle: u32,
    answers: Answers,
}

impl<M: Model<D>, const D: usize> Simulation<M, D> {
    /// From now on the policy's answers about a grain are kept, in place of those
    /// about another.
    pub fn listen(&mut self, particle: ParticleId) {
        self.ear = Some(Ear {
            particle: particle.0,
            answers: Answers::default(),
        });
    }

    /// What the policy has said about the grain of [`listen`](Self::listen) since
    /// then.
    #[must_use]
    pub fn answers(&self) -> Answers {
        self.ear.map(|ear| ear.answers).unwrap_or_default()
    }

    /// Keeps an answer about a grain, if anybody listens.
    pub(super) fn hear(
        &mut self,
        particle: u32,
        keep: impl FnOnce(&mut Answers, Answer),
        reason: Reason,
    ) {
        let time = self.world.clock;
        if let Some(ear) = &mut self.ear
            && ear.particle == particle
        {
            keep(&mut ear.answers, Answer { time, reason });
        }
    }
}
