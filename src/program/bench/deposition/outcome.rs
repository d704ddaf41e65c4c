//! What `grainfall bench deposition` says.

use serde::Serialize;

use crate::engine::Counts;
use crate::program::bench::gas::bytes_of;

/// What came out.
#[derive(Debug, Serialize)]
pub(super) struct Outcome {
    pub(super) benchmark: &'static str,
    pub(super) count: usize,
    pub(super) fixed: usize,
    pub(super) width: f64,
    pub(super) sleep_speed: f64,
    pub(super) elastic_speed: f64,
    pub(super) seed: u64,
    pub(super) setup_seconds: f64,
    pub(super) seconds_before: f64,
    pub(super) from: f64,
    pub(super) until: f64,
    pub(super) ended: String,
    pub(super) processor_seconds: f64,
    /// Physical events.
    pub(super) events: u64,
    pub(super) nanoseconds_per_event: f64,
    pub(super) events_per_second: f64,
    pub(super) by_kind: Counts,
    pub(super) normal: usize,
    pub(super) falling: usize,
    pub(super) frozen: usize,
    pub(super) peak_bytes_per_particle: Option<f64>,
    pub(super) bytes_per_particle: Option<f64>,
    /// Of the whole run only.
    pub(super) packing_fraction: Option<f64>,
    pub(super) mean_normal: Option<f64>,
    pub(super) deepest_overlap: f64,
    pub(super) trajectory_hash: Option<String>,
}

impl std::fmt::Display for Outcome {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let kinds = &self.by_kind;
        writeln!(
            f,
            "deposition, {} grains on {:.2} d × {:.2} d with {} fixed ones, V_t = {}, V_c = {}",
            self.count, self.width, self.width, self.fixed, self.sleep_speed, self.elastic_speed
        )?;
        writeln!(
            f,
            "  set-up           {:.2} s; then {:.2} s up to the window",
            self.setup_seconds, self.seconds_before
        )?;
        writeln!(
            f,
            "  window           t = {:.3} … {:.3}, {}",
            self.from, self.until, self.ended
        )?;
        writeln!(
            f,
            "  timed            {} events: {:.3} s of processor time",
            self.events, self.processor_seconds
        )?;
        writeln!(
            f,
            "  an event         {:.1} ns, {:.0} a second",
            self.nanoseconds_per_event, self.events_per_second
        )?;
        writeln!(
            f,
            "  by kind          {} pair + {} frozen + {} wake + {} sleep + {} wall + {} check wake",
            kinds.pair, kinds.frozen, kinds.wake, kinds.sleep, kinds.wall, kinds.check_wake
        )?;
        writeln!(
            f,
            "  of these         {} elastic; guards acted {} times; lists made {:.4} an event",
            kinds.elastic,
            kinds.guard,
            kinds.transfer as f64 / self.events as f64
        )?;
        writeln!(
            f,
            "  at the end       {} falling, {} normal, {} frozen",
            self.falling, self.normal, self.frozen
        )?;
        writeln!(
            f,
            "  memory           {}",
            bytes_of(self.peak_bytes_per_particle, self.bytes_per_particle)
        )?;
        if let Some(fraction) = self.packing_fraction {
            writeln!(f, "  φ                {fraction:.4}")?;
        }
        if let Some(mean) = self.mean_normal {
            writeln!(
                f,
                "  normal grains    {mean:.1} in the mean while the heap grows"
            )?;
        }
        write!(
            f,
            "  deepest overlap  {:.1e} d since the start",
            self.deepest_overlap
        )?;
        if let Some(hash) = &self.trajectory_hash {
            write!(f, "\n  trajectory hash  {hash}")?;
        }
        Ok(())
    }
}
