//! Every number of a scenario against its range.

mod sources;

use crate::scenario::error::{Problem, Refusal};
use crate::scenario::path::Path;
use crate::scenario::read::Origin;
use crate::scenario::schema::{Gravity, Scenario, Side, Turns};

/// No coordinate and no length is greater, in d.
const FARTHEST: f64 = 1.0e9;
/// The latest time a run may be asked for, in √(d/g).
const LATEST: f64 = 8.0e9;
/// The greatest number of grains.
pub(super) const MOST_GRAINS: usize = 10_000_000;
/// The greatest number of rows and frames.
const MOST_SAMPLES: f64 = 1.0e7;

const NOT_NEGATIVE: &str = "0 or more is allowed";
const POSITIVE: &str = "a number greater than 0 is allowed";
const UNIT: &str = "a number from 0 to 1 is allowed";
const COORDINATE: &str = "a number between -1e9 and 1e9 is allowed";

/// Refuses a scenario with a number out of its range, or with parts that
/// contradict each other.
pub(super) fn validate(origin: &Origin, scenario: &Scenario) -> Result<(), Refusal> {
    let checker = Checker { origin, scenario };
    checker.gravity()?;
    checker.rotation()?;
    checker.boundaries()?;
    checker.parameters()?;
    checker.stop_and_output()?;
    checker.sources()
}

fn key(path: &str) -> Path {
    path.split('.')
        .fold(Path::root(), |path, name| path.key(name))
}

struct Checker<'a> {
    origin: &'a Origin,
    scenario: &'a Scenario,
}

impl Checker<'_> {
    fn require(
        &self,
        holds: bool,
        path: impl FnOnce() -> Path,
        found: impl ToString,
        allowed: &str,
    ) -> Result<(), Refusal> {
        if holds {
            return Ok(());
        }
        let problem = Problem::Value {
            found: found.to_string(),
            allowed: allowed.to_owned(),
        };
        Err(self.origin.refuse(path(), problem))
    }

    fn not_negative(&self, path: &str, value: f64) -> Result<(), Refusal> {
        self.require(value >= 0.0, || key(path), value, NOT_NEGATIVE)
    }

    fn positive(&self, path: &str, value: f64) -> Result<(), Refusal> {
        self.require(value > 0.0, || key(path), value, POSITIVE)
    }

    fn fraction(&self, path: &str, value: f64) -> Result<(), Refusal> {
        self.require((0.0..=1.0).contains(&value), || key(path), value, UNIT)
    }

    fn gravity(&self) -> Result<(), Refusal> {
        let axes = self.scenario.axes();
        let path = || key("gravity");
        match &self.scenario.gravity {
            Gravity::None => Ok(()),
            Gravity::Down(size) => self.require(
                *size > 0.0 && *size <= FARTHEST,
                path,
                size,
                "a number greater than 0 is allowed, or \"none\"",
            ),
            Gravity::Along(vector) => {
                let count = vector.len();
                self.require(
                    count == axes,
                    path,
                    format!("a vector with {count} components"),
                    &format!("{axes} are needed, one per axis"),
                )?;
                let size = vector.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
                let allowed = "one component has to differ from 0; write \"none\" for no gravity";
                let found = format!("{vector:?}");
                self.require(size > 0.0 && size <= FARTHEST, path, found, allowed)
            }
        }
    }

    fn rotation(&self) -> Result<(), Refusal> {
        let Some(rotation) = &self.scenario.rotation else {
            return Ok(());
        };
        self.require(
            !matches!(self.scenario.gravity, Gravity::None),
            || key("rotation"),
            "used without gravity",
            "a drum turns under gravity: give gravity, or leave out rotation",
        )?;
        let rate = rotation.angular_velocity;
        self.require(
            (1.0e-6..=1.0e3).contains(&rate.abs()),
            || key("rotation.angular_velocity"),
            rate,
            "a number from 1e-6 to 1000, of either sign, is allowed",
        )?;
        if let Some(step) = rotation.step {
            self.require(
                rotation.of == Turns::Gravity,
                || key("rotation.step"),
                "given for ground that turns",
                "only gravity can turn in steps",
            )?;
            self.require(
                (1.0e-6..=1.0e6).contains(&step),
                || key("rotation.step"),
                step,
                "a number from 1e-6 to 1e6 is allowed",
            )?;
        }
        let Gravity::Along(vector) = &self.scenario.gravity else {
            return Ok(());
        };
        let holds = |x: f64| x == 0.0 || (1.0e-9..=FARTHEST).contains(&x.abs());
        let allowed = "where something turns, components of size 1e-9 … 1e9, or 0, are allowed";
        for (axis, &x) in vector.iter().enumerate() {
            self.require(holds(x), || key("gravity").index(axis), x, allowed)?;
        }
        Ok(())
    }

    fn boundaries(&self) -> Result<(), Refusal> {
        let axes = self.scenario.axes();
        let sides = &self.scenario.boundaries;
        self.require(
            sides.is_empty() || sides.len() == axes,
            || key("boundaries"),
            format!("a list of {}", sides.len()),
            &format!("{axes} entries are needed, one per axis"),
        )?;
        for (axis, side) in sides.iter().enumerate() {
            let at = |name: &str| {
                let kind = match side {
                    Side::Open => "open",
                    Side::Periodic { .. } => "periodic",
                    Side::Walls { .. } => "walls",
                };
                key("boundaries").index(axis).key(kind).key(name)
            };
            let coordinate = |name: &str, value: f64| {
                let holds = value.abs() <= FARTHEST;
                self.require(holds, || at(name), value, COORDINATE)
            };
            match *side {
                Side::Open => {}
                Side::Periodic { origin, length } => {
                    coordinate("origin", origin)?;
                    self.require(length > 0.0, || at("length"), length, POSITIVE)?;
                    coordinate("length", length)?;
                }
                Side::Walls {
                    low,
                    high,
                    restitution,
                } => {
                    let in_range = (0.0..=1.0).contains(&restitution);
                    self.require(in_range, || at("restitution"), restitution, UNIT)?;
                    for (name, place) in [("low", low), ("high", high)] {
                        if let Some(place) = place {
                            coordinate(name, place)?;
                        }
                    }
                    match (low, high) {
                        (Some(low), Some(high)) => {
                            let allowed = format!("more than low = {low} is allowed");
                            self.require(low < high, || at("high"), high, &allowed)?;
                        }
                        (None, None) => self.require(
                            false,
                            || key("boundaries").index(axis),
                            "walls that stand nowhere",
                            "give low, high, or both; or write \"open\"",
                        )?,
                        _ => {}
                    }
                }
            }
        }
        Ok(())
    }

    fn parameters(&self) -> Result<(), Refusal> {
        let scenario = self.scenario;
        let parameters = &scenario.parameters;
        self.fraction("parameters.restitution", parameters.restitution)?;
        self.fraction(
            "parameters.frozen_restitution",
            parameters.frozen_restitution,
        )?;
        self.not_negative("parameters.elastic_speed", parameters.elastic_speed)?;
        self.not_negative("parameters.sleep_speed", parameters.sleep_speed)?;
        self.not_negative("parameters.wake_speed", parameters.wake_speed.0)?;
        if let Some(time) = scenario.sleep.store_time {
            self.not_negative("sleep.store_time", time)?;
        }
        self.positive("sleep.horizon", scenario.sleep.horizon)?;
        if let Some(check) = &scenario.self_check {
            self.require(
                check.interval >= 1.0e-6,
                || key("self_check.interval"),
                check.interval,
                "1e-6 or more is allowed; leave self_check out for none",
            )?;
            self.require(
                (1.0..=2.0).contains(&check.support_range),
                || key("self_check.support_range"),
                check.support_range,
                "a number from 1 to 2 is allowed",
            )?;
        }
        let guards = &scenario.guards;
        if let Some(speed) = guards.exit_speed {
            self.not_negative("guards.exit_speed", speed)?;
        }
        self.not_negative("guards.floor_speed", guards.floor_speed)?;
        self.not_negative("guards.hold", guards.hold)
    }

    fn stop_and_output(&self) -> Result<(), Refusal> {
        let scenario = self.scenario;
        let stop = &scenario.stop;
        if let Some(time) = stop.time {
            self.require(
                (0.0..=LATEST).contains(&time),
                || key("stop.time"),
                time,
                "a number from 0 to 8e9 is allowed",
            )?;
        }
        self.require(
            // Who never sleeps never comes to rest.
            (scenario.ends_all_frozen() && scenario.sleep.criterion != "never")
                || stop.time.is_some()
                || stop.events.is_some(),
            || key("stop"),
            "never reached",
            "give stop.time or stop.events; without gravity, where it turns, or if nobody sleeps, \
             nothing comes to rest",
        )?;
        let output = &scenario.output;
        for (path, every) in [
            ("output.series_every", output.series_every),
            ("output.frames_every", output.frames_every),
        ] {
            self.not_negative(path, every)?;
            let samples = if every == 0.0 {
                0.0
            } else {
                stop.time.unwrap_or(0.0) / every
            };
            let allowed = "at most 1e7 samples up to stop.time are allowed, or 0 for none";
            self.require(samples <= MOST_SAMPLES, || key(path), every, allowed)?;
            self.require(
                every == 0.0 || every >= 1.0e-9,
                || key(path),
                every,
                allowed,
            )?;
        }
        if let Some(from) = output.mean_normal_from {
            self.not_negative("output.mean_normal_from", from)?;
        }
        Ok(())
    }
}
