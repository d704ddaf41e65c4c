//! One type for all built-in criteria, so that a program that chooses among
//! them is compiled once.

use serde::{Deserialize, Serialize};

use crate::error::SetupError;
use crate::model::{
    Commands, Impact, Response, SleepDecision, StatePolicy, Surroundings, WakeCause, WakeDecision,
};
use crate::particle::{ParticleId, Vector};
use crate::policy::at_rest::{AtRest, RestCondition, RestMemory};
use crate::policy::supports::CheckDue;
use crate::policy::{
    DisplacementWindow, DynamoSleep, GranularTemperature, IsostaticSupport, Never, Remembered,
    SlowDescent, VelocityVariance,
};

/// Any of the built-in criteria. It does what the chosen one does, event by
/// event.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Criterion {
    /// The paper's.
    SlowDescent(SlowDescent),
    /// D static contacts that hold the weight.
    IsostaticSupport(IsostaticSupport),
    /// Hardly moved for a while.
    DisplacementWindow(AtRest<DisplacementWindow>),
    /// A velocity that hardly varies.
    VelocityVariance(AtRest<VelocityVariance>),
    /// A cold neighbourhood.
    GranularTemperature(AtRest<GranularTemperature>),
    /// That of the code DynamO.
    DynamoSleep(AtRest<DynamoSleep>),
    /// Nobody sleeps.
    Never,
}

/// What [`Criterion`] remembers of a grain: what the chosen criterion does.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct CriterionMemory<const D: usize>(Inner<D>);

type HistoryOf<C, const D: usize> = <C as RestCondition<D>>::History;

/// An enum is as long as its longest variant, and one is kept for every grain, whatever
/// the criterion. So the variant that most runs use, the paper's, lies in place and sets
/// the length, 72 bytes in space; those of the gallery lie in boxes, for they would take
/// up to twice as much of every grain. (That of `Temperature` alone would not, without a
/// history; it goes with the others.)
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
enum Inner<const D: usize> {
    /// Nothing yet.
    #[default]
    Nothing,
    Descent(Remembered<D>),
    Displacement(Box<RestMemory<HistoryOf<DisplacementWindow, D>, D>>),
    Variance(Box<RestMemory<HistoryOf<VelocityVariance, D>, D>>),
    Temperature(Box<RestMemory<HistoryOf<GranularTemperature, D>, D>>),
    Dynamo(Box<RestMemory<HistoryOf<DynamoSleep, D>, D>>),
}

/// A kind of memory among the kinds that there are.
trait Kind<const D: usize>: Default {
    fn wrap(self) -> Inner<D>;
    fn of(inner: &Inner<D>) -> Option<&Self>;
    fn of_mut(inner: &mut Inner<D>) -> Option<&mut Self>;
}

macro_rules! kinds {
    ($($kind:ident: $memory:ty,)*) => {
        $(impl<const D: usize> Kind<D> for $memory {
            fn wrap(self) -> Inner<D> {
                // In a box where there is one.
                Inner::$kind(self.into())
            }
            fn of(inner: &Inner<D>) -> Option<&Self> {
                match inner {
                    Inner::$kind(memory) => Some(memory),
                    _ => None,
                }
            }
            fn of_mut(inner: &mut Inner<D>) -> Option<&mut Self> {
                match inner {
                    Inner::$kind(memory) => Some(memory),
                    _ => None,
                }
            }
        })*
    };
}

kinds! {
    Descent: Remembered<D>,
    Displacement: RestMemory<HistoryOf<DisplacementWindow, D>, D>,
    Variance: RestMemory<HistoryOf<VelocityVariance, D>, D>,
    Temperature: RestMemory<HistoryOf<GranularTemperature, D>, D>,
    Dynamo: RestMemory<HistoryOf<DynamoSleep, D>, D>,
}

impl<const D: usize> CriterionMemory<D> {
    /// Shows the memory, made anew if it is of another kind, to `ask`.
    fn with_mut<K: Kind<D>, R>(&mut self, ask: impl FnOnce(&mut K) -> R) -> R {
        if K::of(&self.0).is_none() {
            self.0 = K::default().wrap();
        }
        match K::of_mut(&mut self.0) {
            Some(memory) => ask(memory),
            // Not reached; a memory that forgets would be the answer.
            None => ask(&mut K::default()),
        }
    }

    fn with<K: Kind<D>, R>(&self, ask: impl FnOnce(&K) -> R) -> R {
        match K::of(&self.0) {
            Some(memory) => ask(memory),
            None => ask(&K::default()),
        }
    }
}

/// Calls the same method of whichever criterion it is. `Never` has no memory
/// and is asked with none.
macro_rules! each {
    ($self:ident, $memory:ident.$with:ident, |$policy:ident, $slot:ident| $ask:expr, $never:expr) => {
        match $self {
            Criterion::SlowDescent($policy) => $memory.$with(|$slot| $ask),
            Criterion::IsostaticSupport($policy) => $memory.$with(|$slot| $ask),
            Criterion::DisplacementWindow($policy) => $memory.$with(|$slot| $ask),
            Criterion::VelocityVariance($policy) => $memory.$with(|$slot| $ask),
            Criterion::GranularTemperature($policy) => $memory.$with(|$slot| $ask),
            Criterion::DynamoSleep($policy) => $memory.$with(|$slot| $ask),
            Criterion::Never => $never,
        }
    };
}

impl<const D: usize> StatePolicy<D> for Criterion {
    type Memory = CriterionMemory<D>;
    type Event = CheckDue;

    fn sleeps(&self) -> bool {
        !matches!(self, Criterion::Never)
    }

    fn validate(&self) -> Result<(), SetupError> {
        match self {
            Criterion::SlowDescent(policy) => StatePolicy::<D>::validate(policy),
            Criterion::IsostaticSupport(policy) => StatePolicy::<D>::validate(policy),
            Criterion::DisplacementWindow(policy) => StatePolicy::<D>::validate(policy),
            Criterion::VelocityVariance(policy) => StatePolicy::<D>::validate(policy),
            Criterion::GranularTemperature(policy) => StatePolicy::<D>::validate(policy),
            Criterion::DynamoSleep(policy) => StatePolicy::<D>::validate(policy),
            Criterion::Never => Ok(()),
        }
    }

    fn should_sleep<S: Surroundings<D>>(
        &self,
        impact: &Impact<D>,
        after: Vector<D>,
        near: &S,
        memory: &mut CriterionMemory<D>,
    ) -> SleepDecision {
        each!(
            self,
            memory.with_mut,
            |policy, slot| policy.should_sleep(impact, after, near, slot),
            Never.should_sleep(impact, after, near, &mut ())
        )
    }

    fn should_wake<S: Surroundings<D>>(
        &self,
        impact: &Impact<D>,
        near: &S,
        struck: &CriterionMemory<D>,
    ) -> WakeDecision<D> {
        each!(
            self,
            struck.with,
            |policy, slot| policy.should_wake(impact, near, slot),
            Never.should_wake(impact, near, &())
        )
    }

    fn check_memory<S: Surroundings<D>>(
        &self,
        id: ParticleId,
        near: &S,
        memory: &CriterionMemory<D>,
    ) -> Result<(), String> {
        each!(
            self,
            memory.with,
            |policy, slot| policy.check_memory(id, near, slot),
            Ok(())
        )
    }

    fn may_forget<S: Surroundings<D>>(
        &self,
        id: ParticleId,
        near: &S,
        memory: &CriterionMemory<D>,
    ) -> bool {
        each!(
            self,
            memory.with,
            |policy, slot| policy.may_forget(id, near, slot),
            true
        )
    }

    fn on_start<S: Surroundings<D>>(
        &self,
        id: ParticleId,
        near: &S,
        memory: &mut CriterionMemory<D>,
        commands: &mut Commands<CheckDue>,
    ) {
        each!(
            self,
            memory.with_mut,
            |policy, slot| policy.on_start(id, near, slot, commands),
            {}
        );
    }

    fn on_sleep<S: Surroundings<D>>(
        &self,
        id: ParticleId,
        near: &S,
        memory: &mut CriterionMemory<D>,
        commands: &mut Commands<CheckDue>,
    ) {
        each!(
            self,
            memory.with_mut,
            |policy, slot| policy.on_sleep(id, near, slot, commands),
            {}
        );
    }

    fn on_wake<S: Surroundings<D>>(
        &self,
        id: ParticleId,
        cause: &WakeCause<D>,
        near: &S,
        memory: &mut CriterionMemory<D>,
        commands: &mut Commands<CheckDue>,
    ) {
        each!(
            self,
            memory.with_mut,
            |policy, slot| policy.on_wake(id, cause, near, slot, commands),
            {}
        );
    }

    fn on_event<S: Surroundings<D>>(
        &self,
        id: ParticleId,
        event: CheckDue,
        near: &S,
        memory: &mut CriterionMemory<D>,
        commands: &mut Commands<CheckDue>,
    ) -> Response<D> {
        each!(
            self,
            memory.with_mut,
            |policy, slot| policy.on_event(id, event, near, slot, commands),
            Response::Ignore
        )
    }

    fn on_support_change<S: Surroundings<D>>(
        &self,
        id: ParticleId,
        supporter: ParticleId,
        near: &S,
        memory: &mut CriterionMemory<D>,
        commands: &mut Commands<CheckDue>,
    ) -> Response<D> {
        each!(
            self,
            memory.with_mut,
            |policy, slot| policy.on_support_change(id, supporter, near, slot, commands),
            Response::Ignore
        )
    }
}
