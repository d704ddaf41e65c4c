//! The sources of grains.

use crate::scenario::error::{Problem, Refusal};
use crate::scenario::path::Path;
use crate::scenario::schema::{Dimension, Drum, Gravity, Side, Source, SourceKind};
use crate::scenario::validate::{
    COORDINATE, Checker, FARTHEST, MOST_GRAINS, NOT_NEGATIVE, POSITIVE, key,
};
use crate::setup::{self, Sizes};

/// Grains per volume of the base, in 1/d³ or 1/d², not less than there will be.
const DENSEST: f64 = 1.5;

impl Checker<'_> {
    pub(super) fn sources(&self) -> Result<(), Refusal> {
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
            let allowed =
                "exactly one of position, file, base, rain, gas, drum, one_by_one is allowed";
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
            SourceKind::Drum(drum) => self.drum(drum, &path.clone().key("drum")),
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

    fn drum(&self, drum: &Drum, inside: &Path) -> Result<(), Refusal> {
        let drum_of = setup::Drum::from(*drum);
        let made = match self.scenario.dimension {
            Dimension::Two => drum_of.validated::<2>().map(drop),
            Dimension::Three => drum_of.validated::<3>().map(drop),
        };
        made.map_err(|error| self.origin.refuse_part(inside.clone(), error))?;
        let holds = drum.level.abs() <= drum.radius;
        let allowed = "between the lowest and the highest point of the drum is allowed";
        self.require(holds, || inside.clone().key("level"), drum.level, allowed)?;
        self.require(
            self.scenario.gravity == Gravity::Down(1.0),
            || inside.clone(),
            "used with another gravity than 1",
            "only unit gravity down the last axis is allowed: it is filled under it",
        )?;
        let volume = 4.0 * drum.radius * drum.radius * drum_of.length();
        self.require(
            volume <= MOST_GRAINS as f64,
            || inside.clone(),
            format!("a drum of {volume:.0} d³"),
            "at most 10000000 grains are allowed",
        )?;
        if self.scenario.axes() == 2 {
            return Ok(());
        }
        let length = drum_of.length();
        let fits = match self.scenario.side(1) {
            Side::Periodic {
                origin,
                length: period,
            } => origin == 0.0 && (period - length).abs() <= 1.0e-9,
            Side::Open | Side::Walls { .. } => false,
        };
        let allowed = format!("for it boundaries[1] has to be periodic with length {length}");
        self.require(fits, || inside.clone(), "used without its period", &allowed)
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
        sizes
            .validated()
            .map_err(|error| self.origin.refuse_part(path.clone(), error))?;
        let (least, most) = (sizes.smallest(), sizes.largest());
        let holds = least >= 1.0e-6 && most <= 1.0e6;
        let found = format!("between {least} and {most}");
        let allowed = "diameters from 1e-6 to 1e6 are allowed";
        self.require(holds, || path, found, allowed)
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
