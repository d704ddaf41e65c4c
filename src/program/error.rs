use std::io;

use crate::analysis::AnalysisError;
use crate::error::SetupError;
use crate::output::{FolderError, XyzError};
use crate::plot::PlotError;
use crate::program::sweep::SweepError;
use crate::scenario::{Refusal, ScenarioError};

/// Why a command could not be carried out.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ProgramError {
    /// The scenario can't be read or is refused.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// There is neither a preset nor a file of this name.
    #[error("there is no preset and no file `{name}`{hint}")]
    UnknownScenario {
        /// The name.
        name: String,
        /// What may have been meant, as the rest of the message.
        hint: String,
    },
    /// The run folder can't be had.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// Something else can't be read or written.
    #[error("cannot access {file}: {source}")]
    Io {
        /// What.
        file: String,
        /// Why.
        source: io::Error,
    },
    /// There is no subject of validation of this name.
    #[error("there is no subject `{name}` to validate; there are {known}")]
    UnknownSubject {
        /// The name.
        name: String,
        /// Those that there are.
        known: String,
    },
    /// So many grains don't fill a crystal.
    #[error(
        "count is {count}; a crystal has 4 k³ grains: {below} and {above} are nearest; any number \
         is allowed with --start fluid"
    )]
    CrystalCount {
        /// How many there were to be.
        count: usize,
        /// The next smaller number.
        below: usize,
        /// The next larger one.
        above: usize,
    },
    /// A system for a validation or a measurement can't be set up.
    #[error("the system can't be set up: {0}")]
    SetUp(#[from] SetupError),
    /// A list of criteria that is none.
    #[error("`{policies}` is no list of criteria; write their names with commas between them")]
    Policies {
        /// The list.
        policies: String,
    },
    /// A run has no grain of this name.
    #[error("{folder} has no grain {particle} at that time; grains are counted from 0")]
    NoGrain {
        /// The name.
        particle: u32,
        /// The run.
        folder: String,
    },
    /// None of the checkpoints of a run can be used.
    #[error("{folder} cannot be resumed:{reasons}\n{advice}")]
    Unresumable {
        /// The folder.
        folder: String,
        /// A line for each checkpoint.
        reasons: String,
        /// What to do.
        advice: String,
    },
    /// A run could not be carried on with.
    #[error(
        "{source}\nonce that is put right, `grainfall resume {folder}` goes on from the last checkpoint"
    )]
    Stopped {
        /// Why.
        source: Box<ProgramError>,
        /// Its folder.
        folder: String,
    },
    /// Runs can't be carried out together.
    #[error(transparent)]
    Sweep(#[from] SweepError),
    /// One of many runs is refused.
    #[error("{source}\n  where {combination}")]
    Combination {
        /// Why.
        source: Box<ProgramError>,
        /// Its values.
        combination: String,
    },
    /// A file of frames can't be read.
    #[error("{file}: {source}")]
    Frames {
        /// Which.
        file: String,
        /// Why.
        source: XyzError,
    },
    /// What was asked for can't be measured on this run.
    #[error("{run} cannot be analysed: {reason}")]
    NotAnalysed {
        /// The run, or the file of frames.
        run: String,
        /// Why.
        reason: String,
    },
    /// A measurement is refused.
    #[error(transparent)]
    Analysis(#[from] AnalysisError),
    /// A figure of the paper can't be made again.
    #[error("this can't be reproduced: {what}")]
    Reproduction {
        /// What is missing or wrong.
        what: String,
    },
    /// A plot can't be drawn.
    #[error(transparent)]
    Plot(#[from] PlotError),
}

impl ProgramError {
    /// The exit code of the process: 1 if input or output failed, 2 if the
    /// input is refused.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            ProgramError::Stopped { source, .. } | ProgramError::Combination { source, .. } => {
                source.exit_code()
            }
            ProgramError::Scenario(ScenarioError::Unreadable { .. })
            | ProgramError::Folder(FolderError::Io { .. })
            | ProgramError::Io { .. }
            | ProgramError::Frames {
                source: XyzError::Io(_),
                ..
            } => 1,
            ProgramError::Scenario(ScenarioError::Refused(_))
            | ProgramError::UnknownScenario { .. }
            | ProgramError::UnknownSubject { .. }
            | ProgramError::CrystalCount { .. }
            | ProgramError::SetUp(_)
            | ProgramError::NoGrain { .. }
            | ProgramError::Policies { .. }
            | ProgramError::Unresumable { .. }
            | ProgramError::Reproduction { .. }
            | ProgramError::Sweep(_)
            | ProgramError::NotAnalysed { .. }
            | ProgramError::Analysis(_)
            | ProgramError::Plot(_)
            | ProgramError::Folder(_)
            | ProgramError::Frames { .. } => 2,
        }
    }

    pub(super) fn io(file: impl Into<String>) -> impl FnOnce(io::Error) -> Self {
        let file = file.into();
        |source| ProgramError::Io { file, source }
    }
}

impl From<Refusal> for ProgramError {
    fn from(refusal: Refusal) -> Self {
        ProgramError::Scenario(refusal.into())
    }
}
