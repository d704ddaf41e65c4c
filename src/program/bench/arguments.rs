//! What can be typed after `grainfall bench`.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};

/// A number that is more than 0.
fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number > 0.0 && number.is_finite() => Ok(number),
        _ => Err("a number above 0 is allowed".to_owned()),
    }
}

/// A number that is not below 0.
fn not_negative(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number >= 0.0 && number.is_finite() => Ok(number),
        _ => Err("a number from 0 on is allowed".to_owned()),
    }
}

/// A whole number that is more than 0.
fn whole(text: &str) -> Result<u64, String> {
    match text.parse::<u64>() {
        Ok(number) if number > 0 => Ok(number),
        _ => Err("a whole number from 1 on is allowed".to_owned()),
    }
}

/// A number of grains.
fn grains(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(count) if (1..=MOST_GRAINS).contains(&count) => Ok(count),
        _ => Err(format!("a whole number from 1 to {MOST_GRAINS} is allowed")),
    }
}

/// As many as scenarios may have.
const MOST_GRAINS: usize = 10_000_000;

const BENCH_HELP: &str = "\
Examples:
  grainfall bench gas                           10976 elastic spheres at φ = 0.3
  grainfall bench gas --packing-fraction 0.5 --repeats 5
  grainfall bench deposition                    the paper's rain of 4800 grains
  grainfall bench deposition --count 100000 --from 50 --until 51
  grainfall bench growth --out growth.csv       time against time (Fig. 5)
  grainfall bench scaling --out scaling.csv     cost against the number of grains
  grainfall bench scaling --quick               --quick makes each a matter of seconds

Times are processor times of one core, set-up not included. They depend on the
machine and on what else it does; trajectories and counts don't. For counts of
instructions see benches/instructions in the source code.";

#[derive(Debug, Args)]
#[command(after_help = BENCH_HELP)]
pub(in crate::program) struct BenchArguments {
    #[command(subcommand)]
    pub(super) subject: Subject,
}

/// What is measured.
#[derive(Debug, Subcommand)]
pub(super) enum Subject {
    /// Collisions of elastic equal spheres in a periodic cube
    Gas(GasArguments),
    /// Events of the paper's rain on a rough base
    Deposition(DepositionArguments),
    /// Processor time against simulated time, with sleep and without
    Growth(GrowthArguments),
    /// The cost of an event against the number of grains
    Scaling(ScalingArguments),
}

/// From where the gas comes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum GasStart {
    /// A face-centred cubic lattice, which melts if it is not too dense
    Crystal,
    /// A disordered fluid, made by growth
    Fluid,
}

const GAS_HELP: &str = "\
Examples:
  grainfall bench gas --count 10976 --packing-fraction 0.5
  grainfall bench gas --count 1000188 --packing-fraction 0.1
  grainfall bench gas --count 10000 --packing-fraction 0.5 --start fluid
  grainfall bench gas --repeats 5 --json --hash

Diameter, mass and temperature are 1; the total momentum is 0. One collision of
two spheres that was carried out counts as one; nothing else counts. More than
20000 grains are numbered along a curve that fills space.

Time before the timed part, if --equilibrate does not say it, by number of
grains and packing fraction:
              0.1   0.3   0.5
  up to 3e4   3     2     1
  up to 3e5   1     0.5   0.1
  more        0.1   0.1   0.03";

#[derive(Debug, Args)]
#[command(after_help = GAS_HELP)]
pub(super) struct GasArguments {
    /// Grains; 4 k³ of a crystal, such as 1372, 10976, 97556, 1000188 [default: 10976]
    #[arg(long, value_name = "N", value_parser = grains, allow_negative_numbers = true)]
    pub(super) count: Option<usize>,
    /// Volume of the grains over volume of the box
    #[arg(long, value_name = "P", value_parser = positive, default_value = "0.3", allow_negative_numbers = true)]
    pub(super) packing_fraction: f64,
    /// Collisions that are timed [default: 300000; with 3e4 grains or more 500000, 3e5: 1000000]
    #[arg(long, value_name = "K", value_parser = whole, allow_negative_numbers = true)]
    pub(super) collisions: Option<u64>,
    /// From where the gas comes
    #[arg(long, value_enum, default_value = "crystal")]
    pub(super) start: GasStart,
    /// Time that passes before, with d = m = kT = 1 [default: see below]
    #[arg(long, value_name = "T", value_parser = not_negative, allow_negative_numbers = true)]
    pub(super) equilibrate: Option<f64>,
    /// Time so many parts of K collisions each, one after the other, and take the least and the median
    #[arg(long, value_name = "R", value_parser = whole, default_value = "1", allow_negative_numbers = true)]
    pub(super) repeats: u64,
    /// The seed of the velocities, and of the fluid
    #[arg(long, value_name = "S", default_value = "1")]
    pub(super) seed: u64,
    /// Go the same way again, untimed, and print the hash of the timed part
    #[arg(long)]
    pub(super) hash: bool,
    /// Print one line of JSON instead
    #[arg(long)]
    pub(super) json: bool,
    /// A small one: 1372 grains, 20000 collisions, half the time before, unless said otherwise
    #[arg(long)]
    pub(super) quick: bool,
}

/// A seed that scenarios may have.
fn seed() -> clap::builder::RangedU64ValueParser {
    clap::value_parser!(u64).range(..=i64::MAX as u64)
}

const DEPOSITION_HELP: &str = "\
Examples:
  grainfall bench deposition
  grainfall bench deposition --sleep-speed 0.01 --hash
  grainfall bench deposition --count 1000000 --from 50 --events 5000000
  grainfall bench deposition --count 1000000 --elastic-speed 1e-3

It is the preset `deposition`: the same numbers make the same trajectory, and
the hash of a whole run is the one in its summary. The base is as wide as makes
the rain as high as the paper's, 500 d, if --width does not say it: 10 d for 4800
grains. Wide rains differ from it in nothing but their width, and of more than
20000 grains in their numbers, which follow a curve that fills space
(`numbering = \"space\"` in a scenario).

Physical events of any kind count as one each: what `grainfall run` counts, too.
Without --from, --until and --events the whole run is timed, until all grains
sleep; then φ and the mean number of normal grains while the heap grows, from 0.25
to 0.8 of the time of the last landing, are printed, too.";

#[derive(Debug, Args)]
#[command(after_help = DEPOSITION_HELP)]
pub(super) struct DepositionArguments {
    /// Grains in the rain [default: 4800]
    #[arg(long, value_name = "N", value_parser = grains, allow_negative_numbers = true)]
    pub(super) count: Option<usize>,
    /// Edge of the square base, in d [default: 10 √(N/4800)]
    #[arg(long, value_name = "W", value_parser = positive, allow_negative_numbers = true)]
    pub(super) width: Option<f64>,
    /// V_t, below which grains may fall asleep and beyond which a hit wakes, in √(gd)
    #[arg(long, value_name = "V", value_parser = not_negative, default_value = "0.1", allow_negative_numbers = true)]
    pub(super) sleep_speed: f64,
    /// V_c, below which collisions are elastic, in √(gd) [default: 1e-4]
    #[arg(long, value_name = "Vc", value_parser = not_negative, allow_negative_numbers = true)]
    pub(super) elastic_speed: Option<f64>,
    /// Time from here on, in √(d/g)
    #[arg(long, value_name = "T", value_parser = not_negative, allow_negative_numbers = true)]
    pub(super) from: Option<f64>,
    /// Time up to here
    #[arg(long, value_name = "T", value_parser = positive, allow_negative_numbers = true, conflicts_with = "events")]
    pub(super) until: Option<f64>,
    /// Time so many events
    #[arg(long, value_name = "K", value_parser = whole, allow_negative_numbers = true)]
    pub(super) events: Option<u64>,
    /// The seed of the base and of the rain
    #[arg(long, value_name = "S", value_parser = seed(), default_value = "1")]
    pub(super) seed: u64,
    /// Go the same way again, untimed, and print the hash of the timed part
    #[arg(long)]
    pub(super) hash: bool,
    /// Print one line of JSON instead
    #[arg(long)]
    pub(super) json: bool,
    /// A small one: 300 grains, V_c = 1e-3, unless said otherwise
    #[arg(long)]
    pub(super) quick: bool,
}

const GROWTH_HELP: &str = "\
Examples:
  grainfall bench growth --out growth.csv
  grainfall bench growth --count 4800 --sleep-speeds 0.05,0.1
  grainfall bench growth --sleep-speeds 0 --until 40

Fig. 5 of the paper: without sleep the processor time grows ever faster, with it
in proportion to the simulated time. One row every --step of simulated time.";

#[derive(Debug, Args)]
#[command(after_help = GROWTH_HELP)]
pub(super) struct GrowthArguments {
    /// Grains in the rain [default: 1500]
    #[arg(long, value_name = "N", value_parser = grains, allow_negative_numbers = true)]
    pub(super) count: Option<usize>,
    /// Edge of the square base, in d [default: 10]
    #[arg(long, value_name = "W", value_parser = positive, allow_negative_numbers = true)]
    pub(super) width: Option<f64>,
    /// Values of V_t, in √(gd), one run each; 0: nobody sleeps
    #[arg(
        long,
        value_name = "V,…",
        value_delimiter = ',',
        default_value = "0,0.05,0.1",
        allow_negative_numbers = true
    )]
    pub(super) sleep_speeds: Vec<f64>,
    /// V_c, below which collisions are elastic, in √(gd) [default: 1e-4]
    #[arg(long, value_name = "Vc", value_parser = not_negative, allow_negative_numbers = true)]
    pub(super) elastic_speed: Option<f64>,
    /// Stop at this time [default: 30 without sleep, else when all grains sleep]
    #[arg(long, value_name = "T", value_parser = positive, allow_negative_numbers = true)]
    pub(super) until: Option<f64>,
    /// Simulated time between rows, in √(d/g)
    #[arg(long, value_name = "T", value_parser = positive, default_value = "1", allow_negative_numbers = true)]
    pub(super) step: f64,
    /// The seed of the base and of the rain
    #[arg(long, value_name = "S", value_parser = seed(), default_value = "1")]
    pub(super) seed: u64,
    /// Write the rows to this file too, as CSV
    #[arg(long, value_name = "FILE.csv")]
    pub(super) out: Option<PathBuf>,
    /// A small one: 200 grains on a base of 4 d, V_c = 1e-3, 6 √(d/g) without sleep, unless said otherwise
    #[arg(long)]
    pub(super) quick: bool,
}

/// What the cost depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum ScalingSubject {
    /// The size of an elastic gas at fixed density
    Gas,
    /// The number of frozen grains at a fixed number of normal ones
    Frozen,
}

const SCALING_HELP: &str = "\
Examples:
  grainfall bench scaling --out scaling.csv
  grainfall bench scaling --only frozen --largest 100000

gas:     1372 to 1000188 elastic spheres at φ = 0.3, from crystals, as with
         `grainfall bench gas`
frozen:  half of a rain of 1500 grains has landed on the paper's base; up to a
         million frozen grains more lie under that, out of reach, so that the
         same collisions follow whatever their number

Of three parts of a run the fastest counts.";

#[derive(Debug, Args)]
#[command(after_help = SCALING_HELP)]
pub(super) struct ScalingArguments {
    /// Only one of the two [default: both]
    #[arg(long, value_enum)]
    pub(super) only: Option<ScalingSubject>,
    /// Leave out what has, or adds, more grains than this
    #[arg(long, value_name = "N", value_parser = grains, default_value = "1000188", allow_negative_numbers = true)]
    pub(super) largest: usize,
    /// The seed of the velocities, of the base and of the rain
    #[arg(long, value_name = "S", value_parser = seed(), default_value = "1")]
    pub(super) seed: u64,
    /// Write the rows to this file too, as CSV
    #[arg(long, value_name = "FILE.csv")]
    pub(super) out: Option<PathBuf>,
    /// Small ones: 108 to 500 spheres, half of 200 grains on up to 10000
    #[arg(long)]
    pub(super) quick: bool,
}
