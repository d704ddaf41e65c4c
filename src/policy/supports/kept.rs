//! What a policy keeps of each grain for the self-check.

use serde::{Deserialize, Serialize};

use crate::model::{Commands, Reason, Response, Surroundings, Waking};
use crate::particle::{Mode, Particle, ParticleId};
use crate::policy::supports::{Check, CheckDue, Supports};

/// The supports of a grain: next to nothing for those that never check.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(in crate::policy) struct Kept(Option<Box<Supports>>);

impl Kept {
    /// Nothing has ever been kept.
    pub(in crate::policy) fn is_empty(&self) -> bool {
        self.0.is_none()
    }

    /// For grains as the simulation starts, or as they are inserted: one that is frozen
    /// notes who holds it up, and asks for its first check.
    pub(in crate::policy) fn start<const D: usize, S: Surroundings<D>>(
        &mut self,
        check: Option<Check<'_>>,
        id: ParticleId,
        near: &S,
        commands: &mut Commands<CheckDue>,
    ) {
        if let Some(check) = check
            && near.particle(id).mode == Mode::Frozen
        {
            let wait = || check.first_wait(id, near.time());
            let supports = self.0.get_or_insert_default();
            supports.begin(check, wait, id, near, commands);
        }
    }

    /// The same for one that falls asleep now.
    pub(in crate::policy) fn begin<const D: usize, S: Surroundings<D>>(
        &mut self,
        check: Option<Check<'_>>,
        id: ParticleId,
        near: &S,
        commands: &mut Commands<CheckDue>,
    ) {
        if let Some(check) = check {
            let wait = || check.wait(near.time());
            let supports = self.0.get_or_insert_default();
            supports.begin(check, wait, id, near, commands);
        }
    }

    /// Forgets them, and makes checks that are still due void.
    pub(in crate::policy) fn forget(&mut self) {
        if let Some(supports) = &mut self.0 {
            supports.forget();
        }
    }

    /// What a grain does whose check is due: if it sleeps and a support is gone, it
    /// wakes, as `waking` says for how it is now.
    pub(in crate::policy) fn go_on<const D: usize, S: Surroundings<D>>(
        &self,
        check: Option<Check<'_>>,
        event: CheckDue,
        id: ParticleId,
        near: &S,
        commands: &mut Commands<CheckDue>,
        waking: impl FnOnce(&Particle<D>) -> Waking<D>,
    ) -> Response<D> {
        self.respond(check, id, near, waking, |supports, check| {
            let current = supports.is_current(event);
            current.then(|| supports.go_on(check, id, near, commands))
        })
    }

    /// The same for one that hears of a change of its supports.
    pub(in crate::policy) fn answer<const D: usize, S: Surroundings<D>>(
        &self,
        check: Option<Check<'_>>,
        id: ParticleId,
        near: &S,
        waking: impl FnOnce(&Particle<D>) -> Waking<D>,
    ) -> Response<D> {
        self.respond(check, id, near, waking, |supports, check| {
            Some(supports.verify(check, id, near))
        })
    }

    /// What a grain does, if it sleeps, on what `look` finds of its supports; nothing if
    /// that does not concern it.
    fn respond<const D: usize, S: Surroundings<D>>(
        &self,
        check: Option<Check<'_>>,
        id: ParticleId,
        near: &S,
        waking: impl FnOnce(&Particle<D>) -> Waking<D>,
        look: impl FnOnce(&Supports, Check<'_>) -> Option<Result<(), Reason>>,
    ) -> Response<D> {
        let (Some(check), Some(supports)) = (check, &self.0) else {
            return Response::Ignore;
        };
        let grain = near.particle(id);
        if grain.mode != Mode::Frozen {
            return Response::Ignore;
        }
        match look(supports, check) {
            Some(Ok(())) => Response::Keep,
            Some(Err(reason)) => Response::Wake(waking(&grain), reason),
            None => Response::Ignore,
        }
    }
}
