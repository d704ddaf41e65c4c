//! What can be typed.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

use crate::program::analyse::AnalyseArguments;
use crate::program::bench::BenchArguments;
use crate::program::compare::CompareArguments;
use crate::program::reference::ReferenceArguments;
use crate::program::reproduce::ReproduceArguments;
use crate::program::sweep::{MOST_RUNS, Variation};
use crate::program::why::WhyArguments;
use crate::scenario::Assignment;

const EXAMPLES: &str = "\
Examples:
  grainfall run deposition                      the paper's deposition
  grainfall run deposition --seed 2 --set parameters.sleep_speed=0.05
  grainfall preset arch > mine.toml             a scenario to edit
  grainfall run mine.toml --until 10
  grainfall resume runs/deposition-1            go on after an interruption
  grainfall sweep deposition --set parameters.sleep_speed=0.02,0.05,0.1 --seeds 4
                                                many runs, on all cores
  grainfall compare deposition --policies slow_descent,isostatic_support --seeds 3
                                                sleep criteria, side by side
  grainfall draw runs/deposition-1 --time 50
  grainfall analyse runs/deposition-1           packing, contacts, motion: CSV and SVG
  grainfall why runs/arch-1 --particle 1        asleep or awake, and why
  grainfall reproduce all --quick               the paper's figures, from small systems
  grainfall validate --quick                    known physics, in a minute
  grainfall bench gas                           what a collision costs

Exit codes:
  0 done · 1 input or output, or a validation, failed · 2 refused input ·
  3 stopped early (collapse, error) with the state saved ·
  130, 143 stopped by Ctrl-C or SIGTERM, with everything written";

const RUN_HELP: &str = "\
Examples:
  grainfall run deposition
  grainfall run deposition --set grains.1.rain.count=1500 --set output.mean_normal_from=20
  grainfall run bounce --out runs/first
  grainfall run mine.toml --seed 7 --until 50 --force

The run folder then holds
  scenario.toml   the scenario as it was run, ready to be run again
  summary.json    how it ended
  series.csv      counts by mode, events and energies over time
  frames.xyz      all grains at some times (extended XYZ, for OVITO)
  events.csv      every event, if output.events = true
  audit.json      what audits have found, with --audit
  checkpoint      the state to go on from, while it is not finished

An earlier run is not overwritten without --force (exit code 2). Ctrl-C ends a
run early, with everything written (exit code 130); a second one ends it at once.
However a run was ended, `grainfall resume DIR` goes on with it.";

const RESUME_HELP: &str = "\
Examples:
  grainfall run deposition --checkpoint-every 10     … and the machine goes down
  grainfall resume runs/deposition-1

The run goes on from its last checkpoint: what was written after it is cut off
and written again, and in the end the folder is that of a run that was never
interrupted, but for the processor time. A checkpoint is written when a run is
ended by Ctrl-C or SIGTERM, and while it goes on; `grainfall run` without a
checkpoint but the first starts anew. A run that is finished is left alone.

Exit codes are those of `grainfall run`; 2 also if there is no checkpoint that
is whole and of this version.";

const SWEEP_HELP: &str = "\
Examples:
  grainfall sweep deposition --set parameters.sleep_speed=0.02,0.05,0.1 --seeds 4
  grainfall sweep mine.toml --set parameters.wake_speed=0.1,never --threads 2
  grainfall sweep deposition --set parameters.sleep_speed,parameters.wake_speed=0.05,0.1
  grainfall sweep arch --set 'gravity=[0, -1],[0.1, -1]' --out runs/tilted
  grainfall sweep arch --set 'title=\"one, two\",three' --until 5

Commas between values separate them. A value that itself holds commas is written
as in TOML: a list in [ ], a table in { }, a text in quotes; keep the shell from
reading those by quotes around the whole. Commas between paths give them the same
values. Every value of each --set is combined with every value of the others and
with every seed; the first --set changes slowest, the seed fastest.

Each run goes to a folder of its own, such as sleep_speed=0.05_seed=2, and is,
but for timings, what `grainfall run` makes of the same values and seed: it does
not depend on the number of threads. The folder of the sweep also holds
  sweep.toml   what the sweep is of
  runs.csv     a row for each run: its values, how it ended, its main figures

The same command again goes on after an interruption, even by kill -9: runs that
are finished are left alone, those that were interrupted go on from their
checkpoints. Ctrl-C ends all runs with their states saved (exit code 130).

Exit code 3: a run has stopped early (a collapse, an error); the others were
carried on with, and runs.csv says which it was.";

const SWEEP_SET_HELP: &str = "\
Values to be tried in place of the scenario's, such as
parameters.sleep_speed=0.05,0.1 or grains.1.rain.count=1500; again and again";

const CHECKPOINT_HELP: &str = "\
Write a checkpoint at the multiples of this simulated time, in √(d/g); 0: only
when interrupted [default: about once a minute]";

const AUDIT_HELP: &str = "\
Compare the event queue with brute force every K events; a contact that would
have been missed ends the run (exit code 3). Writes audit.json";

/// A time between checkpoints.
fn interval(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(every) if every == 0.0 || (1.0e-9..=1.0e9).contains(&every) => Ok(every),
        _ => Err("a time from 1e-9 to 1e9, or 0, is allowed".to_owned()),
    }
}

/// A number of events between audits.
fn events(text: &str) -> Result<u64, String> {
    match text.parse::<u64>() {
        Ok(every) if every > 0 => Ok(every),
        _ => Err("a whole number from 1 on is allowed, such as 10000".to_owned()),
    }
}

/// A time that comes.
pub(super) fn instant(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(time) if time.is_finite() => Ok(time),
        _ => Err("a finite number is allowed".to_owned()),
    }
}

const SET_HELP: &str = "\
A value in place of the scenario's, such as parameters.sleep_speed=0.05,
grains.1.rain.count=1500 or gravity=none; again and again";

/// Event-driven simulation of dense granular matter.
#[derive(Debug, Parser)]
#[command(name = "grainfall", version, after_help = EXAMPLES, arg_required_else_help = true)]
pub(super) struct Cli {
    #[command(subcommand)]
    pub(super) command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Run a preset or a scenario file
    Run(RunArguments),
    /// Go on with a run that was interrupted
    Resume(ResumeArguments),
    /// Run all combinations of some values, with several seeds, on all cores
    Sweep(SweepArguments),
    /// List the presets
    Presets,
    /// Print the scenario of a preset, to edit
    #[command(after_help = "Example:\n  grainfall preset deposition > mine.toml")]
    Preset {
        /// The preset's name; `grainfall presets` lists them
        name: String,
    },
    /// Say whether a scenario can be run, and run nothing
    #[command(after_help = "Example:\n  grainfall check mine.toml")]
    Check(CheckArguments),
    /// List the sleep criteria that a scenario can name
    Criteria,
    /// Run a scenario under several sleep criteria, side by side
    Compare(CompareArguments),
    /// Say what a grain of a run does, and why
    Why(WhyArguments),
    /// Print the JSON Schema of scenarios
    Schema,
    /// Write the reference of commands and scenarios, as Markdown
    Reference(ReferenceArguments),
    /// Draw the grains of a run as SVG
    Draw(DrawArguments),
    /// Measure packing, contacts and motion on the frames of a run
    Analyse(AnalyseArguments),
    /// Make the figures and numbers of the paper again
    Reproduce(ReproduceArguments),
    /// Measure known physics and say whether it comes out right
    Validate(ValidateArguments),
    /// Measure what events cost, in time and memory
    Bench(BenchArguments),
}

#[derive(Debug, Args)]
#[command(after_help = RUN_HELP)]
pub(super) struct RunArguments {
    /// A preset's name, or a scenario file in TOML or JSON
    pub(super) scenario: String,
    /// The seed, in place of the scenario's
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(..=i64::MAX as u64))]
    pub(super) seed: Option<u64>,
    /// Where to write [default: runs/NAME-SEED]
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    #[arg(long, value_name = "PATH=VALUE", help = SET_HELP)]
    pub(super) set: Vec<Assignment>,
    /// Stop at this time, in √(d/g): the same as --set stop.time=T
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub(super) until: Option<f64>,
    #[arg(long, value_name = "T", value_parser = interval, allow_negative_numbers = true, help = CHECKPOINT_HELP)]
    pub(super) checkpoint_every: Option<f64>,
    #[arg(long, value_name = "K", value_parser = events, allow_negative_numbers = true, help = AUDIT_HELP)]
    pub(super) audit: Option<u64>,
    /// Overwrite an earlier run
    #[arg(long)]
    pub(super) force: bool,
    /// Show no progress, and no summary at the end
    #[arg(long, short)]
    pub(super) quiet: bool,
}

#[derive(Debug, Args)]
#[command(after_help = RESUME_HELP)]
pub(super) struct ResumeArguments {
    /// The folder of the run
    #[arg(value_name = "DIR")]
    pub(super) folder: PathBuf,
    #[arg(long, value_name = "T", value_parser = interval, allow_negative_numbers = true, help = CHECKPOINT_HELP)]
    pub(super) checkpoint_every: Option<f64>,
    #[arg(long, value_name = "K", value_parser = events, allow_negative_numbers = true, help = AUDIT_HELP)]
    pub(super) audit: Option<u64>,
    /// Show no progress, and no summary at the end
    #[arg(long, short)]
    pub(super) quiet: bool,
}

#[derive(Debug, Args)]
#[command(after_help = SWEEP_HELP)]
pub(super) struct SweepArguments {
    /// A preset's name, or a scenario file in TOML or JSON
    pub(super) scenario: String,
    #[arg(long, value_name = "PATH=VALUE,VALUE", help = SWEEP_SET_HELP)]
    pub(super) set: Vec<Variation>,
    /// How many seeds for each combination of values
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..=MOST_RUNS))]
    pub(super) seeds: u64,
    /// The first seed, in place of the scenario's; the others follow it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(..=i64::MAX as u64))]
    pub(super) seed: Option<u64>,
    /// How many runs to carry out at a time [default: one on each core]
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u16).range(1..=4096))]
    pub(super) threads: Option<u16>,
    /// Where to write [default: runs/NAME-sweep]
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Stop all runs at this time, in √(d/g): the same as --set stop.time=T
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub(super) until: Option<f64>,
    #[arg(long, value_name = "T", value_parser = interval, allow_negative_numbers = true, help = CHECKPOINT_HELP)]
    pub(super) checkpoint_every: Option<f64>,
    /// Overwrite an earlier sweep
    #[arg(long)]
    pub(super) force: bool,
    /// Show no progress, and no table at the end
    #[arg(long, short)]
    pub(super) quiet: bool,
}

#[derive(Debug, Args)]
pub(super) struct CheckArguments {
    /// A scenario file in TOML or JSON, or a preset's name
    #[arg(value_name = "FILE")]
    pub(super) scenario: String,
    #[arg(long, value_name = "PATH=VALUE", help = SET_HELP)]
    pub(super) set: Vec<Assignment>,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  grainfall draw runs/deposition-1
  grainfall draw runs/deposition-1 --time 50 --out heap.svg

Colours: purple fixed, dark blue frozen, light blue falling, shades of blue
normal by kinetic energy. A picture that is there already is replaced.")]
pub(super) struct DrawArguments {
    /// A run folder, or an extended XYZ file
    pub(super) run: PathBuf,
    /// The frame nearest to this time [default: the last]
    #[arg(long, value_name = "T", value_parser = instant, allow_negative_numbers = true)]
    pub(super) time: Option<f64>,
    /// Where to write [default: picture.svg beside the frames]
    #[arg(long, value_name = "FILE.svg")]
    pub(super) out: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  grainfall validate --quick
  grainfall validate
  grainfall validate spheres cooling --out results.json

Subjects: spheres, disks, maxwell, cooling, barometer, bounces, diffusion.
What is allowed was fixed beforehand: four standard errors and the accuracy of
the reference. The exit code is 1 if anything fails.")]
pub(super) struct ValidateArguments {
    /// Which subjects [default: all]
    #[arg(value_name = "SUBJECT")]
    pub(super) subjects: Vec<String>,
    /// Smaller systems and fewer seeds, for about a minute
    #[arg(long)]
    pub(super) quick: bool,
    /// Write the results to this file too, as JSON
    #[arg(long, value_name = "FILE.json")]
    pub(super) out: Option<PathBuf>,
}
