use std::path::Path;
use std::{fmt, fs, io};

use serde::{Deserialize, Serialize};

use crate::engine::{Collapse, Counts, EnergyLedger, ModeCounts};

/// Why a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StoppedBy {
    /// No grain is normal or falling, and none is left to drop.
    AllFrozen,
    /// The time was up.
    Time,
    /// The number of events was reached, or no event lies ahead at all.
    Events,
    /// Collisions without end at one instant.
    Collapse,
    /// The user.
    Interrupted,
    /// An error on the way; the message is in `error`.
    Error,
}

impl StoppedBy {
    /// What has happened, in words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            StoppedBy::AllFrozen => "all grains are at rest",
            StoppedBy::Time => "the time is up",
            StoppedBy::Events => "the number of events is reached, or none is left",
            StoppedBy::Collapse => "collapsed: collisions without end at one instant",
            StoppedBy::Interrupted => "interrupted",
            StoppedBy::Error => "stopped by an error",
        }
    }

    /// Whether the run came to an end of its own, so that nothing is left to
    /// resume.
    #[must_use]
    pub fn is_finished(self) -> bool {
        match self {
            StoppedBy::AllFrozen | StoppedBy::Time | StoppedBy::Events => true,
            StoppedBy::Collapse | StoppedBy::Interrupted | StoppedBy::Error => false,
        }
    }
}

/// Where summaries stand in the folders of runs.
const FILE: &str = "summary.json";

/// When and why a run ended: what `summary.json` says whatever the version of the
/// program, which may count other things than this one.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct Ending {
    /// When, in √(d/g).
    pub time: f64,
    /// Why.
    pub stop_reason: StoppedBy,
}

impl Ending {
    /// That of the run in a folder; `None` if it has left none that can be read.
    #[must_use]
    pub fn of(folder: &Path) -> Option<Self> {
        let text = fs::read(folder.join(FILE)).ok()?;
        serde_json::from_slice(&text).ok()
    }
}

/// `summary.json`: how a run ended.
///
/// Energies and the packing fraction are those of the last instant.
///
/// What is added later has a default where that is the truth for programs that did not
/// have it. Without, what those have left is no summary for this one, only an [`Ending`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// What the scenario calls itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub title: Option<String>,
    /// When it ended, in √(d/g).
    pub time: f64,
    /// Why it ended.
    pub stop_reason: StoppedBy,
    /// What went wrong, if anything.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// The grains that collide without end, if that is why it ended.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub collapse: Option<CollapseReport>,
    /// The seed.
    pub seed: u64,
    /// Events by kind.
    pub events: EventCounts,
    /// Grains by mode.
    pub particles: ParticleCounts,
    /// In mgd.
    pub kinetic_energy: f64,
    /// In mgd.
    pub potential_energy: f64,
    /// Where the energy has gone since the start, in mgd.
    pub energy_ledger: EnergyReport,
    /// Of the middle of the deposit, or null if there is none.
    pub packing_fraction: Option<FractionReport>,
    /// Time-weighted mean of the number of normal grains while a deposit
    /// grows, or null.
    pub mean_normal: Option<f64>,
    /// The deepest overlap of grains that collided or were asked about, in d.
    pub max_overlap: f64,
    /// Processor time of the run, in seconds.
    pub cpu_seconds: f64,
    /// Physical events per second of it.
    pub events_per_second: f64,
    /// Fingerprint of all physical events: 16 hexadecimal digits.
    pub trajectory_hash: String,
    /// The version of the program.
    pub version: String,
}

impl Summary {
    /// That of the run in a folder.
    ///
    /// # Errors
    ///
    /// When it cannot be read, or lacks what this version of the program wants to know.
    pub fn of(folder: &Path) -> io::Result<Self> {
        let text = fs::read(folder.join(FILE))?;
        serde_json::from_slice(&text).map_err(io::Error::other)
    }
}

/// A collapse.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CollapseReport {
    /// When, in √(d/g).
    pub time: f64,
    /// The grain that collides without end, then those it touches.
    pub particles: Vec<u32>,
    /// How many collisions it has made at that instant.
    pub collisions: u64,
}

impl From<&Collapse> for CollapseReport {
    fn from(collapse: &Collapse) -> Self {
        CollapseReport {
            time: collapse.time.units(),
            particles: collapse.particles.iter().map(|id| id.0).collect(),
            collisions: collapse.collisions,
        }
    }
}

/// Numbers of events.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct EventCounts {
    /// Physical events: all but transfers and checks that passed.
    pub total: u64,
    /// Collisions of two mobile grains.
    pub pair: u64,
    /// Collisions with a static grain that stayed.
    pub frozen: u64,
    /// Collisions that woke a frozen grain.
    pub wake: u64,
    /// Grains that fell asleep.
    pub sleep: u64,
    /// Self-checks made.
    pub check: u64,
    /// Times a sleeper was asked since a grain that it leans on had changed. Programs
    /// that did not count it asked nobody.
    #[serde(default)]
    pub support: u64,
    /// Of both, those that woke a grain.
    pub check_wake: u64,
    /// Collisions with walls.
    pub wall: u64,
    /// Crossings from one cell of the search grid to the next.
    pub transfer: u64,
    /// Collisions that the cut-off V_c made elastic.
    pub elastic: u64,
    /// Times a guard acted.
    pub guard: u64,
}

impl From<&Counts> for EventCounts {
    fn from(counts: &Counts) -> Self {
        EventCounts {
            total: counts.total(),
            pair: counts.pair,
            frozen: counts.frozen,
            wake: counts.wake,
            sleep: counts.sleep,
            check: counts.check,
            support: counts.support,
            check_wake: counts.check_wake,
            wall: counts.wall,
            transfer: counts.transfer,
            elastic: counts.elastic,
            guard: counts.guard,
        }
    }
}

/// Numbers of grains.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ParticleCounts {
    /// All.
    pub total: usize,
    /// Normal ones.
    pub normal: usize,
    /// Frozen ones.
    pub frozen: usize,
    /// Falling ones.
    pub falling: usize,
    /// Fixed ones.
    pub fixed: usize,
}

impl From<ModeCounts> for ParticleCounts {
    fn from(modes: ModeCounts) -> Self {
        ParticleCounts {
            total: modes.total(),
            normal: modes.normal,
            frozen: modes.frozen,
            falling: modes.falling,
            fixed: modes.fixed,
        }
    }
}

/// The energy ledger: by how much the total energy of all grains but fixed
/// ones has changed, and what changed it. What is lost counts negative.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EnergyReport {
    /// Kinetic and potential energy at the start.
    pub at_start: f64,
    /// The same at the end.
    pub at_end: f64,
    /// By collisions of two mobile grains.
    pub pair: f64,
    /// By collisions with static grains that stayed.
    pub frozen: f64,
    /// By collisions that woke a frozen grain.
    pub wake: f64,
    /// By collisions with walls.
    pub wall: f64,
    /// By falling asleep.
    pub sleep: f64,
    /// Given to grains that woke.
    pub given_back: f64,
    /// By falling at constant velocity.
    pub fall: f64,
    /// By guards.
    pub guard: f64,
    /// By grains and walls that move as prescribed.
    pub moving: f64,
    /// By growing diameters.
    pub growth: f64,
    /// By crossing periodic sides against which gravity leans.
    pub crossing: f64,
    /// Work of gravity that turns.
    #[serde(default)]
    pub field: f64,
    /// By grains that were inserted.
    pub inserted: f64,
    /// All of these together.
    pub sum: f64,
    /// What they leave unexplained of the change, over the sum of their sizes:
    /// rounding.
    pub relative_error: f64,
    /// Not in the sum: what collisions below V_c would have cost.
    pub elastic_spared: f64,
}

impl From<EnergyLedger> for EnergyReport {
    fn from(ledger: EnergyLedger) -> Self {
        // No minus sign on nothing.
        let plain = |energy: f64| energy + 0.0;
        EnergyReport {
            at_start: plain(ledger.at_start),
            at_end: plain(ledger.now),
            pair: plain(ledger.pair),
            frozen: plain(ledger.frozen),
            wake: plain(ledger.wake),
            wall: plain(ledger.wall),
            sleep: plain(ledger.sleep),
            given_back: plain(ledger.given_back),
            fall: plain(ledger.fall),
            guard: plain(ledger.guard),
            moving: plain(ledger.moving),
            growth: plain(ledger.growth),
            crossing: plain(ledger.crossing),
            field: plain(ledger.field),
            inserted: plain(ledger.inserted),
            sum: plain(ledger.sum()),
            relative_error: plain(ledger.relative_error()),
            elastic_spared: plain(ledger.elastic_spared),
        }
    }
}

impl fmt::Display for EnergyReport {
    /// The change and its largest parts, on one line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut parts = [
            ("pair", self.pair),
            ("frozen", self.frozen),
            ("wake", self.wake),
            ("wall", self.wall),
            ("sleep", self.sleep),
            ("given back", self.given_back),
            ("fall", self.fall),
            ("guard", self.guard),
            ("moving", self.moving),
            ("growth", self.growth),
            ("crossing", self.crossing),
            ("field", self.field),
            ("inserted", self.inserted),
        ];
        parts.sort_by(|one, other| other.1.abs().total_cmp(&one.1.abs()));
        write!(f, "{:+.4e}", self.sum)?;
        let largest = parts.iter().take(4).filter(|(_, energy)| *energy != 0.0);
        for (place, (name, energy)) in largest.enumerate() {
            let before = if place == 0 { " = " } else { ", " };
            write!(f, "{before}{name} {energy:+.3e}")?;
        }
        if parts[4].1 != 0.0 {
            write!(f, ", …")?;
        }
        Ok(())
    }
}

/// A packing fraction and the heights between which it was taken.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FractionReport {
    /// Volume of the grains over volume.
    pub value: f64,
    /// From this height, in d.
    pub from: f64,
    /// To this height, in d.
    pub to: f64,
}

impl fmt::Display for Summary {
    /// For people.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let reason = match self.stop_reason {
            StoppedBy::Events if self.particles.normal + self.particles.falling == 0 => {
                "nothing moves"
            }
            reason => reason.words(),
        };
        writeln!(f, "stopped at t = {:.6}: {reason}", self.time)?;
        if let Some(error) = &self.error {
            writeln!(f, "  error             {error}")?;
        }
        if let Some(collapse) = &self.collapse {
            let names: Vec<String> = collapse.particles.iter().map(u32::to_string).collect();
            writeln!(
                f,
                "  collapse          {} collisions of grain {}",
                collapse.collisions,
                names.join(", touching ")
            )?;
        }
        let events = &self.events;
        let grains = &self.particles;
        writeln!(
            f,
            "  grains            {} = {} normal + {} falling + {} frozen + {} fixed",
            grains.total, grains.normal, grains.falling, grains.frozen, grains.fixed
        )?;
        writeln!(
            f,
            "  events            {} = {} pair + {} frozen + {} wake + {} sleep + {} wall + {} check wake",
            events.total,
            events.pair,
            events.frozen,
            events.wake,
            events.sleep,
            events.wall,
            events.check_wake
        )?;
        if let Some(fraction) = &self.packing_fraction {
            writeln!(
                f,
                "  packing fraction  {:.4} between z = {:.2} and {:.2}",
                fraction.value, fraction.from, fraction.to
            )?;
        }
        if let Some(mean) = self.mean_normal {
            writeln!(f, "  mean normal       {mean:.1} grains")?;
        }
        writeln!(
            f,
            "  energy            {:.6e} kinetic, {:.6e} potential",
            self.kinetic_energy, self.potential_energy
        )?;
        writeln!(f, "  energy change     {}", self.energy_ledger)?;
        writeln!(f, "  deepest overlap   {:.1e} d", self.max_overlap)?;
        writeln!(
            f,
            "  processor time    {:.1} s, {:.0} events per second",
            self.cpu_seconds, self.events_per_second
        )?;
        write!(f, "  trajectory hash   {}", self.trajectory_hash)
    }
}
