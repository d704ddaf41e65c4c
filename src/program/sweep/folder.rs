//! The folder of a sweep.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use toml::{Table, Value};

use crate::output::{FolderError, RunFolder, lock, names_in, write_atomically};
use crate::program::error::ProgramError;
use crate::program::sweep::error::SweepError;
use crate::program::sweep::names::shortened;

const SWEEP: &str = "sweep.toml";
const RUNS: &str = "runs.csv";

/// So many differences are told.
const MOST_DIFFERENCES: usize = 8;

/// The folder of a sweep; no other process writes to it as long as this is
/// there.
pub(super) struct SweepFolder {
    path: PathBuf,
    _lock: File,
}

/// What is there.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Found {
    /// Nothing that is to be kept.
    Nothing,
    /// The same sweep.
    Same,
}

impl SweepFolder {
    /// The folder of the sweep that `text` describes, new or to be gone on
    /// with. `force` begins anew, whatever is there.
    pub(super) fn open(path: &Path, text: &str, force: bool) -> Result<Self, ProgramError> {
        look(path, text, force)?;
        let io = || ProgramError::io(path.display().to_string());
        fs::create_dir_all(path).map_err(io())?;
        let folder = SweepFolder {
            path: path.to_path_buf(),
            _lock: lock(path, SWEEP)?,
        };
        // Another process may have begun one just now.
        if look(path, text, force)? == Found::Nothing {
            folder.clear()?;
            folder.write(SWEEP, text.as_bytes())?;
        }
        Ok(folder)
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Replaces `runs.csv`.
    pub(super) fn write_runs(&self, text: &[u8]) -> Result<(), ProgramError> {
        self.write(RUNS, text)
    }

    fn write(&self, name: &str, text: &[u8]) -> Result<(), ProgramError> {
        let file = self.path.join(name);
        write_atomically(&file, text).map_err(ProgramError::io(file.display().to_string()))
    }

    /// Takes an earlier sweep away; other files stay, as do folders in which
    /// there are any.
    fn clear(&self) -> Result<(), ProgramError> {
        let io = |path: &Path| ProgramError::io(path.display().to_string());
        let names = names_in(&self.path).map_err(io(&self.path))?;
        let runs = names.iter().filter(|name| is_a_run(name));
        let runs: Vec<PathBuf> = runs
            .map(|name| self.path.join(name))
            .filter(|path| path.is_dir())
            .collect();
        // None may be going on, or none is touched.
        for run in &runs {
            lock(run, "scenario.toml")?;
        }
        for name in [SWEEP, RUNS] {
            let file = self.path.join(name);
            match fs::remove_file(&file) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => {
                    return Err(io(&file)(error));
                }
                _ => {}
            }
        }
        for run in &runs {
            RunFolder::create(run, true)?;
            // Unless something else is in it.
            let _ = fs::remove_dir(run);
        }
        Ok(())
    }
}

/// Whether a folder of this name is that of a run of a sweep.
fn is_a_run(name: &str) -> bool {
    name.rsplit_once("seed=").is_some_and(|(before, seed)| {
        (before.is_empty() || before.ends_with('_'))
            && !seed.is_empty()
            && seed.bytes().all(|digit| digit.is_ascii_digit())
    })
}

/// Sees whether a sweep may be written to `path`, and changes nothing.
fn look(path: &Path, text: &str, force: bool) -> Result<Found, ProgramError> {
    let folder = path.display().to_string();
    let names = match names_in(path) {
        Ok(names) => names,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Found::Nothing),
        Err(error) if error.kind() == io::ErrorKind::NotADirectory => {
            return Err(FolderError::NoFolder { folder }.into());
        }
        Err(error) => return Err(ProgramError::io(folder)(error)),
    };
    let part = format!("{SWEEP}.part");
    let mut names = names.into_iter().filter(|name| *name != part).peekable();
    if force || names.peek().is_none() {
        return Ok(Found::Nothing);
    }
    let file = path.join(SWEEP);
    match fs::read_to_string(&file) {
        Ok(found) => compare(path, &found, text),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            let found = names.next().unwrap_or_default();
            Err(FolderError::Occupied { folder, found }.into())
        }
        Err(error) => Err(ProgramError::io(file.display().to_string())(error)),
    }
}

/// Whether two texts describe the same sweep.
fn compare(path: &Path, found: &str, wanted: &str) -> Result<Found, ProgramError> {
    let read = |text: &str| {
        toml::from_str::<Table>(text).map_err(|error| SweepError::Unreadable {
            file: path.join(SWEEP).display().to_string(),
            reason: error.message().to_owned(),
        })
    };
    let mut all = Vec::new();
    let (found, wanted) = (read(found)?, read(wanted)?);
    differences("", &Value::Table(found), &Value::Table(wanted), &mut all);
    if all.is_empty() {
        return Ok(Found::Same);
    }
    let mut lines: String = all
        .iter()
        .take(MOST_DIFFERENCES)
        .map(|line| format!("\n  {line}"))
        .collect();
    if let more @ 1.. = all.len().saturating_sub(MOST_DIFFERENCES) {
        lines += &format!("\n  … and {more} more");
    }
    Err(SweepError::OtherSweep {
        folder: path.display().to_string(),
        differences: lines,
    }
    .into())
}

/// Adds a line for each value that differs.
fn differences(at: &str, there: &Value, here: &Value, lines: &mut Vec<String>) {
    match (there, here) {
        (Value::Table(there), Value::Table(here)) => {
            let more = here.keys().filter(|key| !there.contains_key(*key));
            for key in there.keys().chain(more) {
                let inside = if at.is_empty() {
                    key.clone()
                } else {
                    format!("{at}.{key}")
                };
                match (there.get(key), here.get(key)) {
                    (Some(there), Some(here)) => differences(&inside, there, here, lines),
                    (there, here) => lines.push(line(&inside, there, here)),
                }
            }
        }
        (Value::Array(there), Value::Array(here)) if of_tables(there) && of_tables(here) => {
            for index in 0..there.len().max(here.len()) {
                let inside = format!("{at}[{index}]");
                match (there.get(index), here.get(index)) {
                    (Some(there), Some(here)) => differences(&inside, there, here, lines),
                    (there, here) => lines.push(line(&inside, there, here)),
                }
            }
        }
        _ if there == here => {}
        _ => lines.push(line(at, Some(there), Some(here))),
    }
}

fn of_tables(list: &[Value]) -> bool {
    list.iter().all(Value::is_table)
}

fn line(at: &str, there: Option<&Value>, here: Option<&Value>) -> String {
    let shown = |value: Option<&Value>| match value {
        Some(value) => shortened(&value.to_string(), 100),
        None => "nothing".to_owned(),
    };
    format!("{at}: {} there, {} here", shown(there), shown(here))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_told_by_their_place() {
        let there = "a = 1\nb = [1, 2]\nc.d = 3\n[[set]]\nv = [1]\n[[set]]\nv = [2]\n";
        let here = "a = 1\nb = [1, 3]\nc.e = 3\n[[set]]\nv = [5]\n";
        let mut lines = Vec::new();
        let read = |text: &str| Value::Table(toml::from_str(text).unwrap());
        differences("", &read(there), &read(here), &mut lines);
        assert_eq!(
            lines,
            [
                "b: [1, 2] there, [1, 3] here",
                "c.d: 3 there, nothing here",
                "c.e: nothing there, 3 here",
                "set[0].v: [1] there, [5] here",
                "set[1]: { v = [2] } there, nothing here",
            ]
        );
    }

    #[test]
    fn runs_are_known_by_their_names() {
        for name in ["seed=1", "sleep_speed=0.05_seed=12"] {
            assert!(is_a_run(name), "{name}");
        }
        for name in ["seed=", "a_seed=1x", "linseed=3", "runs.csv", "pictures"] {
            assert!(!is_a_run(name), "{name}");
        }
    }
}
