//! How far a run has got, and how it ended.

use crate::analysis;
use crate::model::Model;
use crate::output::{FractionReport, Summary};
use crate::program::drive::files::plain;
use crate::program::drive::{End, Run};

impl<M: Model<D>, const D: usize> Run<'_, M, D> {
    /// How much is done, as far as that can be known, 0 … 1.
    pub(super) fn share(&self) -> f64 {
        let stop = &self.scenario.stop;
        let time = stop
            .time
            .map_or(0.0, |end| self.simulation.time().units() / end);
        let events = stop.events.map_or(0.0, |end| {
            self.simulation.counts().total() as f64 / end as f64
        });
        let of = |done: usize, all: usize| {
            if all > 0 {
                done as f64 / all as f64
            } else {
                0.0
            }
        };
        let landed = of(self.watch.normal.landed(), self.rain);
        let dropped = self
            .dropper
            .as_ref()
            .map_or(0.0, |dropper| of(dropper.dropped, dropper.count));
        let deposited = if stop.all_frozen.unwrap_or(true) {
            if self.dropper.is_some() {
                dropped
            } else {
                landed
            }
        } else {
            0.0
        };
        time.max(events).max(deposited).clamp(0.0, 1.0)
    }

    /// How it ended, for `summary.json`.
    pub(super) fn summary(&self, end: End) -> Summary {
        let cpu_seconds = self.cpu_seconds();
        let simulation = &self.simulation;
        let counts = simulation.counts();
        let grains = simulation.snapshot();
        let area = self.scenario.deposit_area();
        let fraction = area.and_then(|area| analysis::packing_fraction(&grains, area));
        let from = self.scenario.output.mean_normal_from;
        Summary {
            title: self.scenario.title.clone(),
            time: simulation.time().units(),
            stop_reason: end.reason,
            error: end.error,
            collapse: end.collapse,
            seed: self.scenario.seed,
            events: counts.into(),
            particles: simulation.mode_counts().into(),
            kinetic_energy: simulation.kinetic_energy(),
            potential_energy: plain(simulation.potential_energy()),
            energy_ledger: simulation.energy_ledger().into(),
            packing_fraction: fraction.map(|slab| FractionReport {
                value: slab.value,
                from: slab.from,
                to: slab.to,
            }),
            mean_normal: area.and_then(|_| self.watch.normal.mean(from)),
            max_overlap: simulation.max_overlap(),
            cpu_seconds,
            events_per_second: if cpu_seconds > 0.0 {
                counts.total() as f64 / cpu_seconds
            } else {
                0.0
            },
            trajectory_hash: format!("{:016x}", self.watch.hash.value()),
            version: env!("CARGO_PKG_VERSION").to_owned(),
        }
    }
}
