//! What a policy keeps of each grain for the self-check.

use serde::{Deserialize, Serialize};

use crate::model::{Commands, Response, Surroundings, Waking};
use crate::particle::{Mode, Particle, ParticleId};
use crate::policy::supports::{Check, CheckDue, Supports};

/// The supports of a grain: next to nothing for those that never check.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(in crate::policy) struct Kept(Option<Box<Supports>>);

impl Kept {
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
        let grain = near.particle(id);
        match (check, &self.0) {
            (Some(check), Some(supports))
                if grain.mode == Mode::Frozen && supports.is_current(event) =>
            {
                match supports.go_on(check, id, near, commands) {
                    Ok(()) => Response::Keep,
                    Err(reason) => Response::Wake(waking(&grain), reason),
                }
            }
            _ => Response::Ignore,
        }
    }

    /// The same for one that hears of a change of its supports.
    pub(in crate::policy) fn answer<const D: usize, S: Surroundings<D>>(
        &self,
        check: Option<Check<'_>>,
        id: ParticleId,
        near: &S,
        waking: impl FnOnce(&Particle<D>) -> Waking<D>,
    ) -> Response<D> {
        let grain = near.particle(id);
        match (check, &self.0) {
            (Some(check), Some(supports)) if grain.mode == Mode::Frozen => {
                match supports.verify(check, id, near) {
                    Ok(()) => Response::Keep,
                    Err(reason) => Response::Wake(waking(&grain), reason),
                }
            }
            _ => Response::Ignore,
        }
    }
}
