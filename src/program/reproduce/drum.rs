//! Figs. 6 and 7: the rotating drum.

use crate::analysis::{
    Bins, Container, Mean, blocked_mean, fraction_map, line_fit, surface_of_map,
};
use crate::draw;
use crate::output::Frame;
use crate::particle::{Mode, Particle, Vector};
use crate::plot::{Axis, Chart, Map, Series};
use crate::program::error::ProgramError;
use crate::program::estimate::Estimate;
use crate::program::reproduce::effort::Effort;
use crate::program::reproduce::pictures::side_by_side;
use crate::program::reproduce::row::Row;
use crate::program::reproduce::runs::RunSpec;
use crate::program::reproduce::{Context, Report, csv_of};
use crate::time::Time;

/// φ of random close packing, to which the paper refers its lines.
const CLOSE_PACKING: f64 = 0.64;
/// Half the width of the slab in which velocities are measured, in d.
const SLAB: f64 = 2.0;
/// Width of the bins of depth, in d.
const BIN: f64 = 1.0;

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

/// The grains of a frame as they are seen from outside, in the plane of the drum
/// and along its axis, with velocities relative to the drum.
fn seen(drum: &Turned, frame: &Frame) -> Vec<Particle<3>> {
    // In the plane, up is y; in space it is z.
    let up = if frame.dimension == 2 { 1 } else { 2 };
    let angle = if drum.ground {
        0.0
    } else {
        drum.rate * frame.time.units()
    };
    let (sin, cos) = libm::sincos(angle);
    let turned = |v: &Vector<3>| {
        let along = if up == 2 { v[1] } else { 0.0 };
        Vector::<3>::new(v[0] * cos - v[up] * sin, along, v[0] * sin + v[up] * cos)
    };
    let of = |grain: &Particle<3>| {
        let mut seen = *grain;
        seen.position = turned(&grain.position);
        seen.velocity = turned(&grain.velocity);
        if drum.ground {
            let place = seen.position;
            seen.velocity -= Vector::<3>::new(-place[2], 0.0, place[0]) * drum.rate;
        }
        seen
    };
    frame.grains.iter().map(of).collect()
}

/// Frames from when on they count.
fn counted<'a>(drum: &'a Turned, frames: &'a [Frame]) -> impl Iterator<Item = &'a Frame> {
    frames
        .iter()
        .filter(|frame| frame.time >= Time::from_units(drum.from))
}

/// The mean packing fraction over the plane of the drum.
struct Field {
    bins: Bins,
    values: Vec<f64>,
    frames: usize,
}

fn field(drum: &Turned, frames: &[Frame]) -> Result<Field, ProgramError> {
    let bins = Bins::of_width(-drum.radius - 1.0, drum.radius + 1.0, 0.5)?;
    let mut sums = vec![0.0; bins.count() * bins.count()];
    let mut count = 0;
    for frame in counted(drum, frames) {
        let free: Vec<Particle<3>> = seen(drum, frame)
            .into_iter()
            .filter(|grain| grain.mode != Mode::Fixed)
            .collect();
        let values = if frame.dimension == 2 {
            let flat = |grain: &Particle<3>| Particle::<2> {
                position: Vector::<2>::new(grain.position[0], grain.position[2]),
                velocity: Vector::<2>::zeros(),
                diameter: grain.diameter,
                mass: grain.mass,
                mode: grain.mode,
            };
            let edge = 2.0 * drum.radius + 2.0;
            let corner = Vector::<2>::repeat(-0.5 * edge);
            let container = Container::new(corner, Vector::<2>::repeat(edge), [false; 2])?;
            let flat: Vec<Particle<2>> = free.iter().map(flat).collect();
            fraction_map(&flat, &container, [0, 1], &bins, &bins)?
        } else {
            let edge = 2.0 * drum.radius + 2.0;
            let corner = Vector::<3>::new(-0.5 * edge, frame.origin[1], -0.5 * edge);
            let lengths = Vector::<3>::new(edge, frame.lengths[1], edge);
            let container = Container::new(corner, lengths, [false, true, false])?;
            fraction_map(&free, &container, [0, 2], &bins, &bins)?
        };
        for (sum, value) in sums.iter_mut().zip(values) {
            *sum += value;
        }
        count += 1;
    }
    if count == 0 {
        return Err(ProgramError::Reproduction {
            what: format!(
                "the run {} has no frames from t = {} on",
                drum.run.name, drum.from
            ),
        });
    }
    let values = sums.into_iter().map(|sum| sum / f64::from(count)).collect();
    Ok(Field {
        bins,
        values,
        frames: count as usize,
    })
}

/// The free surface at the centre: its height, and its slope with an error.
struct Surface {
    height: f64,
    slope: f64,
    slope_error: f64,
}

fn surface(drum: &Turned, field: &Field) -> Result<Surface, ProgramError> {
    let points = surface_of_map(&field.values, &field.bins, &field.bins, 0.5 * CLOSE_PACKING)?;
    let near: Vec<[f64; 2]> = points
        .into_iter()
        .filter(|[x, height]| x.abs() < 0.16 * drum.radius && height.is_finite())
        .collect();
    let fit = line_fit(&near, None).ok_or_else(|| ProgramError::Reproduction {
        what: format!("{} has no free surface at its centre", drum.run.name),
    })?;
    Ok(Surface {
        height: fit.intercept,
        slope: fit.slope,
        slope_error: fit.slope_error,
    })
}

/// Mean velocities along the surface by depth below it, in a thin slab across it
/// at the centre.
fn profile(
    drum: &Turned,
    frames: &[Frame],
    surface: &Surface,
) -> Result<(Bins, Vec<Mean>), ProgramError> {
    let deepest = libm::floor(drum.radius - 1.0);
    let bins = Bins::of_width(0.0, deepest, BIN)?;
    let length = libm::sqrt(1.0 + surface.slope * surface.slope);
    let (cos, sin) = (1.0 / length, surface.slope / length);
    let mut columns = vec![Vec::new(); bins.count()];
    for frame in counted(drum, frames) {
        let mut sums = vec![(0.0, 0.0); bins.count()];
        for grain in seen(drum, frame) {
            if grain.mode == Mode::Fixed {
                continue;
            }
            let (x, z) = (grain.position[0], grain.position[2] - surface.height);
            let along = x * cos + z * sin;
            let depth = x * sin - z * cos;
            let (true, Some(bin)) = (along.abs() < SLAB, bins.bin_of(depth)) else {
                continue;
            };
            // Down the slope counts positive.
            let speed = grain.velocity[0] * cos + grain.velocity[2] * sin;
            let down = if surface.slope > 0.0 { -speed } else { speed };
            sums[bin].0 += down;
            sums[bin].1 += 1.0;
        }
        for (column, (sum, count)) in columns.iter_mut().zip(sums) {
            if count > 0.0 {
                column.push(sum / count);
            }
        }
    }
    Ok((
        bins,
        columns.iter().map(|column| blocked_mean(column)).collect(),
    ))
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
    let angle = libm::atan(surface.slope).to_degrees();
    let error = (surface.slope_error / (1.0 + surface.slope * surface.slope)).to_degrees();
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
        rows.extend(numbers(of, &drum, &name, &points, &errors));
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
        format!("depth below which it rests, in d; {name}"),
        Estimate {
            mean: still,
            error: 0.5 * BIN,
        },
        1,
        "Where the velocity falls below a thousandth of the highest. With V_wakeup = 0.5 the paper \
         has two thirds of the radius; with 0.05 and less no frozen region.",
    );
    let two_thirds = 2.0 / 3.0 * drum.radius;
    rows.push(if drum.wake_speed == 0.5 && !drum.ground {
        row.beside(two_thirds, 0.5, 0.5)
    } else {
        row
    });
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
