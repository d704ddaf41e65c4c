//! The command `analyse`: what can be measured on the frames of a run.

mod arguments;
mod density;
mod finding;
mod frames;
mod motion;
mod replay;
mod structure;
mod transfer;

pub(super) use arguments::AnalyseArguments;

use std::fs;

use crate::analysis::Bins;
use crate::output::Frame;
use crate::program::analyse::arguments::{Axis, Subject, axis_name};
use crate::program::analyse::finding::Finding;
use crate::program::analyse::frames::{Sample, extent, paths, read};
use crate::program::error::ProgramError;
use crate::program::show::say;
use crate::time::Time;

/// What is to be measured on which frames.
struct Task<'a, const D: usize> {
    /// The run or file, for messages.
    name: String,
    options: &'a AnalyseArguments,
    samples: &'a [Sample<D>],
    /// The last frame's time, of all that are there.
    end: Time,
    again: &'a transfer::Again<D>,
}

impl<const D: usize> Task<'_, D> {
    /// An axis that these frames have.
    fn known(&self, axis: Axis, option: &str) -> Result<usize, ProgramError> {
        if axis.index() < D {
            return Ok(axis.index());
        }
        Err(ProgramError::NotAnalysed {
            run: self.name.clone(),
            reason: format!(
                "{option} is {}, and its frames have {D} dimensions: x and y",
                axis_name(axis.index())
            ),
        })
    }

    /// The axis that bins follow.
    fn axis(&self) -> Result<usize, ProgramError> {
        match self.options.axis {
            Some(axis) => self.known(axis, "--axis"),
            None => Ok(D - 1),
        }
    }

    /// The horizontal axis.
    fn across(&self) -> Result<usize, ProgramError> {
        let axis = self.known(self.options.across, "--across")?;
        if axis + 1 < D {
            return Ok(axis);
        }
        Err(ProgramError::NotAnalysed {
            run: self.name.clone(),
            reason: format!("--across is {}, which is up", axis_name(axis)),
        })
    }

    /// The component of velocities.
    fn component(&self) -> Result<usize, ProgramError> {
        match self.options.component {
            Some(axis) => self.known(axis, "--component"),
            None => self.across(),
        }
    }

    /// Where to look on an axis, if that was said.
    fn slab(&self, axis: usize) -> Option<(f64, f64)> {
        let of_axis = |slab: &&arguments::Slab| slab.axis.index() == axis;
        let slab = self.options.slab.iter().rfind(of_axis)?;
        Some((slab.low, slab.high))
    }

    fn extent(&self, axis: usize) -> Result<(f64, f64), ProgramError> {
        extent(self.samples, axis).ok_or_else(|| ProgramError::NotAnalysed {
            run: self.name.clone(),
            reason: "no grain has landed in these frames".to_owned(),
        })
    }

    /// The bins along an axis: as many as were asked for, else about so many a
    /// diameter.
    fn bins(&self, axis: usize, each: f64) -> Result<Bins, ProgramError> {
        let (low, high) = self.extent(axis)?;
        match self.options.bins {
            Some(count) => Ok(Bins::new(low, high, count as usize)?),
            None => Ok(Bins::of_width(low, high, 1.0 / each)?),
        }
    }

    fn measure(&self, subject: Subject) -> Result<Finding, ProgramError> {
        match subject {
            Subject::Profile => density::profile(self),
            Subject::Map => density::map(self),
            Subject::Rdf => structure::rdf(self),
            Subject::Contacts => structure::count(self),
            Subject::Fabric => structure::tensor(self),
            Subject::Velocity => motion::velocity(self),
            Subject::Temperature => motion::temperature(self),
            Subject::Angle => density::angle(self),
            Subject::Msd | Subject::All => motion::msd(self),
            Subject::Stress => transfer::stress(self, self.again),
            Subject::Force => transfer::force(self, self.again),
        }
    }
}

/// Measures what was asked for and writes it down.
pub(super) fn analyse(arguments: &AnalyseArguments) -> Result<u8, ProgramError> {
    let (file, out) = paths(&arguments.run, arguments.out.as_ref())?;
    let name = arguments.run.display().to_string();
    let window = (
        arguments.from.unwrap_or(f64::NEG_INFINITY),
        arguments.to.unwrap_or(f64::INFINITY),
    );
    let (frames, count, end) = read(&file, window)?;
    let refuse = |reason: String| {
        Err(ProgramError::NotAnalysed {
            run: name.clone(),
            reason,
        })
    };
    let Some(first) = frames.first() else {
        return match count {
            0 => refuse("there are no frames in it".to_owned()),
            _ => refuse(format!(
                "none of its {count} frames is within --from and --to"
            )),
        };
    };
    if let Some(other) = frames
        .iter()
        .find(|frame| frame.dimension != first.dimension)
    {
        return refuse(format!(
            "its frames have {} and {} dimensions",
            first.dimension, other.dimension
        ));
    }
    let findings = match first.dimension {
        2 => measured::<2>(arguments, &name, &frames, end)?,
        _ => measured::<3>(arguments, &name, &frames, end)?,
    };
    fs::create_dir_all(&out).map_err(ProgramError::io(out.display().to_string()))?;
    for finding in &findings {
        finding.write(&out)?;
    }
    say(&told(&name, &frames, &findings, &out.display().to_string())).map(|()| 0)
}

/// Carries out all that was asked for. Of `all`, what these frames do not allow
/// is told and left out.
fn measured<const D: usize>(
    arguments: &AnalyseArguments,
    name: &str,
    frames: &[Frame],
    end: Time,
) -> Result<Vec<Finding>, ProgramError> {
    let samples = frames
        .iter()
        .map(Sample::<D>::of)
        .collect::<Result<Vec<_>, _>>()?;
    let all = arguments.subjects.is_empty() || arguments.subjects.contains(&Subject::All);
    let mut subjects = arguments.subjects.clone();
    if all {
        subjects.extend(Subject::EACH);
        subjects.retain(|subject| *subject != Subject::All);
    }
    subjects.sort_unstable();
    subjects.dedup();
    let windowed = arguments.from.is_some() || arguments.to.is_some();
    let again = transfer::Again::new();
    let mut findings = Vec::new();
    for subject in subjects {
        let last_only = subject.is_of_one_frame() && !windowed;
        let begin = if last_only { samples.len() - 1 } else { 0 };
        let task = Task {
            name: name.to_owned(),
            options: arguments,
            samples: &samples[begin..],
            end,
            again: &again,
        };
        match task.measure(subject) {
            Ok(finding) => findings.push(finding),
            Err(error) if all => eprintln!("note: no {}: {error}", subject.name()),
            Err(error) => return Err(error),
        }
    }
    Ok(findings)
}

/// What is printed.
fn told(name: &str, frames: &[Frame], findings: &[Finding], out: &str) -> String {
    let times = match frames {
        [only] => format!("1 frame at t = {:.4}", only.time.units()),
        [first, .., last] => format!(
            "{} frames, t = {:.4} to {:.4}",
            frames.len(),
            first.time.units(),
            last.time.units()
        ),
        [] => "no frames".to_owned(),
    };
    let grains = frames.last().map_or(0, |frame| frame.grains.len());
    let mut text = format!("{name}: {times}; {grains} grains\n");
    for finding in findings {
        for (number, words) in finding.words.iter().enumerate() {
            let title = if number == 0 { finding.name } else { "" };
            text += &format!("  {title:<12} {words}\n");
        }
    }
    let names: Vec<&str> = findings.iter().map(|finding| finding.name).collect();
    match names[..] {
        [] => text += "nothing could be measured",
        _ => text += &format!("written to {out}: {} (.csv, .svg)", names.join(", ")),
    }
    text
}
