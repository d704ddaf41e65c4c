use std::path::PathBuf;

use clap::Args;

use crate::program::sweep::{MOST_RUNS, Variation};

const HELP: &str = "\
Examples:
  grainfall compare deposition --policies slow_descent,isostatic_support --seeds 3
  grainfall compare drum2d --policies slow_descent,granular_temperature \\
      --set parameters.elastic_speed=1e-2 --until 20
  grainfall compare mine.toml --policies slow_descent,never --until 30

Criteria that watch a grain for a while take up to 25 times the events of the paper's; a
larger parameters.elastic_speed spares most of them.

Every criterion runs the scenario with every seed, on all cores, each run as
`grainfall run` would carry it out, in a folder of its own. Then each run is gone
through again, in memory, and questioned:
  false sleeps   at 20 sleeps, spread evenly over all of the run, the grain that falls
                 asleep goes on instead, with the velocity it lost, while nobody else
                 falls asleep or wakes; false if it moves farther than 0.05 d within
                 2 √(d/g)
  false wakes    of all grains that woke, those that fell asleep again within 0.05 d
                 of where they woke

Written are compare.csv, a row for each run; compare.svg; and what `grainfall sweep`
writes. The same command again goes on after an interruption.";

#[derive(Debug, Args)]
#[command(after_help = HELP)]
pub(in crate::program) struct CompareArguments {
    /// A preset's name, or a scenario file in TOML or JSON
    pub(super) scenario: String,
    /// The criteria, by name; `grainfall criteria` lists them
    #[arg(long, value_name = "NAME,NAME", value_delimiter = ',', required = true)]
    pub(super) policies: Vec<String>,
    /// How many seeds for each
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..=MOST_RUNS))]
    pub(super) seeds: u64,
    /// The first seed, in place of the scenario's; the others follow it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(..=i64::MAX as u64))]
    pub(super) seed: Option<u64>,
    /// A value in place of the scenario's, for all; again and again
    #[arg(long, value_name = "PATH=VALUE")]
    pub(super) set: Vec<Variation>,
    /// Stop all runs at this time, in √(d/g)
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub(super) until: Option<f64>,
    /// How many runs to carry out at a time [default: one on each core]
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u16).range(1..=4096))]
    pub(super) threads: Option<u16>,
    /// Where to write [default: runs/NAME-compare]
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Overwrite an earlier comparison
    #[arg(long)]
    pub(super) force: bool,
    /// Show no progress, and no table at the end
    #[arg(long, short)]
    pub(super) quiet: bool,
}
