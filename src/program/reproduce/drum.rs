//! Figs. 6 and 7: the rotating drum.

mod field;

use crate::analysis::{blocked_mean, line_fit};
use crate::draw;
use crate::plot::{Axis, Chart, Map, Series};
use crate::program::error::ProgramError;
use crate::program::estimate::Estimate;
use crate::program::reproduce::drum::field::{
    BIN, CLOSE_PACKING, Surface, field, profile, seen, surface,
};
use crate::program::reproduce::effort::Effort;
use crate::program::reproduce::pictures::side_by_side;
use crate::program::reproduce::row::Row;
use crate::program::reproduce::runs::RunSpec;
use crate::program::reproduce::{Context, Report, csv_of};

/// A drum at some V_wakeup.
struct Turned {
    run: RunSpec,
    wake_speed: f64,
    rate: f64,
    radius: f64,
    /// From when on frames count.
    from: f64,
    /// Whether it has become stationary by then.
    stationary: bool,
    /// Whether the ground turns, not gravity.
    ground: bool,
}

/// The drum of Fig. 6, then those of Fig. 7, then the one that truly turns.
fn drums(effort: &Effort) -> Vec<Turned> {
    let drum = |wake_speed: f64, from: f64, until: f64, stationary: bool, ground: bool| {
        let preset = match (effort.quick, ground) {
            (true, _) => "drum2d",
            (false, false) => "drum",
            (false, true) => "drum-turning",
        };
        let kind = if ground { "ground" } else { "gravity" };
        let mut set = vec![
            format!("parameters.wake_speed={wake_speed:?}"),
            format!("stop.time={until:?}"),
            format!("rotation.of=\"{kind}\""),
        ];
        if !stationary {
            set.push(format!("output.frames_every={:?}", (until - from) / 20.0));
        }
        Turned {
            run: RunSpec {
                name: format!("drum-{kind}_W={wake_speed}"),
                preset,
                seed: 1,
                set,
            },
            wake_speed,
            rate: if effort.quick { 0.1 } else { 0.075 },
            radius: if effort.quick { 10.0 } else { 25.0 },
            from,
            stationary,
            ground,
        }
    };
    if effort.quick {
        return vec![
            drum(0.5, 30.0, 60.0, true, false),
            drum(0.25, 30.0, 60.0, true, false),
            drum(0.5, 30.0, 60.0, true, true),
        ];
    }
    vec![
        drum(0.5, 50.0, 218.0, true, false),
        drum(0.25, 50.0, 90.0, true, false),
        drum(0.05, 16.0, 18.0, false, false),
        drum(0.01, 1.5, 2.0, false, false),
        drum(0.5, 50.0, 90.0, true, true),
    ]
}

pub(super) fn map_runs(effort: &Effort) -> Vec<RunSpec> {
    drums(effort)
        .into_iter()
        .take(1)
        .map(|drum| drum.run)
        .collect()
}

pub(super) fn profile_runs(effort: &Effort) -> Vec<RunSpec> {
    drums(effort).into_iter().map(|drum| drum.run).collect()
}

/// Fig. 6: a snapshot, and where the grains are on the average.
pub(super) fn map(context: &Context<'_>) -> Result<Report, ProgramError> {
    let drums = drums(&context.effort);
    let drum = &drums[0];
    let frames = context.finished.frames(&drum.run)?;
    let field = field(drum, &frames)?;
    let surface = surface(drum, &field)?;
    let [low, high] = [field.bins.from(), field.bins.to()];
    let columns = field.bins.count();
    let map = Map::new(
        "mean packing fraction",
        columns,
        field.values.clone(),
        [low, high],
        [low, high],
    )
    .with_axes(Axis::new("x", "d"), Axis::new("z", "d"), Axis::new("φ", ""))
    .with_level(0.5 * CLOSE_PACKING, "0.5 φ_RCP")
    .with_level(0.25 * CLOSE_PACKING, "0.25 φ_RCP")
    .with_level(0.75 * CLOSE_PACKING, "0.75 φ_RCP");
    let last = frames.last().map(|frame| {
        let mut upright = frame.clone();
        let up = if frame.dimension == 2 { 1 } else { 2 };
        for (grain, seen) in upright.grains.iter_mut().zip(seen(drum, frame)) {
            grain.position[0] = seen.position[0];
            grain.position[up] = seen.position[2];
        }
        draw::svg(&upright)
    });
    let pictures: Vec<String> = last.into_iter().chain([map.to_svg()?]).collect();
    let table: Vec<Vec<String>> = field
        .values
        .iter()
        .enumerate()
        .map(|(cell, value)| {
            let (x, z) = (
                field.bins.centre(cell % columns),
                field.bins.centre(cell / columns),
            );
            [x, z, *value].map(|part| part.to_string()).to_vec()
        })
        .collect();
    let series = context.finished.series(&drum.run)?;
    let shares: Vec<f64> = series
        .iter()
        .filter(|row| row.time >= drum.from)
        .map(|row| row.normal / (row.normal + row.frozen))
        .collect();
    let share = blocked_mean(&shares);
    let (angle, error) = surface.0.angle();
    let of = "Fig. 6";
    Ok(Report {
        rows: vec![
            Row::shown(
                of,
                "angle of the free surface at the centre, in degrees",
                Estimate {
                    mean: angle.abs(),
                    error,
                },
                1,
                format!(
                    "The paper gives none. Of {} frames; the surface is where φ = 0.5 φ_RCP; it is \
                     S-shaped, and the error is that of the straight line.",
                    field.frames
                ),
            ),
            Row::shown(
                of,
                "share of normal grains",
                Estimate {
                    mean: share.value,
                    error: share.error,
                },
                1,
                "The paper gives none.",
            ),
        ],
        files: vec![
            ("fig6.svg".to_owned(), side_by_side(&pictures)),
            (
                "fig6.csv".to_owned(),
                csv_of(&["x", "z", "packing_fraction"], &table)?,
            ),
        ],
    })
}

/// Fig. 7: velocity profiles.
pub(super) fn profiles(context: &Context<'_>) -> Result<Report, ProgramError> {
    let mut chart = Chart::new("Fig. 7: velocity profiles at the centre")
        .with_axes(Axis::new("depth", "d"), Axis::new("velocity", "√(gd)"));
    let (mut rows, mut table) = (Vec::new(), Vec::new());
    let of = "Fig. 7";
    for drum in drums(&context.effort) {
        let frames = context.finished.frames(&drum.run)?;
        let field = field(&drum, &frames)?;
        let surface = surface(&drum, &field)?;
        let (bins, means) = profile(&drum, &frames, &surface)?;
        let mut name = format!("V_wakeup = {}", drum.wake_speed);
        if drum.ground {
            name += ", truly turning";
        }
        if !drum.stationary {
            name += ", not stationary";
        }
        let points = bins
            .centres()
            .into_iter()
            .zip(means.iter().map(|mean| mean.value));
        let points: Vec<[f64; 2]> = points.map(<[f64; 2]>::from).collect();
        let errors: Vec<f64> = means.iter().map(|mean| mean.error).collect();
        for ([depth, speed], error) in points.iter().zip(&errors) {
            table.push(vec![
                name.clone(),
                depth.to_string(),
                speed.to_string(),
                error.to_string(),
            ]);
        }
        chart = chart.with(Series::line(name.clone(), points.clone()).with_errors(errors.clone()));
        rows.extend(numbers(of, &drum, &name, &surface, &points, &errors));
    }
    Ok(Report {
        rows,
        files: vec![
            ("fig7.svg".to_owned(), chart.to_svg()?),
            (
                "fig7.csv".to_owned(),
                csv_of(&["drum", "depth", "velocity", "error"], &table)?,
            ),
        ],
    })
}

/// What a profile says in numbers.
fn numbers(
    of: &'static str,
    drum: &Turned,
    name: &str,
    surface: &Surface,
    points: &[[f64; 2]],
    errors: &[f64],
) -> Vec<Row> {
    let mut rows = Vec::new();
    // The depth from which on nothing moves by more than a thousandth of the
    // fastest layer.
    let fastest = points
        .iter()
        .map(|point| point[1].abs())
        .fold(0.0, f64::max);
    let still = points
        .iter()
        .rposition(|point| point[1].abs() > 1.0e-3 * fastest)
        .map_or(0.0, |last| points[last][0] + 0.5 * BIN);
    let row = Row::shown(
        of,
        format!("depth below the axis from which on it rests, in d; {name}"),
        Estimate {
            mean: still + surface.depth(),
            error: 0.5 * BIN,
        },
        1,
        "Where the velocity falls below a thousandth of the highest. With V_wakeup = 0.5 the paper \
         has two thirds of the radius, not saying from where; with 0.05 and less no frozen region. \
         Depths in the figure count from the surface, which lies below the axis by what the next \
         row says.",
    );
    let two_thirds = 2.0 / 3.0 * drum.radius;
    rows.push(if drum.wake_speed == 0.5 && !drum.ground {
        row.beside(two_thirds, 0.5, 0.5)
    } else {
        row
    });
    let sunk = Estimate {
        mean: surface.depth(),
        error: 0.5 * BIN,
    };
    let what = format!("depth of the free surface below the axis, in d; {name}");
    rows.push(Row::shown(of, what, sunk, 1, ""));
    if !drum.stationary {
        return rows;
    }
    // Linear where it is fast, and how fast it dies out where it is slow.
    let linear: Vec<[f64; 2]> = points
        .iter()
        .copied()
        .filter(|point| point[1] > 0.15 * fastest && point[0] > 1.0)
        .collect();
    if let Some(fit) = line_fit(&linear, None) {
        let gradient = Estimate {
            mean: -fit.slope,
            error: fit.slope_error,
        };
        let what = format!("velocity gradient of the flowing layer, in √(g/d); {name}");
        rows.push(Row::shown(
            of,
            what,
            gradient,
            1,
            "A straight line, as in the paper.",
        ));
    }
    let tail: Vec<[f64; 2]> = points
        .iter()
        .zip(errors)
        .filter(|(point, error)| {
            point[1] > 4.0 * **error && point[1] < 0.15 * fastest && point[1] > 1.0e-3 * fastest
        })
        .map(|(point, _)| [point[0], libm::log(point[1])])
        .collect();
    if let Some(fit) = line_fit(&tail, None)
        && tail.len() > 2
    {
        let slope = -fit.slope;
        let length = Estimate {
            mean: 1.0 / slope,
            error: fit.slope_error / (slope * slope),
        };
        let what = format!("decay length of the tail, in d; {name}");
        let words = format!(
            "Of {} layers: an exponential if the fit's error is small; the paper leaves it open.",
            tail.len()
        );
        rows.push(Row::shown(of, what, length, 1, words));
    }
    rows
}
