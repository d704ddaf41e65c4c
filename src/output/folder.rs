use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// True for the names of files that a run, or a picture of it, leaves behind.
fn is_of_a_run(name: &str) -> bool {
    // Begun, but never finished.
    let name = name.strip_suffix(".part").unwrap_or(name);
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
            "audit.json",
            "events.csv",
            "picture.svg",
            "checkpoint",
            "checkpoint.previous",
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
    /// There is no run.
    #[error("{folder} holds no run that can be resumed: {reason}")]
    NoRun {
        /// The name.
        folder: String,
        /// Why.
        reason: &'static str,
    },
    /// Another process is at it.
    #[error(
        "{folder} is being written by another grainfall process; wait for it, or stop it first"
    )]
    InUse {
        /// The folder.
        folder: String,
    },
    /// A file of the run is shorter than it was when its state was saved.
    #[error("{file} has {found} bytes, fewer than the {wanted} it had at the checkpoint")]
    Shorter {
        /// Which.
        file: String,
        /// Its length.
        found: u64,
        /// The length it had.
        wanted: u64,
    },
    /// A file of the run is gone.
    #[error("{file} is not there")]
    Gone {
        /// Which.
        file: String,
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
    /// Folders that were made for it, the outermost first.
    made: Vec<PathBuf>,
    /// Held as long as the run goes on, if it was begun here.
    _lock: Option<Arc<File>>,
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
        // A run that was cut off before it had written anything whole is none.
        let mut names = names.into_iter().filter(|name| !is_part(name));
        match names.next() {
            Some(found) if !force => Err(FolderError::Occupied { folder, found }),
            _ => Ok(()),
        }
    }

    /// Makes the folder, and takes the files of an earlier run out of it; other
    /// files stay. It is [locked](RunFolder::lock) as long as this is there.
    ///
    /// # Errors
    ///
    /// As [`RunFolder::check`], when a run is going on in it, and when the folder
    /// can't be made.
    pub fn create(path: &Path, force: bool) -> Result<Self, FolderError> {
        RunFolder::check(path, force)?;
        let missing = path.ancestors().take_while(|folder| !folder.exists());
        let mut made: Vec<_> = missing.map(Path::to_path_buf).collect();
        made.reverse();
        let mut folder = RunFolder {
            path: path.to_path_buf(),
            made,
            _lock: None,
        };
        let failed = |file: &Path, source| FolderError::Io {
            file: file.display().to_string(),
            source,
        };
        fs::create_dir_all(path).map_err(|error| failed(path, error))?;
        // A run that goes on there is not to have its files taken away, nor is
        // one that another process has begun just now.
        folder._lock = Some(Arc::new(folder.lock()?));
        RunFolder::check(path, force)?;
        for name in names_in(path).map_err(|error| failed(path, error))? {
            let file = folder.file(&name);
            if is_of_a_run(&name) {
                fs::remove_file(&file).map_err(|error| failed(&file, error))?;
            }
        }
        Ok(folder)
    }

    /// The folder of a run that was begun earlier.
    ///
    /// # Errors
    ///
    /// When there is none.
    pub fn open(path: &Path) -> Result<Self, FolderError> {
        let none = |reason| {
            Err(FolderError::NoRun {
                folder: path.display().to_string(),
                reason,
            })
        };
        if !path.is_dir() {
            return none("there is no such folder");
        }
        if path.join("sweep.toml").is_file() {
            return none("it holds a sweep; the same `grainfall sweep` command goes on with it");
        }
        if !path.join("scenario.toml").is_file() {
            return none("there is no scenario.toml in it; begin with `grainfall run`");
        }
        Ok(RunFolder {
            path: path.to_path_buf(),
            made: Vec::new(),
            _lock: None,
        })
    }

    /// Keeps other processes from writing to it as long as the file stays open,
    /// where the file system can do that.
    ///
    /// # Errors
    ///
    /// When another process is at it already.
    pub fn lock(&self) -> Result<File, FolderError> {
        lock(&self.path, "scenario.toml")
    }

    /// Takes a run that has come to nothing away again, and the folders that
    /// were made for it.
    pub fn discard(&self) {
        // What can't be removed stays: the reason for this is told already.
        for name in names_in(&self.path).unwrap_or_default() {
            if is_of_a_run(&name) {
                let _ = fs::remove_file(self.file(&name));
            }
        }
        for folder in self.made.iter().rev() {
            let _ = fs::remove_dir(folder);
        }
    }

    /// Takes away what a process that was killed had begun to write.
    ///
    /// # Errors
    ///
    /// When something can't be removed.
    pub fn tidy(&self) -> io::Result<()> {
        for name in names_in(&self.path)? {
            if is_part(&name) {
                fs::remove_file(self.file(&name))?;
            }
        }
        Ok(())
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

    /// A file in it to be written on from its byte `at`; what comes after is cut
    /// off.
    ///
    /// # Errors
    ///
    /// When the file is shorter or can't be opened.
    pub fn cut_file(&self, name: &str, at: u64) -> Result<File, FolderError> {
        self.check_length(name, at)?;
        let file = self.file(name);
        let opened = OpenOptions::new().write(true).open(&file);
        let cut = opened.and_then(|mut opened| {
            opened.set_len(at)?;
            opened.seek(SeekFrom::Start(at))?;
            Ok(opened)
        });
        cut.map_err(|source| FolderError::Io {
            file: file.display().to_string(),
            source,
        })
    }

    /// Sees whether a file in it has at least `wanted` bytes.
    ///
    /// # Errors
    ///
    /// When it is not there or shorter.
    pub fn check_length(&self, name: &str, wanted: u64) -> Result<(), FolderError> {
        let file = self.file(name);
        let shown = file.display().to_string();
        match fs::metadata(&file) {
            Ok(about) if about.len() >= wanted => Ok(()),
            Ok(about) => Err(FolderError::Shorter {
                file: shown,
                found: about.len(),
                wanted,
            }),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                Err(FolderError::Gone { file: shown })
            }
            Err(source) => Err(FolderError::Io {
                file: shown,
                source,
            }),
        }
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

/// Keeps other processes from writing to a folder as long as the file stays
/// open, where the file system can do that.
///
/// # Errors
///
/// When another process is at it already.
pub(crate) fn lock(folder: &Path, instead: &str) -> Result<File, FolderError> {
    // Where a folder can't be opened, a file that is never replaced will do.
    let opened = File::open(folder).or_else(|_| File::open(folder.join(instead)));
    let opened = opened.map_err(|source| FolderError::Io {
        file: folder.display().to_string(),
        source,
    })?;
    match opened.try_lock() {
        Err(TryLockError::WouldBlock) => Err(FolderError::InUse {
            folder: folder.display().to_string(),
        }),
        Ok(()) | Err(TryLockError::Error(_)) => Ok(opened),
    }
}

/// True for the names of files that were never finished.
fn is_part(name: &str) -> bool {
    name.ends_with(".part") && is_of_a_run(name)
}

/// The names of everything in a folder, in order.
pub(crate) fn names_in(path: &Path) -> io::Result<Vec<String>> {
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
    write_synced(&part, text)?;
    if let Err(error) = fs::rename(&part, file) {
        // The first error is the one to tell.
        let _ = fs::remove_file(&part);
        return Err(error);
    }
    sync_folder(file.parent().unwrap_or(Path::new(".")));
    Ok(())
}

/// Writes a file that is on the disk when this returns; if it can't be, nothing
/// is left of it.
pub(super) fn write_synced(file: &Path, bytes: &[u8]) -> io::Result<()> {
    let written = File::create(file).and_then(|mut out| {
        out.write_all(bytes)?;
        out.sync_all()
    });
    if written.is_err() {
        // The first error is the one to tell.
        let _ = fs::remove_file(file);
    }
    written
}

/// Sees to it that new names are on the disk. Not every system can do that, and
/// what the files hold does not depend on it.
pub(super) fn sync_folder(folder: &Path) {
    let folder = if folder.as_os_str().is_empty() {
        Path::new(".")
    } else {
        folder
    };
    if let Ok(opened) = File::open(folder) {
        let _ = opened.sync_all();
    }
}
