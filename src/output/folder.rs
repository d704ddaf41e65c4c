use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// True for the names of files that a run, or a picture of it, leaves behind.
fn is_of_a_run(name: &str) -> bool {
    let input = name
        .strip_prefix("input-")
        .and_then(|rest| rest.strip_suffix(".xyz"))
        .is_some_and(|number| number.bytes().all(|byte| byte.is_ascii_digit()));
    input
        || [
            "scenario.toml",
            "summary.json",
            "series.csv",
            "frames.xyz",
            "events.csv",
            "picture.svg",
        ]
        .contains(&name)
}

/// Why a run folder can't be had.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FolderError {
    /// Something is there already.
    #[error("{folder} already holds {found}; choose another --out, or --force to overwrite it")]
    Occupied {
        /// The folder.
        folder: String,
        /// What is in it.
        found: String,
    },
    /// Something else is there under that name.
    #[error("{folder} is no folder; choose another --out")]
    NoFolder {
        /// The name.
        folder: String,
    },
    /// A file or the folder can't be written.
    #[error("cannot write {file}: {source}")]
    Io {
        /// Which.
        file: String,
        /// Why.
        source: io::Error,
    },
}

/// The folder of one run.
#[derive(Clone, Debug)]
pub struct RunFolder {
    path: PathBuf,
}

impl RunFolder {
    /// Sees whether a run may be written to `path`, and changes nothing: the
    /// folder must not be there or be empty, unless `force` allows to overwrite
    /// an earlier run.
    ///
    /// # Errors
    ///
    /// When it may not.
    pub fn check(path: &Path, force: bool) -> Result<(), FolderError> {
        let folder = path.display().to_string();
        let names = match names_in(path) {
            Ok(names) => names,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
            Err(error) if error.kind() == io::ErrorKind::NotADirectory => {
                return Err(FolderError::NoFolder { folder });
            }
            Err(source) => {
                return Err(FolderError::Io {
                    file: folder,
                    source,
                });
            }
        };
        match names.into_iter().next() {
            Some(found) if !force => Err(FolderError::Occupied { folder, found }),
            _ => Ok(()),
        }
    }

    /// Makes the folder, and takes the files of an earlier run out of it; other
    /// files stay.
    ///
    /// # Errors
    ///
    /// As [`RunFolder::check`], and when the folder can't be made.
    pub fn create(path: &Path, force: bool) -> Result<Self, FolderError> {
        RunFolder::check(path, force)?;
        let folder = RunFolder {
            path: path.to_path_buf(),
        };
        let failed = |file: &Path, source| FolderError::Io {
            file: file.display().to_string(),
            source,
        };
        fs::create_dir_all(path).map_err(|error| failed(path, error))?;
        for name in names_in(path).map_err(|error| failed(path, error))? {
            let file = folder.file(&name);
            if is_of_a_run(&name) {
                fs::remove_file(&file).map_err(|error| failed(&file, error))?;
            }
        }
        Ok(folder)
    }

    /// Where it is.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The path of a file in it.
    #[must_use]
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// A new file in it, without a buffer.
    ///
    /// # Errors
    ///
    /// When the file can't be made.
    pub fn create_file(&self, name: &str) -> Result<File, FolderError> {
        let file = self.file(name);
        File::create(&file).map_err(|source| FolderError::Io {
            file: file.display().to_string(),
            source,
        })
    }

    /// Writes a whole file, so that it is there complete or not at all.
    ///
    /// # Errors
    ///
    /// When it can't be written.
    pub fn write(&self, name: &str, text: &[u8]) -> Result<(), FolderError> {
        let file = self.file(name);
        write_atomically(&file, text).map_err(|source| FolderError::Io {
            file: file.display().to_string(),
            source,
        })
    }
}

/// The names of everything in a folder, in order.
fn names_in(path: &Path) -> io::Result<Vec<String>> {
    let mut names = fs::read_dir(path)?
        .map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()))
        .collect::<io::Result<Vec<String>>>()?;
    names.sort();
    Ok(names)
}

/// Writes a whole file, so that it is there complete or not at all: under
/// another name first.
///
/// # Errors
///
/// When it can't be written.
pub fn write_atomically(file: &Path, text: &[u8]) -> io::Result<()> {
    let mut name = file.file_name().unwrap_or_default().to_os_string();
    name.push(".part");
    let part = file.with_file_name(name);
    let written = File::create(&part).and_then(|mut out| {
        out.write_all(text)?;
        out.sync_all()
    });
    match written.and_then(|()| fs::rename(&part, file)) {
        Ok(()) => Ok(()),
        Err(error) => {
            // The first error is the one to tell.
            let _ = fs::remove_file(&part);
            Err(error)
        }
    }
}
