//! `grainfall validate`: known physics, measured and judged.

mod barometer;
mod bounces;
mod check;
mod cooling;
mod diffusion;
mod effort;
mod fluid;
mod maxwell;
mod pressure;
mod table;

use std::fs::{self, OpenOptions};
use std::path::Path;

use serde::Serialize;

use crate::error::SetupError;
use crate::program::cli::ValidateArguments;
use crate::program::error::ProgramError;
use crate::program::processor::ProcessorClock;
use crate::program::show::say;
use crate::program::validate::check::{Check, Verdict};
use crate::program::validate::effort::Effort;

/// One subject of known physics.
struct Subject {
    name: &'static str,
    summary: &'static str,
    checks: fn(Effort) -> Result<Vec<Check>, SetupError>,
}

static SUBJECTS: [Subject; 7] = [
    Subject {
        name: "spheres",
        summary: "pressure and collision rate of elastic spheres",
        checks: pressure::spheres,
    },
    Subject {
        name: "disks",
        summary: "pressure and collision rate of elastic disks",
        checks: pressure::disks,
    },
    Subject {
        name: "maxwell",
        summary: "distribution of velocities of elastic spheres",
        checks: maxwell::checks,
    },
    Subject {
        name: "cooling",
        summary: "Haff's law of inelastic spheres and disks",
        checks: cooling::checks,
    },
    Subject {
        name: "barometer",
        summary: "density of an elastic gas on a floor under gravity",
        checks: barometer::checks,
    },
    Subject {
        name: "bounces",
        summary: "times of a bouncing ball",
        checks: bounces::checks,
    },
    Subject {
        name: "diffusion",
        summary: "self-diffusion of elastic spheres",
        checks: diffusion::checks,
    },
];

/// What a subject gave.
#[derive(Serialize)]
struct Outcome {
    subject: &'static str,
    summary: &'static str,
    /// Processor time, in seconds.
    seconds: f64,
    checks: Vec<Check>,
}

impl Outcome {
    fn count(&self, verdict: Verdict) -> usize {
        let with = self.checks.iter().filter(|check| check.verdict == verdict);
        with.count()
    }
}

pub(super) fn validate(arguments: &ValidateArguments) -> Result<u8, ProgramError> {
    let effort = if arguments.quick {
        Effort::Quick
    } else {
        Effort::Full
    };
    let subjects = chosen(&arguments.subjects)?;
    if let Some(file) = &arguments.out {
        // Before hours are spent on what can't be written.
        let opened = OpenOptions::new().create(true).append(true).open(file);
        opened.map_err(ProgramError::io(file.display().to_string()))?;
    }
    let mut outcomes = Vec::new();
    for subject in subjects {
        let clock = ProcessorClock::start();
        let checks = (subject.checks)(effort)?;
        let outcome = Outcome {
            subject: subject.name,
            summary: subject.summary,
            seconds: clock.seconds(),
            checks,
        };
        say(&table::of(&outcome))?;
        outcomes.push(outcome);
    }
    if let Some(file) = &arguments.out {
        write(file, &outcomes)?;
    }
    let total = |verdict| outcomes.iter().map(|o| o.count(verdict)).sum::<usize>();
    let failed = total(Verdict::Fail);
    say(&format!(
        "{} passed, {failed} failed; {:.0} s of processor time",
        total(Verdict::Pass),
        outcomes.iter().map(|o| o.seconds).sum::<f64>()
    ))?;
    Ok(u8::from(failed > 0))
}

/// The subjects with these names, in the order of the list; all, if none is
/// named.
fn chosen(names: &[String]) -> Result<Vec<&'static Subject>, ProgramError> {
    for name in names {
        if !SUBJECTS.iter().any(|subject| subject.name == name) {
            let known: Vec<&str> = SUBJECTS.iter().map(|subject| subject.name).collect();
            return Err(ProgramError::UnknownSubject {
                name: name.clone(),
                known: known.join(", "),
            });
        }
    }
    let wanted = |subject: &&Subject| names.is_empty() || names.iter().any(|n| n == subject.name);
    Ok(SUBJECTS.iter().filter(wanted).collect())
}

fn write(file: &Path, outcomes: &[Outcome]) -> Result<(), ProgramError> {
    let failed = |error| ProgramError::io(file.display().to_string())(error);
    let text = serde_json::to_string_pretty(outcomes)
        .map_err(|error| failed(std::io::Error::other(error)))?;
    fs::write(file, text + "\n").map_err(failed)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The short version of a subject, which has to pass.
    fn short(name: &str) {
        let subject = SUBJECTS.iter().find(|s| s.name == name).unwrap();
        let outcome = Outcome {
            subject: subject.name,
            summary: subject.summary,
            seconds: 0.0,
            checks: (subject.checks)(Effort::Short).unwrap(),
        };
        let text = table::of(&outcome);
        println!("{text}");
        assert!(outcome.count(Verdict::Pass) > 0);
        assert_eq!(outcome.count(Verdict::Fail), 0, "{text}");
    }

    #[test]
    fn spheres() {
        short("spheres");
    }

    #[test]
    fn disks() {
        short("disks");
    }

    #[test]
    fn maxwell() {
        short("maxwell");
    }

    #[test]
    fn cooling() {
        short("cooling");
    }

    #[test]
    fn barometer() {
        short("barometer");
    }

    #[test]
    fn bounces() {
        short("bounces");
    }

    #[test]
    fn diffusion() {
        short("diffusion");
    }

    #[test]
    fn unknown_subjects_are_refused() {
        let names = ["spheres".to_owned(), "sphere".to_owned()];
        assert!(chosen(&names).is_err());
        assert_eq!(chosen(&names[..1]).unwrap().len(), 1);
        assert_eq!(chosen(&[]).unwrap().len(), SUBJECTS.len());
    }
}
