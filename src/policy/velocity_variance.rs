use serde::{Deserialize, Serialize};

use crate::error::SetupError;
use crate::model::{Impact, Reason, Surroundings};
use crate::particle::Vector;
use crate::policy::at_rest::RestCondition;
use crate::policy::parameters::positive;
use crate::time::Time;

/// At rest is whose velocity has hardly varied over a time τ, about a mean that
/// is hardly a motion: both the root mean square deviation and the size of the
/// mean are below a speed.
///
/// The velocities are those with which the grain arrives at its collisions,
/// relative to the ground, each counted once; windows follow each other, and
/// one with fewer than `least_collisions` says nothing. The running sums are
/// Welford's (doi:10.1080/00401706.1962.10490022). It fails where collisions are
/// rare: a window then holds too few of them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "program", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct VelocityVariance {
    /// The speed below which deviation and mean have to be, in √(gd).
    #[cfg_attr(feature = "program", schemars(extend("exclusiveMinimum" = 0.0, "x-unit" = "√(gd)")))]
    pub speed: f64,
    /// τ, in √(d/g).
    #[cfg_attr(feature = "program", schemars(extend("exclusiveMinimum" = 0.0, "x-unit" = "√(d/g)")))]
    pub window: f64,
    /// The fewest collisions of a window that counts.
    pub least_collisions: u32,
}

impl Default for VelocityVariance {
    /// 0.05 √(gd), over 0.1 √(d/g) and at least three collisions.
    fn default() -> Self {
        VelocityVariance {
            speed: 0.05,
            window: 0.1,
            least_collisions: 3,
        }
    }
}

/// The sums of a window.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct Moments<const D: usize> {
    since: Time,
    count: u32,
    mean: Vector<D>,
    /// Sum of squared deviations from the mean.
    squares: f64,
}

impl<const D: usize> Moments<D> {
    fn begin(since: Time) -> Self {
        Moments {
            since,
            count: 0,
            mean: Vector::zeros(),
            squares: 0.0,
        }
    }

    fn add(&mut self, velocity: Vector<D>) {
        self.count = self.count.saturating_add(1);
        let off = velocity - self.mean;
        self.mean += off / f64::from(self.count);
        self.squares += off.dot(&(velocity - self.mean));
    }
}

impl<const D: usize> RestCondition<D> for VelocityVariance {
    type History = Option<Moments<D>>;

    fn validate(&self) -> Result<(), SetupError> {
        positive("speed", self.speed)?;
        positive("window", self.window)
    }

    fn at_rest<S: Surroundings<D>>(
        &self,
        impact: &Impact<D>,
        _after: Vector<D>,
        _near: &S,
        history: &mut Option<Moments<D>>,
    ) -> Result<Reason, Reason> {
        let moments = history.get_or_insert(Moments::begin(impact.time));
        moments.add(impact.particle.velocity - impact.ground_velocity);
        let lasted = impact.time - moments.since;
        if lasted <= self.window {
            return Err(Reason::new(
                "watched for longer than τ",
                lasted,
                self.window,
            ));
        }
        let full = *moments;
        *history = Some(Moments::begin(impact.time));
        if full.count < self.least_collisions {
            let (count, least) = (f64::from(full.count), f64::from(self.least_collisions));
            return Err(Reason::new("enough collisions in the window", count, least));
        }
        let drift = full.mean.norm_squared().sqrt();
        if drift >= self.speed {
            return Err(Reason::new(
                "mean velocity below the speed",
                drift,
                self.speed,
            ));
        }
        let deviation = (full.squares / f64::from(full.count)).sqrt();
        let reason = Reason::new(
            "deviation of the velocity below the speed",
            deviation,
            self.speed,
        );
        if deviation < self.speed {
            Ok(reason)
        } else {
            Err(reason)
        }
    }
}
