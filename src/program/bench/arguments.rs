//! What can be typed after `grainfall bench`.

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
const MOST_GRAINS: usize = 100_000_000;

const BENCH_HELP: &str = "\
Examples:
  grainfall bench gas                           10976 elastic spheres at φ = 0.3
  grainfall bench gas --quick                   seconds

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
two spheres that was carried out counts as one; nothing else counts.

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
