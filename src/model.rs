//! The contract: five traits, what they are told and what they answer.
//!
//! [`Dynamics`] says how a grain flies, [`Predictor`] when two flights meet,
//! [`CollisionRule`] what a collision does, [`StatePolicy`] who falls asleep
//! and who wakes, [`Boundary`] where the world ends. A [`Model`] bundles one of
//! each; the engine knows a simulation by that one bound alone.
//!
//! Plug-ins hold parameters and nothing else: they take `&self`, read what the
//! engine shows them, and answer with a value. Whatever has to be remembered
//! per grain is the policy's [`StatePolicy::Memory`] or the rule's
//! [`CollisionRule::Spin`], which the engine stores.

mod boundary;
mod collision;
mod dynamics;
mod impact;
mod observer;
mod policy;
mod predictor;
mod surroundings;

pub use boundary::{Boundary, Period, Shape, Wall};
pub use collision::{CollisionRule, Rebound, Spins};
pub use dynamics::{
    Drift, Dynamics, Flight, GravityCourse, Motion, PolynomialFlight, TurningFlight,
};
pub use impact::{Impact, Obstacle};
pub use observer::{Observer, Occurrence, OccurrenceKind};
pub use policy::{
    Commands, NoEvent, Place, Reason, Response, SHORTEST_WAIT, SleepDecision, StatePolicy,
    WakeCause, WakeDecision, Waking,
};
pub use predictor::{Approach, Crowd, Encounter, Forecast, LANES, Nook, Predictor, Resting};
pub use surroundings::{NearWall, Neighbour, Surroundings};

/// One of each of the five parts: what a simulation is made of.
///
/// Nobody implements this by hand: [`Parts`] does, for any five values that fit
/// together.
pub trait Model<const D: usize> {
    /// How grains fly.
    type Dynamics: Dynamics<D>;
    /// When flights meet.
    type Predictor: Predictor<D, FlightOf<Self, D>>;
    /// What a collision does.
    type CollisionRule: CollisionRule<D>;
    /// Who sleeps and who wakes.
    type StatePolicy: StatePolicy<D>;
    /// Where the world ends.
    type Boundary: Boundary<D>;

    /// How grains fly.
    fn dynamics(&self) -> &Self::Dynamics;
    /// When flights meet.
    fn predictor(&self) -> &Self::Predictor;
    /// What a collision does.
    fn collision_rule(&self) -> &Self::CollisionRule;
    /// Who sleeps and who wakes.
    fn state_policy(&self) -> &Self::StatePolicy;
    /// Where the world ends.
    fn boundary(&self) -> &Self::Boundary;
}

/// The flight of a model's dynamics.
pub type FlightOf<M, const D: usize> = <<M as Model<D>>::Dynamics as Dynamics<D>>::Flight;
/// What a model's policy remembers of a grain.
pub type MemoryOf<M, const D: usize> = <<M as Model<D>>::StatePolicy as StatePolicy<D>>::Memory;
/// The events a model's policy asks for.
pub type EventOf<M, const D: usize> = <<M as Model<D>>::StatePolicy as StatePolicy<D>>::Event;
/// The inner state that a model's collision rule gives each grain.
pub type SpinOf<M, const D: usize> = <<M as Model<D>>::CollisionRule as CollisionRule<D>>::Spin;

/// Five values that make a [`Model`].
///
/// The generic type names are: `Y` dynamics, `P` predictor, `C` collision rule,
/// `S` state policy, `B` boundary; inference fills them in.
#[derive(Clone, Copy, Debug, Default)]
pub struct Parts<Y, P, C, S, B> {
    /// How grains fly.
    pub dynamics: Y,
    /// When flights meet.
    pub predictor: P,
    /// What a collision does.
    pub collision_rule: C,
    /// Who sleeps and who wakes.
    pub state_policy: S,
    /// Where the world ends.
    pub boundary: B,
}

impl<Y, P, C, S, B> Parts<Y, P, C, S, B> {
    /// The same model with another dynamics.
    pub fn with_dynamics<Y2>(self, dynamics: Y2) -> Parts<Y2, P, C, S, B> {
        Parts {
            dynamics,
            predictor: self.predictor,
            collision_rule: self.collision_rule,
            state_policy: self.state_policy,
            boundary: self.boundary,
        }
    }

    /// The same model with another predictor.
    pub fn with_predictor<P2>(self, predictor: P2) -> Parts<Y, P2, C, S, B> {
        Parts {
            dynamics: self.dynamics,
            predictor,
            collision_rule: self.collision_rule,
            state_policy: self.state_policy,
            boundary: self.boundary,
        }
    }

    /// The same model with another collision rule.
    pub fn with_collision_rule<C2>(self, collision_rule: C2) -> Parts<Y, P, C2, S, B> {
        Parts {
            dynamics: self.dynamics,
            predictor: self.predictor,
            collision_rule,
            state_policy: self.state_policy,
            boundary: self.boundary,
        }
    }

    /// The same model with another state policy.
    pub fn with_policy<S2>(self, state_policy: S2) -> Parts<Y, P, C, S2, B> {
        Parts {
            dynamics: self.dynamics,
            predictor: self.predictor,
            collision_rule: self.collision_rule,
            state_policy,
            boundary: self.boundary,
        }
    }

    /// The same model with another boundary.
    pub fn with_boundary<B2>(self, boundary: B2) -> Parts<Y, P, C, S, B2> {
        Parts {
            dynamics: self.dynamics,
            predictor: self.predictor,
            collision_rule: self.collision_rule,
            state_policy: self.state_policy,
            boundary,
        }
    }
}

impl<const D: usize, Y, P, C, S, B> Model<D> for Parts<Y, P, C, S, B>
where
    Y: Dynamics<D>,
    P: Predictor<D, Y::Flight>,
    C: CollisionRule<D>,
    S: StatePolicy<D>,
    B: Boundary<D>,
{
    type Dynamics = Y;
    type Predictor = P;
    type CollisionRule = C;
    type StatePolicy = S;
    type Boundary = B;

    fn dynamics(&self) -> &Y {
        &self.dynamics
    }

    fn predictor(&self) -> &P {
        &self.predictor
    }

    fn collision_rule(&self) -> &C {
        &self.collision_rule
    }

    fn state_policy(&self) -> &S {
        &self.state_policy
    }

    fn boundary(&self) -> &B {
        &self.boundary
    }
}
