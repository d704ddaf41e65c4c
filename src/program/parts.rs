//! Parts of one's own in the place of built-in ones, for all that the program does.

use std::marker::PhantomData;
use std::process::ExitCode;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::boundary::Cuboid;
use crate::collide::Restitution;
use crate::model::{Dynamics, Model, Parts, Predictor, StatePolicy};
use crate::program::criteria::{Own, Program};
use crate::program::runner::{Added, BuiltIn};
use crate::scenario::{KnownCriterion, KnownParts};

/// Says what the models of the program are made of.
///
/// The program makes the model of a scenario from built-in parts and hands it over:
/// a refit returns the one that runs, with a collision rule, a dynamics (and a
/// predictor for its flights) or a boundary of one's own. The fields of the type are
/// its parameters in scenarios, under `[parts.NAME]`; whether they are within their
/// range is for the `validate` of the part that gets them. A boundary should not be
/// derived from that of `parts`: a run that is gone on with has another there. A dynamics
/// takes the place of the scenario's `rotation`, too.
///
/// ```no_run
/// use std::process::ExitCode;
///
/// use grainfall::boundary::Cuboid;
/// use grainfall::collide::Restitution;
/// use grainfall::model::{CollisionRule, Dynamics, Impact, Model, Parts, Predictor, Rebound};
/// use grainfall::model::{Spins, StatePolicy};
/// use grainfall::program::{Program, Refit};
/// use serde::{Deserialize, Serialize};
///
/// /// Restitutions that fall with the speed of impact: α(v) = α − loss v^(1/5).
/// #[derive(Serialize, Deserialize)]
/// struct Viscous {
///     loss: f64,
/// }
///
/// /// The rule, around the built-in one.
/// struct Falling {
///     constant: Restitution,
///     loss: f64,
/// }
///
/// impl<const D: usize> CollisionRule<D> for Falling {
///     type Spin = ();
///
///     fn collide(&self, hit: &Impact<D>, spins: Spins<'_, ()>) -> Rebound<D> {
///         let lost = self.loss * libm::pow(hit.closing_speed(), 0.2);
///         let now = Restitution {
///             restitution: (self.constant.restitution - lost).max(0.0),
///             frozen_restitution: (self.constant.frozen_restitution - lost).max(0.0),
///             ..self.constant
///         };
///         now.collide(hit, spins)
///     }
/// }
///
/// impl Refit for Viscous {
///     fn refit<Y, P, S, const D: usize>(
///         &self,
///         parts: Parts<Y, P, Restitution, S, Cuboid<D>>,
///     ) -> impl Model<D>
///     where
///         Y: Dynamics<D>,
///         P: Predictor<D, Y::Flight>,
///         S: StatePolicy<D>,
///     {
///         let constant = parts.collision_rule;
///         parts.with_collision_rule(Falling {
///             constant,
///             loss: self.loss,
///         })
///     }
/// }
///
/// fn main() -> ExitCode {
///     Program::with_parts::<Viscous>("viscous").main()
/// }
/// ```
pub trait Refit {
    /// The model that runs, made from the built-in one of a scenario.
    fn refit<Y, P, S, const D: usize>(
        &self,
        parts: Parts<Y, P, Restitution, S, Cuboid<D>>,
    ) -> impl Model<D>
    where
        Y: Dynamics<D>,
        P: Predictor<D, Y::Flight>,
        S: StatePolicy<D>;
}

/// The built-in parts.
#[derive(Serialize, serde::Deserialize)]
pub(super) struct AsTheyAre {}

impl Refit for AsTheyAre {
    fn refit<Y, P, S, const D: usize>(
        &self,
        parts: Parts<Y, P, Restitution, S, Cuboid<D>>,
    ) -> impl Model<D>
    where
        Y: Dynamics<D>,
        P: Predictor<D, Y::Flight>,
        S: StatePolicy<D>,
    {
        parts
    }
}

/// The [program](Program) whose models have parts of one's own.
#[derive(Debug)]
pub struct RefittedProgram<Q> {
    program: Program,
    parts: PhantomData<fn() -> Q>,
}

impl Program {
    /// With the built-in criteria, and parts of one's own in the models: `run`,
    /// `resume`, `sweep`, `compare`, `why` and `check` then work with those. The parameters
    /// of the parts are read from `[parts.NAME]`; one with a default may be left out.
    /// `scenario.toml` in the folder of a run names them all, so that no other program
    /// goes on with it, and this one with no other's.
    #[must_use]
    pub fn with_parts<Q>(name: &'static str) -> RefittedProgram<Q>
    where
        Q: Refit + Serialize + DeserializeOwned + 'static,
    {
        let known = KnownParts::of::<Q>(name);
        RefittedProgram {
            program: Program::of(Box::new(BuiltIn::<Q>::default()), Some(known)),
            parts: PhantomData,
        }
    }
}

impl<Q: Refit + Serialize + DeserializeOwned + 'static> RefittedProgram<Q> {
    /// Adds a policy, as [`Program::with_criterion`] does.
    #[must_use]
    pub fn with_criterion<P>(mut self, name: &'static str, summary: &'static str) -> Self
    where
        P: StatePolicy<2> + StatePolicy<3> + Serialize + DeserializeOwned + 'static,
    {
        self.program.add(Own {
            known: KnownCriterion::of_policy::<P>(name, summary),
            runner: Box::new(Added::<P, Q>::default()),
        });
        self
    }

    /// Runs the program with the arguments of this process, and says how it went.
    #[must_use]
    pub fn main(&self) -> ExitCode {
        self.program.main()
    }
}
