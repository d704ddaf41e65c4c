//! The runs that figures are made from, each in a folder of its own.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use serde::Deserialize;

use crate::output::{Frame, Summary, XyzError, XyzReader};
use crate::program::criteria::Program;
use crate::program::error::ProgramError;
use crate::program::load::open;
use crate::program::reproduce::assigned;
use crate::program::run::seed_is;
use crate::program::sweep::Tasks;
use crate::scenario::{Origin, Scenario, read_text};

/// A preset with some values changed.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RunSpec {
    /// The name of its folder.
    pub(super) name: String,
    pub(super) preset: &'static str,
    pub(super) seed: u64,
    /// As after `--set`.
    pub(super) set: Vec<String>,
}

impl RunSpec {
    fn scenario(&self, program: &Program) -> Result<(Origin, Scenario), ProgramError> {
        let (_, mut origin) = open(self.preset, program)?;
        origin.assignments = assigned(&self.set)?;
        origin.assignments.push(seed_is(self.seed));
        let scenario = read_text(&origin)?;
        Ok((origin, scenario))
    }
}

/// All runs of some figures, none twice.
pub(super) struct RunList<'a> {
    program: &'a Program,
    runs: Vec<RunSpec>,
}

impl<'a> RunList<'a> {
    pub(super) fn new(program: &'a Program) -> Self {
        RunList {
            program,
            runs: Vec::new(),
        }
    }

    pub(super) fn program(&self) -> &'a Program {
        self.program
    }

    pub(super) fn add(&mut self, run: RunSpec) {
        if !self.runs.contains(&run) {
            self.runs.push(run);
        }
    }
}

impl Tasks for RunList<'_> {
    fn runs(&self) -> usize {
        self.runs.len()
    }

    fn folder_of(&self, run: usize) -> String {
        self.runs[run].name.clone()
    }

    fn scenario_of(&self, run: usize) -> Result<(Origin, Scenario), ProgramError> {
        self.runs[run].scenario(self.program)
    }
}

/// A row of `series.csv`, as far as figures want it.
#[derive(Clone, Copy, Debug, Deserialize)]
pub(super) struct SeriesRow {
    pub(super) time: f64,
    pub(super) normal: f64,
    pub(super) frozen: f64,
}

/// What runs have left.
pub(super) struct Finished<'a> {
    /// Where the folders of the runs stand.
    pub(super) folder: &'a Path,
}

impl Finished<'_> {
    /// How a run ended.
    pub(super) fn summary(&self, run: &RunSpec) -> Result<Summary, ProgramError> {
        Summary::of(&self.folder.join(&run.name)).map_err(|error| ProgramError::Reproduction {
            what: format!(
                "the run {} has left no summary that can be read: {error}",
                run.name
            ),
        })
    }

    /// Counts over time.
    pub(super) fn series(&self, run: &RunSpec) -> Result<Vec<SeriesRow>, ProgramError> {
        let path = self.folder.join(&run.name).join("series.csv");
        let name = path.display().to_string();
        let table = csv::Reader::from_path(&path);
        let rows = table.and_then(|mut table| table.deserialize().collect::<Result<_, _>>());
        rows.map_err(|error| ProgramError::io(name)(error.into()))
    }

    /// All frames, by time.
    pub(super) fn frames(&self, run: &RunSpec) -> Result<Vec<Frame>, ProgramError> {
        let path = self.folder.join(&run.name).join("frames.xyz");
        let name = path.display().to_string();
        let file = File::open(&path).map_err(ProgramError::io(name.clone()))?;
        let frames: Result<Vec<Frame>, XyzError> = XyzReader::new(BufReader::new(file)).collect();
        frames.map_err(|source| ProgramError::Frames { file: name, source })
    }
}
