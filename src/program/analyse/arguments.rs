//! What can be typed after `grainfall analyse`.

use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, ValueEnum};

const ANALYSE_HELP: &str = "\
Examples:
  grainfall analyse runs/deposition-1                     everything, of the last frame
  grainfall analyse runs/deposition-1 profile contacts
  grainfall analyse runs/deposition-1 profile --axis z --bins 60 --from 100
  grainfall analyse heap.xyz rdf fabric --out results
  grainfall analyse runs/drum velocity temperature --slab x=-3,3 --component x

For each subject a table (CSV) and a plot (SVG) go to the folder `analysis` in the
run's, or beside the file of frames; those that are there are replaced.

  profile      packing fraction in slabs along --axis
  map          packing fraction in columns over the plane of --across and up
  rdf          radial distribution function g(r)
  contacts     contacts per grain for several gaps, with and without rattlers
  fabric       the fabric tensor of contacts closer than --gap
  velocity     mean --component of the velocity in bins along --axis
  temperature  granular temperature in bins along --axis
  angle        angle of the free surface over --across, fitted by a line
  msd          mean square displacement against time
  stress       stress in slabs across --axis, collisional and kinetic
  force        force on fixed grains, on those asleep and on walls against time

stress and force need the collisions between frames: the run is carried out again
up to --to, which takes as long as it did, and watched from --from on; nothing of
the run is written to. They are measured only if asked for by name.

Of several frames the means are shown, with standard errors that count their
correlation by block averages. profile, map, rdf, contacts, fabric and angle take
the last frame alone if neither --from nor --to is given, the others all frames.
Lengths are in d, speeds in √(gd), times in √(d/g), temperatures in mgd.";

#[derive(Debug, Args)]
#[command(after_help = ANALYSE_HELP)]
pub(in crate::program) struct AnalyseArguments {
    /// A run folder, or an extended XYZ file
    pub(super) run: PathBuf,
    /// What to measure [default: all that the frames allow]
    #[arg(value_name = "SUBJECT", hide_possible_values = true)]
    pub(super) subjects: Vec<Subject>,
    /// The axis that bins follow [default: up, the last one]
    #[arg(long, value_name = "AXIS")]
    pub(super) axis: Option<Axis>,
    /// The horizontal axis of maps and surfaces
    #[arg(long, value_name = "AXIS", default_value = "x")]
    pub(super) across: Axis,
    /// The component of velocities [default: that along --across]
    #[arg(long, value_name = "AXIS")]
    pub(super) component: Option<Axis>,
    /// How many bins [default: 2 a diameter; 1 for velocity, temperature, angle; 50 for rdf]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(super) bins: Option<u32>,
    /// Only frames, and collisions, from this time on, in √(d/g)
    #[arg(long, value_name = "T", value_parser = finite, allow_negative_numbers = true)]
    pub(super) from: Option<f64>,
    /// Only frames, and collisions, up to this time, in √(d/g)
    #[arg(long, value_name = "T", value_parser = finite, allow_negative_numbers = true)]
    pub(super) to: Option<f64>,
    /// Only grains whose centres lie between two places, in d, such as x=-3,3; for
    /// velocity, temperature, rdf and angle; again and again
    #[arg(long, value_name = "AXIS=LOW,HIGH", allow_hyphen_values = true)]
    pub(super) slab: Vec<Slab>,
    /// Grains touch whose surfaces are at most so far apart, in d
    #[arg(long, value_name = "GAP", value_parser = positive, default_value = "1e-3")]
    pub(super) gap: f64,
    /// The farthest distance of rdf, in d [default: 5, or what the box allows]
    #[arg(long, value_name = "R", value_parser = positive)]
    pub(super) farthest: Option<f64>,
    /// The packing fraction at the free surface [default: half of random close packing]
    #[arg(long, value_name = "PHI", value_parser = positive)]
    pub(super) level: Option<f64>,
    /// Where to write [default: analysis, beside the frames]
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
}

/// What can be measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, ValueEnum)]
pub(super) enum Subject {
    Profile,
    Map,
    Rdf,
    Contacts,
    Fabric,
    Velocity,
    Temperature,
    Angle,
    Msd,
    Stress,
    Force,
    All,
}

impl Subject {
    /// What one has without asking for it by name.
    pub(super) const EACH: [Subject; 9] = [
        Subject::Profile,
        Subject::Map,
        Subject::Rdf,
        Subject::Contacts,
        Subject::Fabric,
        Subject::Velocity,
        Subject::Temperature,
        Subject::Angle,
        Subject::Msd,
    ];

    /// The name that is typed, and that files have.
    pub(super) fn name(self) -> &'static str {
        match self {
            Subject::Profile => "profile",
            Subject::Map => "map",
            Subject::Rdf => "rdf",
            Subject::Contacts => "contacts",
            Subject::Fabric => "fabric",
            Subject::Velocity => "velocity",
            Subject::Temperature => "temperature",
            Subject::Angle => "angle",
            Subject::Msd => "msd",
            Subject::Stress => "stress",
            Subject::Force => "force",
            Subject::All => "all",
        }
    }

    /// Whether it is of a heap at rest, so that one frame will do.
    pub(super) fn is_of_one_frame(self) -> bool {
        !matches!(
            self,
            Subject::Velocity
                | Subject::Temperature
                | Subject::Msd
                | Subject::Stress
                | Subject::Force
                | Subject::All
        )
    }
}

/// One of the axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Axis {
    X,
    Y,
    Z,
}

impl Axis {
    /// Counted from 0.
    pub(super) fn index(self) -> usize {
        self as usize
    }
}

/// The name of an axis.
pub(super) fn axis_name(axis: usize) -> &'static str {
    ["x", "y", "z"].get(axis).copied().unwrap_or("?")
}

/// Places on an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Slab {
    pub(super) axis: Axis,
    pub(super) low: f64,
    pub(super) high: f64,
}

impl FromStr for Slab {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wanted = || format!("`{text}` is no slab; x=-3,3 is one");
        let (name, ends) = text.split_once('=').ok_or_else(wanted)?;
        let (low, high) = ends.split_once(',').ok_or_else(wanted)?;
        let axis = Axis::from_str(name.trim(), true)
            .map_err(|_| format!("`{name}` is no axis; x, y and z are"))?;
        let number = |text: &str| text.trim().parse::<f64>().ok().filter(|x| x.is_finite());
        let (low, high) = number(low).zip(number(high)).ok_or_else(wanted)?;
        if low >= high {
            return Err(format!("{low} is not below {high}"));
        }
        Ok(Slab { axis, low, high })
    }
}

fn finite(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(time) if time.is_finite() => Ok(time),
        _ => Err("a finite number is allowed".to_owned()),
    }
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number > 0.0 && number.is_finite() => Ok(number),
        _ => Err("a number above 0 is allowed".to_owned()),
    }
}
