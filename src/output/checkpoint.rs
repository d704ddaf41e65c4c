use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

use xxhash_rust::xxh3::xxh3_64;

use crate::output::folder::{RunFolder, sync_folder, write_synced};

/// What every checkpoint begins with.
const MAGIC: &[u8; 8] = b"GRAINCKP";

/// The layout that this version writes, and the only one that it reads.
const FORMAT: u32 = 13;

/// The version of the program, for which a checkpoint holds.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The largest checkpoint that is read, in bytes.
const LARGEST: u64 = 1 << 36;

/// The newest checkpoint of a run folder.
const NEWEST: &str = "checkpoint";
/// The one before it.
const PREVIOUS: &str = "checkpoint.previous";

/// A file in which the state of a run stands, to be gone on from.
///
/// It begins with 8 bytes `GRAINCKP`, the number of the format (u32), the
/// version of the program (its length as u8, then ASCII), the XXH3 of the
/// scenario file it belongs to (u64), and the length of the state (u64). Then
/// comes the state, and at the end the XXH3 of all bytes before (u64). Numbers
/// are little-endian.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Checkpoint {
    /// Fingerprint of the scenario file.
    pub scenario: u64,
    /// The state; what is in it is for the program to know.
    pub state: Vec<u8>,
}

/// Why a checkpoint can't be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// It is not there.
    #[error("is not there")]
    Missing,
    /// The file itself.
    #[error("cannot be read: {0}")]
    Io(io::Error),
    /// It is something else.
    #[error("is no checkpoint of grainfall")]
    Foreign,
    /// It ends too early.
    #[error("is truncated: it has {found} bytes of {wanted}")]
    Truncated {
        /// Its length.
        found: usize,
        /// The least length that it should have.
        wanted: usize,
    },
    /// Its bytes are not those that were written.
    #[error("is corrupted: its checksum is not that of its content")]
    Corrupted,
    /// It was written by another version.
    #[error(
        "was written by grainfall {version} (checkpoint format {format}); this is grainfall {VERSION} \
         (format {FORMAT}), and only the version that began a run goes on with it"
    )]
    OtherVersion {
        /// The version of the program.
        version: String,
        /// The number of the format.
        format: u32,
    },
}

/// Reads one thing after the other.
struct Bytes<'a> {
    all: &'a [u8],
    at: usize,
}

impl<'a> Bytes<'a> {
    fn take(&mut self, length: usize) -> Result<&'a [u8], CheckpointError> {
        let wanted = self.at.saturating_add(length);
        let taken = self.all.get(self.at..wanted);
        let taken = taken.ok_or(CheckpointError::Truncated {
            found: self.all.len(),
            wanted,
        })?;
        self.at = wanted;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], CheckpointError> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N)?);
        Ok(array)
    }
}

impl Checkpoint {
    /// The state of a run of the scenario that this text says.
    #[must_use]
    pub fn new(scenario: &[u8], state: Vec<u8>) -> Self {
        Checkpoint {
            scenario: xxh3_64(scenario),
            state,
        }
    }

    /// Whether it belongs to the scenario that this text says.
    #[must_use]
    pub fn is_of(&self, scenario: &[u8]) -> bool {
        self.scenario == xxh3_64(scenario)
    }

    /// The content of a file.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(self.state.len() + 64);
        bytes.extend(MAGIC);
        bytes.extend(FORMAT.to_le_bytes());
        bytes.push(VERSION.len() as u8);
        bytes.extend(VERSION.as_bytes());
        bytes.extend(self.scenario.to_le_bytes());
        bytes.extend((self.state.len() as u64).to_le_bytes());
        bytes.extend(&self.state);
        bytes.extend(xxh3_64(&bytes).to_le_bytes());
        bytes
    }

    /// Reads the content of a file.
    ///
    /// # Errors
    ///
    /// When it is not whole, not as it was written, or of another version.
    pub fn from_bytes(all: &[u8]) -> Result<Self, CheckpointError> {
        let mut bytes = Bytes { all, at: 0 };
        let magic = &all[..all.len().min(MAGIC.len())];
        if magic.is_empty() || !MAGIC.starts_with(magic) {
            return Err(CheckpointError::Foreign);
        }
        bytes.take(MAGIC.len())?;
        let format = u32::from_le_bytes(bytes.array()?);
        let [length] = bytes.array()?;
        let version = bytes.take(usize::from(length))?;
        if format != FORMAT || version != VERSION.as_bytes() {
            let shown = version.iter().take(32);
            return Err(CheckpointError::OtherVersion {
                version: shown.map(|byte| byte.escape_ascii().to_string()).collect(),
                format,
            });
        }
        let scenario = u64::from_le_bytes(bytes.array()?);
        let length = u64::from_le_bytes(bytes.array()?);
        let state = bytes.take(usize::try_from(length).unwrap_or(usize::MAX))?;
        let end = bytes.at;
        let checksum = u64::from_le_bytes(bytes.array()?);
        if bytes.at != all.len() || checksum != xxh3_64(&all[..end]) {
            return Err(CheckpointError::Corrupted);
        }
        Ok(Checkpoint {
            scenario,
            state: state.to_vec(),
        })
    }

    /// Makes this the newest checkpoint of a run folder and keeps the one
    /// before: whatever happens meanwhile, one of the two is whole and on the
    /// disk.
    ///
    /// # Errors
    ///
    /// When it can't be written; those that are there stay as they are.
    pub fn write(&self, folder: &RunFolder) -> io::Result<()> {
        let newest = folder.file(NEWEST);
        let part = folder.file("checkpoint.part");
        write_synced(&part, &self.to_bytes())?;
        match fs::rename(&newest, folder.file(PREVIOUS)) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
            _ => {}
        }
        fs::rename(&part, &newest)?;
        sync_folder(folder.path());
        Ok(())
    }

    /// The checkpoints of a run folder with their names, the newest first.
    pub fn all(folder: &RunFolder) -> [(&'static str, Result<Self, CheckpointError>); 2] {
        [NEWEST, PREVIOUS].map(|name| (name, Checkpoint::read(&folder.file(name))))
    }

    fn read(file: &Path) -> Result<Self, CheckpointError> {
        let mut bytes = Vec::new();
        let read = File::open(file).and_then(|opened| {
            opened.take(LARGEST).read_to_end(&mut bytes)?;
            Ok(())
        });
        match read {
            Ok(()) => Checkpoint::from_bytes(&bytes),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Err(CheckpointError::Missing),
            Err(error) => Err(CheckpointError::Io(error)),
        }
    }

    /// Takes the checkpoints out of the folder of a run that is finished.
    ///
    /// # Errors
    ///
    /// When one can't be removed.
    pub fn clear(folder: &RunFolder) -> io::Result<()> {
        for name in [PREVIOUS, NEWEST] {
            match fs::remove_file(folder.file(name)) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
                _ => {}
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one() -> Checkpoint {
        Checkpoint::new(b"seed = 1", (0..=255).collect())
    }

    #[test]
    fn bytes_come_back() {
        let bytes = one().to_bytes();
        let back = Checkpoint::from_bytes(&bytes).unwrap();
        assert_eq!(back, one());
        assert!(back.is_of(b"seed = 1") && !back.is_of(b"seed = 2"));
    }

    #[test]
    fn every_truncation_and_every_flipped_bit_is_found() {
        let bytes = one().to_bytes();
        for length in 0..bytes.len() {
            let error = Checkpoint::from_bytes(&bytes[..length]).unwrap_err();
            let wanted = match length {
                0 => matches!(error, CheckpointError::Foreign),
                _ => matches!(error, CheckpointError::Truncated { .. }),
            };
            assert!(wanted, "{length}: {error}");
        }
        for place in 0..bytes.len() {
            for bit in 0..8 {
                let mut damaged = bytes.clone();
                damaged[place] ^= 1 << bit;
                assert!(Checkpoint::from_bytes(&damaged).is_err(), "{place} {bit}");
            }
        }
        let mut longer = bytes;
        longer.push(0);
        let error = Checkpoint::from_bytes(&longer).unwrap_err();
        assert!(matches!(error, CheckpointError::Corrupted));
    }

    #[test]
    fn other_versions_are_named() {
        let mut newer = one().to_bytes();
        newer[MAGIC.len()] = FORMAT as u8 + 1;
        let error = Checkpoint::from_bytes(&newer).unwrap_err();
        let said = error.to_string();
        assert!(
            said.contains(&format!("format {}", FORMAT + 1)) && said.contains(VERSION),
            "{said}"
        );
    }

    #[test]
    fn the_one_before_is_kept() {
        let place = tempfile::tempdir().unwrap();
        let folder = RunFolder::create(place.path(), false).unwrap();
        for number in 0..3 {
            Checkpoint::new(b"", vec![number]).write(&folder).unwrap();
        }
        let [(_, newest), (_, previous)] = Checkpoint::all(&folder);
        assert_eq!(
            (newest.unwrap().state, previous.unwrap().state),
            (vec![2], vec![1])
        );
        Checkpoint::clear(&folder).unwrap();
        Checkpoint::clear(&folder).unwrap();
        for (name, found) in Checkpoint::all(&folder) {
            assert!(matches!(found, Err(CheckpointError::Missing)), "{name}");
        }
    }
}
