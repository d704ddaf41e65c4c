//! Every number of a scenario against its range.

use crate::error::SetupError;
use crate::scenario::error::{Problem, Refusal};
use crate::scenario::path::Path;
use crate::scenario::read::Origin;
use crate::scenario::schema::{Gravity, Scenario, Side, Source, SourceKind};
use crate::setup::Sizes;

/// No coordinate and no length is greater, in d.
const FARTHEST: f64 = 1.0e9;
/// The latest time a run may be asked for, in √(d/g).
const LATEST: f64 = 8.0e9;
/// The greatest number of grains.
pub(super) const MOST_GRAINS: usize = 10_000_000;
/// The greatest number of rows and frames.
const MOST_SAMPLES: f64 = 1.0e7;
/// Grains per volume of the base, in 1/d³ or 1/d², not less than there will be.
const DENSEST: f64 = 1.5;

const NOT_NEGATIVE: &str = "0 or more is allowed";
const POSITIVE: &str = "a number greater than 0 is allowed";
const UNIT: &str = "a number from 0 to 1 is allowed";
const COORDINATE: &str = "a number between -1e9 and 1e9 is allowed";

/// Refuses a scenario with a number out of its range, or with parts that
/// contradict each other.
pub(super) fn validate(origin: &Origin, scenario: &Scenario) -> Result<(), Refusal> {
    let checker = Checker { origin, scenario };
    checker.gravity()?;
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
                self.require(size > 0.0 && size <= FARTHEST, path, "zero", allowed)
            }
        }
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
        self.fraction("parameters.frozen_restitution", parameters.frozen_restitution)?;
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
        let all_frozen = stop
            .all_frozen
            .unwrap_or(!matches!(scenario.gravity, Gravity::None));
        self.require(
            all_frozen || stop.time.is_some() || stop.events.is_some(),
            || key("stop"),
            "never reached",
            "give stop.time or stop.events; without gravity nothing comes to rest",
        )?;
        let output = &scenario.output;
        for (path, every) in [
            ("output.series_every", output.series_every),
            ("output.frames_every", output.frames_every),
        ] {
            self.not_negative(path, every)?;
            let samples = if every == 0.0 { 0.0 } else { stop.time.unwrap_or(0.0) / every };
            let allowed = "at most 1e7 samples up to stop.time are allowed, or 0 for none";
            self.require(samples <= MOST_SAMPLES, || key(path), every, allowed)?;
            self.require(every == 0.0 || every >= 1.0e-9, || key(path), every, allowed)?;
        }
        if let Some(from) = output.mean_normal_from {
            self.not_negative("output.mean_normal_from", from)?;
        }
        Ok(())
    }

    fn sources(&self) -> Result<(), Refusal> {
        let sources = &self.scenario.grains;
        self.require(
            !sources.is_empty(),
            || key("grains"),
            "an empty list",
            "at least one source of grains is needed",
        )?;
        let mut grains = 0_usize;
        let mut drops = 0;
        for (index, source) in sources.iter().enumerate() {
            let path = key("grains").index(index);
            let kind = self.kind(source, &path)?;
            self.source(source, kind, &path)?;
            grains = grains.saturating_add(source.count());
            self.require(
                grains <= MOST_GRAINS,
                || path.clone(),
                format!("the source of grain {grains}"),
                "at most 10000000 grains are allowed",
            )?;
            drops += usize::from(matches!(kind, SourceKind::OneByOne(_)));
            self.require(
                drops <= 1,
                || path.clone(),
                "a second one_by_one",
                "only one is allowed",
            )?;
        }
        Ok(())
    }

    fn kind<'a>(&self, source: &'a Source, path: &Path) -> Result<SourceKind<'a>, Refusal> {
        source.kind().map_err(|names| {
            let found = if names.is_empty() {
                "a source of nothing".to_owned()
            } else {
                format!("a source of {} at once", names.join(" and "))
            };
            let allowed = "exactly one of position, file, base, rain, gas, one_by_one is allowed";
            let problem = Problem::Value {
                found,
                allowed: allowed.to_owned(),
            };
            self.origin.refuse(path.clone(), problem)
        })
    }

    fn source(&self, source: &Source, kind: SourceKind<'_>, path: &Path) -> Result<(), Refusal> {
        if let SourceKind::Grain(position) = kind {
            return self.grain(source, position, path);
        }
        for (name, given) in [
            ("velocity", source.velocity.is_some()),
            ("diameter", source.diameter.is_some()),
            ("mass", source.mass.is_some()),
            ("mode", source.mode.is_some()),
        ] {
            self.require(
                !given,
                || path.clone().key(name),
                "given without a position",
                "it belongs to a single grain: give its position, or leave this out",
            )?;
        }
        let above = |name: &str, field: &str, value: f64| {
            let holds = value > 0.0 && value <= FARTHEST;
            self.require(holds, || path.clone().key(name).key(field), value, POSITIVE)
        };
        match kind {
            SourceKind::Grain(_) | SourceKind::File(_) => Ok(()),
            SourceKind::Base(base) => {
                let inside = path.clone().key("base");
                let area = self.lateral_area(&inside)?;
                above("base", "thickness", base.thickness)?;
                self.coordinate(base.bottom, || inside.clone().key("bottom"))?;
                self.sizes(&base.sizes, &inside)?;
                let grain = base.sizes.smallest().powi(self.scenario.axes() as i32);
                let count = DENSEST * area * base.thickness / grain;
                self.require(
                    count <= MOST_GRAINS as f64,
                    || inside,
                    format!("a base of about {count:.0} grains"),
                    "at most 10000000 grains are allowed",
                )
            }
            SourceKind::Rain(rain) => {
                let inside = path.clone().key("rain");
                self.lateral_area(&inside)?;
                self.count(rain.count, &inside)?;
                self.packing(rain.packing_fraction, &inside)?;
                above("rain", "fall_speed", rain.fall_speed)?;
                if let Some(bottom) = rain.bottom {
                    self.coordinate(bottom, || inside.clone().key("bottom"))?;
                }
                self.sizes(&rain.sizes, &inside)
            }
            SourceKind::OneByOne(drops) => {
                let inside = path.clone().key("one_by_one");
                self.lateral_area(&inside)?;
                self.count(drops.count, &inside)?;
                self.require(
                    (0.0..=FARTHEST).contains(&drops.clearance),
                    || inside.clone().key("clearance"),
                    drops.clearance,
                    NOT_NEGATIVE,
                )?;
                above("one_by_one", "fall_speed", drops.fall_speed)?;
                self.require(
                    !matches!(self.scenario.gravity, Gravity::None),
                    || inside.clone(),
                    "used without gravity",
                    "it waits until everything is at rest, which takes gravity",
                )?;
                self.sizes(&drops.sizes, &inside)
            }
            SourceKind::Gas(gas) => {
                let inside = path.clone().key("gas");
                let alone = self.scenario.grains.len() == 1 && self.scenario.boundaries.is_empty();
                self.require(
                    alone,
                    || inside.clone(),
                    "not alone",
                    "a gas makes its own periodic box: leave out boundaries and other grains",
                )?;
                self.count(gas.count, &inside)?;
                self.packing(gas.packing_fraction, &inside)?;
                let holds = gas.temperature >= 0.0;
                let at = || inside.clone().key("temperature");
                self.require(holds, at, gas.temperature, NOT_NEGATIVE)?;
                let axes = self.scenario.axes();
                self.require(
                    gas.aspect.is_empty() || gas.aspect.len() == axes,
                    || inside.clone().key("aspect"),
                    format!("a list of {}", gas.aspect.len()),
                    &format!("{axes} numbers are needed, one per axis"),
                )?;
                for (axis, proportion) in gas.aspect.iter().enumerate() {
                    self.require(
                        (1.0e-3..=1.0e3).contains(proportion),
                        || inside.clone().key("aspect").index(axis),
                        proportion,
                        "a number from 0.001 to 1000 is allowed",
                    )?;
                }
                self.sizes(&gas.sizes, &inside)
            }
        }
    }

    fn grain(&self, source: &Source, position: &[f64], path: &Path) -> Result<(), Refusal> {
        self.vector(position, || path.clone().key("position"))?;
        if let Some(velocity) = &source.velocity {
            self.vector(velocity, || path.clone().key("velocity"))?;
            let resting = source.mode.is_some_and(|mode| mode.is_static());
            self.require(
                !resting || velocity.iter().all(|&component| component == 0.0),
                || path.clone().key("velocity"),
                "not 0",
                "frozen and fixed grains are at rest",
            )?;
        }
        for (name, value) in [("diameter", source.diameter), ("mass", source.mass)] {
            if let Some(value) = value {
                let holds = value > 0.0 && value <= FARTHEST;
                self.require(holds, || path.clone().key(name), value, POSITIVE)?;
            }
        }
        Ok(())
    }

    fn vector(&self, vector: &[f64], path: impl Fn() -> Path) -> Result<(), Refusal> {
        let axes = self.scenario.axes();
        self.require(
            vector.len() == axes,
            &path,
            format!("a vector with {} components", vector.len()),
            &format!("{axes} are needed, one per axis"),
        )?;
        for (axis, &component) in vector.iter().enumerate() {
            self.coordinate(component, || path().index(axis))?;
        }
        Ok(())
    }

    fn coordinate(&self, value: f64, path: impl FnOnce() -> Path) -> Result<(), Refusal> {
        self.require(value.abs() <= FARTHEST, path, value, COORDINATE)
    }

    fn count(&self, count: usize, inside: &Path) -> Result<(), Refusal> {
        self.require(
            (1..=MOST_GRAINS).contains(&count),
            || inside.clone().key("count"),
            count,
            "a whole number from 1 to 10000000 is allowed",
        )
    }

    fn packing(&self, fraction: f64, inside: &Path) -> Result<(), Refusal> {
        self.require(
            fraction > 0.0 && fraction < 1.0,
            || inside.clone().key("packing_fraction"),
            fraction,
            "a number between 0 and 1 is allowed",
        )
    }

    fn sizes(&self, sizes: &Sizes, inside: &Path) -> Result<(), Refusal> {
        let path = inside.clone().key("sizes");
        match sizes.validated() {
            Ok(_) => {
                let (least, most) = (sizes.smallest(), sizes.largest());
                let holds = least >= 1.0e-6 && most <= 1.0e6;
                let found = format!("between {least} and {most}");
                self.require(holds, || path, found, "diameters from 1e-6 to 1e6 are allowed")
            }
            Err(SetupError::Parameter {
                field,
                value,
                allowed,
            }) => self.require(false, || path.key(field), value, allowed),
            Err(error) => Err(self.origin.refuse(path, error)),
        }
    }

    /// The extent across the last axis, in d^(D−1), which generators need to be
    /// finite.
    fn lateral_area(&self, path: &Path) -> Result<f64, Refusal> {
        let mut area = 1.0;
        for axis in 0..self.scenario.axes() - 1 {
            match self.scenario.lateral(axis) {
                Some((_, length, _)) => area *= length,
                None => {
                    let allowed = format!(
                        "for it boundaries[{axis}] has to be periodic, or to have two walls"
                    );
                    let found = "used without bounds to its sides";
                    self.require(false, || path.clone(), found, &allowed)?;
                }
            }
        }
        Ok(area)
    }
}
