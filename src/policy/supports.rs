//! The paper's self-check (section 4): are those that held a grain up still
//! there?

mod ahead;
mod kept;

use std::ops::Deref;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

use crate::error::SetupError;
#[cfg(doc)]
use crate::model::GravityCourse;
use crate::model::{Commands, Reason, SHORTEST_WAIT, Surroundings};
use crate::particle::{Mode, ParticleId, Vector};
use crate::time::Time;
pub(super) use kept::Kept;

/// A wall within this gap below a grain supports it, in d.
pub(super) const WALL_RANGE: f64 = 0.05;

/// With events: how little, in cosines and in distances at contact, a support has
/// to be below, or within range, to be none. So at the foreseen instant, which is
/// rounded, the check finds what was foreseen.
const EDGE: f64 = 1.0e-12;

/// When grains check.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "program", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// τ_check after falling asleep, and so on; grains that start frozen begin
    /// at times spread at random over one interval, by this seed and their id.
    Spread {
        /// The seed.
        seed: u64,
    },
    /// τ_check after falling asleep, or after the start, and so on.
    Own,
    /// At the multiples of τ_check.
    Global,
}

/// What has sleepers check.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "program", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Timing {
    /// The clock: every τ_check, as in the paper.
    #[default]
    Polled,
    /// What happens: at the instant at which a support changes or gravity leaves
    /// it. That is what the clock tends to as τ_check → 0.
    Events,
}

/// The self-check of supports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SelfCheck {
    /// What has sleepers check. With [`Timing::Events`] the clock stays where nothing
    /// can be foreseen: where the dynamics does not say how gravity changes
    /// ([`GravityCourse::Unknown`]), or fixed grains or walls that support move.
    pub timing: Timing,
    /// τ_check, in √(d/g).
    pub interval: f64,
    /// Grains nearer than this times their distance at contact may be supports;
    /// 1.05 in the paper.
    pub support_range: f64,
    /// Whether normal grains above count, as in an arch.
    pub support_normals: bool,
    /// When grains check.
    pub phase: Phase,
    /// Whether a grain without any support wakes.
    pub unsupported_wakes: bool,
}

impl Default for SelfCheck {
    /// The paper's: every 0.1 √(d/g), neighbours nearer than 1.05.
    fn default() -> Self {
        SelfCheck {
            timing: Timing::Polled,
            interval: 0.1,
            support_range: 1.05,
            support_normals: true,
            phase: Phase::Spread { seed: 0 },
            unsupported_wakes: true,
        }
    }
}

impl SelfCheck {
    pub(super) fn validate(&self) -> Result<(), SetupError> {
        // Shorter intervals would check without end at one instant.
        if !(self.interval >= SHORTEST_WAIT && self.interval.is_finite()) {
            return Err(SetupError::Parameter {
                field: "self_check.interval",
                value: self.interval,
                allowed: "1e-9 or more is allowed",
            });
        }
        if !(1.0..=10.0).contains(&self.support_range) {
            return Err(SetupError::Parameter {
                field: "self_check.support_range",
                value: self.support_range,
                allowed: "1 … 10 is allowed",
            });
        }
        Ok(())
    }

    /// Within how many distances at contact supports are looked for.
    fn range(&self) -> f64 {
        match self.timing {
            Timing::Polled => self.support_range,
            Timing::Events => self.support_range - EDGE,
        }
    }

    /// Whether what lies at `offset` from a grain is below it.
    fn is_below<const D: usize>(&self, offset: &Vector<D>, gravity: &Vector<D>) -> bool {
        let lower = offset.dot(gravity);
        match self.timing {
            Timing::Polled => lower > 0.0,
            Timing::Events => {
                let sizes = offset.norm_squared() * gravity.norm_squared();
                lower > EDGE * sizes.sqrt()
            }
        }
    }

    /// How many walls are below a grain.
    fn walls_below<const D: usize, S: Surroundings<D>>(&self, id: ParticleId, near: &S) -> u32 {
        let gravity = near.gravity();
        let mut count = 0;
        near.for_each_wall(id, WALL_RANGE, |wall| {
            count += u32::from(self.is_below(&-wall.normal, &gravity));
        });
        count
    }

    /// How long until the first check of a grain that starts frozen.
    fn first_wait(&self, id: ParticleId, now: Time) -> f64 {
        match self.phase {
            Phase::Spread { seed } => {
                let mut generator = ChaCha8Rng::seed_from_u64(seed);
                generator.set_stream(u64::from(id.0));
                self.interval * generator.random::<f64>()
            }
            Phase::Own | Phase::Global => self.wait(now),
        }
    }

    /// How long until the next check.
    fn wait(&self, now: Time) -> f64 {
        match self.phase {
            Phase::Spread { .. } | Phase::Own => self.interval,
            Phase::Global => {
                let next = now.multiples_reached(self.interval) + 1.0;
                Time::from_units(next * self.interval) - now
            }
        }
    }
}

/// The self-check of a policy.
#[derive(Clone, Copy)]
pub(super) struct Check<'a> {
    rules: &'a SelfCheck,
    /// Whether walls are supports.
    walls_count: bool,
}

impl<'a> Check<'a> {
    /// That of a policy with such rules, if it has any.
    pub(super) fn of(rules: Option<&'a SelfCheck>, walls_count: bool) -> Option<Self> {
        rules.map(|rules| Check { rules, walls_count })
    }
}

impl Deref for Check<'_> {
    type Target = SelfCheck;

    fn deref(&self) -> &SelfCheck {
        self.rules
    }
}

/// The event "grain, check yourself". It carries the number of the sleep it was
/// made in, so that it is void after a waking.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CheckDue {
    sleep: u32,
}

/// Who held a grain up when it fell asleep.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Supports {
    /// Counts the sleeps.
    sleep: u32,
    /// Frozen or fixed grains below.
    below: Vec<ParticleId>,
    /// Normal grains above.
    above: Vec<ParticleId>,
    /// Number of walls below.
    walls: u32,
    /// With events: when nobody held it for the last time.
    unsupported: Option<Time>,
}

impl Supports {
    fn next_check(&self) -> CheckDue {
        CheckDue { sleep: self.sleep }
    }

    fn is_current(&self, event: CheckDue) -> bool {
        event.sleep == self.sleep
    }

    /// Forgets them, and makes checks that are still due void.
    fn forget(&mut self) {
        self.sleep = self.sleep.wrapping_add(1);
        self.below.clear();
        self.above.clear();
        self.walls = 0;
    }

    /// Notes who holds a grain up now.
    fn record<const D: usize, S: Surroundings<D>>(
        &mut self,
        check: Check<'_>,
        id: ParticleId,
        near: &S,
    ) {
        self.forget();
        let gravity = near.gravity();
        let (below, above) = (&mut self.below, &mut self.above);
        near.for_each_neighbour(id, check.range(), |other| {
            if other.mode.is_static() {
                if check.is_below(&other.offset, &gravity) {
                    below.push(other.id);
                }
            } else if check.support_normals
                && other.mode == Mode::Normal
                && other.offset.dot(&gravity) < 0.0
            {
                above.push(other.id);
            }
        });
        below.sort_unstable();
        above.sort_unstable();
        if check.walls_count {
            self.walls = check.walls_below(id, near);
        }
    }

    /// Notes who holds up a grain that sleeps from now on, and asks for its first check,
    /// by the clock after this wait.
    fn begin<const D: usize, S: Surroundings<D>>(
        &mut self,
        check: Check<'_>,
        wait: impl FnOnce() -> f64,
        id: ParticleId,
        near: &S,
        commands: &mut Commands<CheckDue>,
    ) {
        self.record(check, id, near);
        match check.timing {
            Timing::Polled => commands.schedule(id, wait(), self.next_check()),
            Timing::Events => self.settle_down(check, id, near, commands),
        }
    }

    /// Checks, and asks for the next check if all is well.
    fn go_on<const D: usize, S: Surroundings<D>>(
        &self,
        check: Check<'_>,
        id: ParticleId,
        near: &S,
        commands: &mut Commands<CheckDue>,
    ) -> Result<(), Reason> {
        self.verify(check, id, near)?;
        match check.timing {
            Timing::Polled => {
                commands.schedule(id, check.wait(near.time()), self.next_check());
            }
            Timing::Events => self.look_ahead(check, id, near, commands),
        }
        Ok(())
    }

    /// Whether all of them still hold the grain up.
    fn verify<const D: usize, S: Surroundings<D>>(
        &self,
        check: Check<'_>,
        id: ParticleId,
        near: &S,
    ) -> Result<(), Reason> {
        let wanted = self.below.len() + self.above.len() + self.walls as usize;
        if wanted == 0 {
            return if check.unsupported_wakes {
                Err(Reason::new("has a support", 0.0, 1.0))
            } else {
                Ok(())
            };
        }
        let gravity = near.gravity();
        let mut still = 0;
        near.for_each_neighbour(id, check.range(), |other| {
            let holds = self.below.binary_search(&other.id).is_ok()
                && other.mode.is_static()
                && check.is_below(&other.offset, &gravity);
            let braces = self.above.binary_search(&other.id).is_ok();
            still += usize::from(holds || braces);
        });
        if check.walls_count {
            still += check.walls_below(id, near).min(self.walls) as usize;
        }
        if still == wanted {
            Ok(())
        } else {
            Err(Reason::new(
                "all supports are still there",
                still as f64,
                wanted as f64,
            ))
        }
    }
}
