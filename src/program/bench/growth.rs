//! `grainfall bench growth`: processor time against simulated time (Fig. 5 of
//! the paper).

use crate::engine::{Limits, StopReason};
use crate::error::SetupError;
use crate::program::bench::arguments::GrowthArguments;
use crate::program::bench::deposition::{Rain, sampled};
use crate::program::bench::memory::Memory;
use crate::program::bench::table::Table;
use crate::program::error::ProgramError;
use crate::program::progress::Progress;
use crate::time::Time;

const COLUMNS: [&str; 7] = [
    "sleep_speed",
    "time",
    "processor_seconds",
    "events",
    "falling",
    "normal",
    "frozen",
];

pub(super) fn measure(arguments: &GrowthArguments) -> Result<u8, ProgramError> {
    let small = arguments.quick;
    let count = arguments.count.unwrap_or(if small { 200 } else { 1500 });
    let width = arguments.width.unwrap_or(if small { 4.0 } else { 10.0 });
    let elastic_speed = arguments
        .elastic_speed
        .unwrap_or(if small { 1.0e-3 } else { 1.0e-4 });
    let endless_until = if small { 6.0 } else { 30.0 };
    for &speed in &arguments.sleep_speeds {
        if !(speed >= 0.0 && speed.is_finite()) {
            return Err(SetupError::Parameter {
                field: "sleep_speeds",
                value: speed,
                allowed: "numbers from 0 on are allowed",
            }
            .into());
        }
    }
    let mut table = Table::new(&COLUMNS, arguments.out.as_deref())?;
    let mut stopped_early = false;
    for &sleep_speed in &arguments.sleep_speeds {
        let rain = Rain {
            count,
            width,
            sleep_speed,
            elastic_speed,
            seed: arguments.seed,
        };
        let mut simulation = rain.simulation(&Memory::before())?;
        // Without sleep it would take for ever.
        let until = match arguments.until {
            Some(until) => Time::from_units(until),
            None if sleep_speed == 0.0 => Time::from_units(endless_until),
            None => Time::NEVER,
        };
        let limits = Limits {
            time: until,
            all_frozen: true,
            ..Limits::default()
        };
        let end = rain.last_landing().min(until.units());
        let mut progress = Progress::new(false, None);
        let (_, reason) = sampled(
            &mut simulation,
            arguments.step,
            &limits,
            &mut (),
            |simulation, cost| {
                let modes = simulation.mode_counts();
                let time = simulation.time().units();
                progress.show(time, simulation.counts().total(), time / end);
                table.row(&[
                    sleep_speed.to_string(),
                    format!("{time:.3}"),
                    format!("{:.4}", cost.seconds),
                    cost.events.to_string(),
                    modes.falling.to_string(),
                    modes.normal.to_string(),
                    modes.frozen.to_string(),
                ])
            },
        )?;
        progress.finish();
        stopped_early |= matches!(reason, StopReason::Collapse(_) | StopReason::Escaped(_));
    }
    Ok(if stopped_early { 3 } else { 0 })
}
