//! What can be typed after `reproduce`.

use std::num::NonZeroU16;
use std::path::PathBuf;

use clap::{Args, ValueEnum};

const HELP: &str = "\
Examples:
  grainfall reproduce fig1 fig2                 at once
  grainfall reproduce all --quick               small systems: a few minutes
  grainfall reproduce numbers --seeds 3
  grainfall reproduce all                       about two hours on two cores

Every figure is made from nothing: its runs go to folders under DIR/runs, each
like one of `grainfall run`, on all cores. The same command goes on after an
interruption; runs that are finished are left alone. Then there stand in DIR
  fig1.svg … fig7.svg     the figures, and others
  fig1.csv …              what is drawn
  reproduce.md, .json     every number beside the paper's, with a verdict

A number agrees if it is within twice both standard errors, and an allowance that
is stated. One that does not agree is no failure: the table says why, as far as
is known.";

/// What is to be made again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::program) enum Part {
    /// A bouncing ball
    Fig1,
    /// An arch of two grains
    Fig2,
    /// Normal and frozen grains in time
    Fig3,
    /// Snapshots of a deposition
    Fig4,
    /// Processor time against time
    Fig5,
    /// The rotating drum
    Fig6,
    /// Velocity profiles of the drum
    Fig7,
    /// Packing fractions, one by one, cost, other makers
    Numbers,
    /// All of these
    All,
}

/// Makes the paper's figures and numbers again.
#[derive(Args, Clone, Debug)]
#[command(after_help = HELP)]
pub(in crate::program) struct ReproduceArguments {
    /// What to make.
    #[arg(required = true, value_name = "PART")]
    parts: Vec<Part>,
    /// Seeds of each deposit [default: 5, or 2 with --quick].
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..=100))]
    pub(super) seeds: Option<u64>,
    /// Small systems, to see that it works: the numbers are not the paper's.
    #[arg(long)]
    pub(super) quick: bool,
    /// Where to [default: reproduced, or reproduced-quick].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// How many runs at a time [default: as many as there are cores].
    #[arg(long)]
    pub(super) threads: Option<NonZeroU16>,
    /// Print nothing but errors.
    #[arg(long, short)]
    pub(super) quiet: bool,
}

impl ReproduceArguments {
    pub(super) fn wants(&self, part: Part) -> bool {
        self.parts.contains(&part) || self.parts.contains(&Part::All)
    }

    pub(super) fn folder(&self) -> PathBuf {
        let name = if self.quick {
            "reproduced-quick"
        } else {
            "reproduced"
        };
        self.out.clone().unwrap_or_else(|| PathBuf::from(name))
    }
}
