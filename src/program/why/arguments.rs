use std::path::PathBuf;

use clap::Args;

use crate::program::cli::instant;

const HELP: &str = "\
Examples:
  grainfall why runs/arch-1 --particle 1
  grainfall why runs/deposition-1 --particle 800 --time 42

The run is gone through again, in memory, up to that time: from the newest
checkpoint before it, else from the start, which takes as long as the run did.
Nothing is written. Told are: asleep or awake, and since when; what the criterion
said last, with its numbers; who supports the grain (static and below, nearer than
1.05 contact distances, or normal and above, leaning on it) and whom it supports.";

#[derive(Debug, Args)]
#[command(after_help = HELP)]
pub(in crate::program) struct WhyArguments {
    /// The folder of the run
    #[arg(value_name = "DIR")]
    pub(super) folder: PathBuf,
    /// Which grain, counted from 0
    #[arg(long, short, value_name = "ID")]
    pub(super) particle: u32,
    /// At which time, in √(d/g) [default: at its end, or at its last checkpoint]
    #[arg(long, value_name = "T", value_parser = instant, allow_negative_numbers = true)]
    pub(super) time: Option<f64>,
    /// Print one line of JSON
    #[arg(long)]
    pub(super) json: bool,
}
