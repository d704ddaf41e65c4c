//! The frames that are analysed.

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use crate::analysis::{Container, highest_surface, lowest_surface};
use crate::dynamics::TurningGround;
use crate::output::{Frame, XyzError, XyzReader};
use crate::particle::{Mode, Particle, Vector};
use crate::program::error::ProgramError;
use crate::scenario::{Turns, read as read_scenario};
use crate::time::Time;

/// All grains at an instant, and the box.
#[derive(Clone, Debug)]
pub(super) struct Sample<const D: usize> {
    pub(super) time: Time,
    pub(super) container: Container<D>,
    pub(super) grains: Vec<Particle<D>>,
}

impl<const D: usize> Sample<D> {
    pub(super) fn of(frame: &Frame) -> Result<Self, ProgramError> {
        let part = |values: &[f64; 3]| Vector::<D>::from_fn(|axis, _| values[axis]);
        let periodic = std::array::from_fn(|axis| frame.periodic[axis]);
        Ok(Sample {
            time: frame.time,
            container: Container::new(part(&frame.origin), part(&frame.lengths), periodic)?,
            grains: frame.particles(),
        })
    }
}

/// Grains that are part of the heap or of what flows: not of the rain.
pub(super) fn has_landed<const D: usize>(grain: &Particle<D>) -> bool {
    grain.mode != Mode::Falling
}

/// Grains that have landed and are not of the base or the walls.
pub(super) fn is_free<const D: usize>(grain: &Particle<D>) -> bool {
    has_landed(grain) && grain.mode != Mode::Fixed
}

/// From where to where an axis is of interest in all these samples: the period,
/// or as far as the surfaces of grains that have landed reach.
pub(super) fn extent<const D: usize>(samples: &[Sample<D>], axis: usize) -> Option<(f64, f64)> {
    let of_one = |sample: &Sample<D>| {
        if sample.container.periodic[axis] {
            return Some(sample.container.faces(axis));
        }
        let landed = || sample.grains.iter().filter(|grain| has_landed(grain));
        // The two functions look along the last axis.
        let turned: Vec<Particle<D>> = landed()
            .map(|grain| {
                let mut turned = *grain;
                turned.position[D - 1] = grain.position[axis];
                turned
            })
            .collect();
        lowest_surface(&turned).zip(highest_surface(&turned))
    };
    samples
        .iter()
        .filter_map(of_one)
        .reduce(|one, other| (one.0.min(other.0), one.1.max(other.1)))
}

/// The ground of the run that a folder holds, if it turns.
pub(super) fn turning_ground<const D: usize>(
    run: &Path,
) -> Result<Option<TurningGround<D>>, ProgramError> {
    let file = run.join("scenario.toml");
    if !file.is_file() {
        return Ok(None);
    }
    let (_, scenario) = read_scenario(&file, Vec::new())?;
    let turns = scenario.rotation.filter(|turns| turns.of == Turns::Ground);
    let nothing = Vector::zeros();
    Ok(turns.map(|turns| TurningGround::new(nothing, turns.angular_velocity, [0, D - 1], nothing)))
}

/// The file of frames of a run, and where what is made of them goes.
pub(super) fn paths(run: &Path, out: Option<&PathBuf>) -> Result<(PathBuf, PathBuf), ProgramError> {
    let refuse = |reason: &str| {
        Err(ProgramError::NotAnalysed {
            run: run.display().to_string(),
            reason: reason.to_owned(),
        })
    };
    if run.is_dir() {
        let frames = run.join("frames.xyz");
        if run.join("sweep.toml").is_file() {
            return refuse("it is the folder of a sweep; analyse one of the runs in it");
        }
        if !frames.is_file() {
            return refuse("there is no frames.xyz in it");
        }
        let out = out.cloned().unwrap_or_else(|| run.join("analysis"));
        return Ok((frames, out));
    }
    if !run.exists() {
        return refuse("there is no such folder or file");
    }
    let out = out
        .cloned()
        .unwrap_or_else(|| run.with_file_name("analysis"));
    Ok((run.to_path_buf(), out))
}

/// Reads the frames between two times; says how many there are in all, and the
/// latest time.
pub(super) fn read(
    file: &Path,
    (from, to): (f64, f64),
) -> Result<(Vec<Frame>, usize, Time), ProgramError> {
    let name = file.display().to_string();
    let opened = File::open(file).map_err(ProgramError::io(name.clone()))?;
    let (mut kept, mut count, mut end) = (Vec::new(), 0, Time::ZERO);
    for frame in XyzReader::new(BufReader::new(opened)) {
        let frame = frame.map_err(|source| match source {
            XyzError::Io(source) => ProgramError::Io {
                file: name.clone(),
                source,
            },
            source => ProgramError::Frames {
                file: name.clone(),
                source,
            },
        })?;
        count += 1;
        end = end.max(frame.time);
        if (from..=to).contains(&frame.time.units()) {
            kept.push(frame);
        }
    }
    Ok((kept, count, end))
}
