/// Why runs can't be carried out together.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SweepError {
    /// The seed is given as a value.
    #[error(
        "--set seed: the seeds of a sweep are given by --seeds N, how many, and --seed N, the first"
    )]
    Seed,
    /// A value is given twice over.
    #[error("{path} is given by {one} and by {other}; give all its values at once")]
    Twice {
        /// Which.
        path: String,
        /// What was typed.
        one: String,
        /// What was typed, too.
        other: String,
    },
    /// Two runs would be the same.
    #[error("{one} and {other} are the same scenario; each may be there only once")]
    Duplicate {
        /// The values of one.
        one: String,
        /// The values of the other.
        other: String,
    },
    /// More runs than anybody waits for.
    #[error(
        "{combinations} combinations of values with {seeds} seeds each are too many runs; at most \
         {most} are allowed"
    )]
    TooMany {
        /// How many combinations there are.
        combinations: u128,
        /// How many seeds.
        seeds: u64,
        /// How many runs there may be.
        most: u64,
    },
    /// The last seed is too large.
    #[error("{seeds} seeds from {first} on go beyond the largest, {}", i64::MAX)]
    LargeSeed {
        /// The first seed.
        first: u64,
        /// How many.
        seeds: u64,
    },
    /// The folder belongs to another sweep.
    #[error(
        "{folder} holds another sweep; choose another --out, or --force to overwrite it. What \
         differs:{differences}"
    )]
    OtherSweep {
        /// The folder.
        folder: String,
        /// A line for each difference.
        differences: String,
    },
    /// What a sweep is of can't be read.
    #[error(
        "{file} does not say what the sweep is of ({reason}); choose another --out, or --force"
    )]
    Unreadable {
        /// Which.
        file: String,
        /// Why.
        reason: String,
    },
    /// The folder of a run belongs to another run.
    #[error("{file} has been changed; take the folder away to have the run anew")]
    OtherRun {
        /// The scenario file.
        file: String,
    },
}
