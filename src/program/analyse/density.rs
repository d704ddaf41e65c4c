//! Packing fractions: profile, map, free surface.

use crate::analysis::{
    Bins, LineFit, Mean, Profile, blocked_mean, fraction_map, fraction_profile, line_fit,
    packing_fraction, surface_of_grains, surface_of_map,
};
use crate::plot::{Axis, Chart, Map, Marker, Series};
use crate::program::analyse::Task;
use crate::program::analyse::arguments::axis_name;
use crate::program::analyse::finding::{Columns, Finding, with_error};
use crate::program::analyse::frames::is_free;
use crate::program::error::ProgramError;

/// Bins a diameter.
const FINE: f64 = 2.0;
/// Of equal disks and spheres, packed at random as closely as they go.
const RANDOM_CLOSE: [f64; 2] = [0.84, 0.64];

/// Of the densest crystals, a little rounded up: the end of scales.
const DENSEST: [f64; 2] = [0.91, 0.75];

/// The packing fraction that is taken for the free surface.
fn level<const D: usize>(task: &Task<'_, D>) -> f64 {
    let close = RANDOM_CLOSE[usize::from(D == 3)];
    task.options.level.unwrap_or(0.5 * close)
}

pub(super) fn profile<const D: usize>(task: &Task<'_, D>) -> Result<Finding, ProgramError> {
    let axis = task.axis()?;
    let bins = task.bins(axis, FINE)?;
    let frames = task
        .samples
        .iter()
        .map(|sample| fraction_profile(&sample.grains, &sample.container, axis, &bins))
        .collect::<Result<Vec<_>, _>>()?;
    let profile = Profile::of_frames(&bins, frames.iter().map(Vec::as_slice));
    let name = axis_name(axis);
    let mut table = Columns::new([name, "packing_fraction", "error", "frames"]);
    table.profile(&profile);
    let values: Vec<f64> = profile.means.iter().map(|mean| mean.value).collect();
    let chart = Chart::new("Packing fraction in slabs")
        .with_axes(Axis::new(name, "d"), Axis::new("packing fraction φ", ""))
        .with(Series::steps("", &bins.edges(), &values).with_colour([0x00, 0x72, 0xb2]))
        .with(
            Series::points("", profile.points())
                .with_marker(Marker::Dot)
                .with_errors(profile.errors())
                .with_colour([0x00, 0x72, 0xb2]),
        );
    let mut words = Vec::new();
    // A heap that fills the box sideways has a height.
    let level = task.samples.iter().all(|sample| {
        sample.container.periodic[..D - 1]
            .iter()
            .all(|periodic| *periodic)
    });
    let inner: Vec<f64> = task
        .samples
        .iter()
        .filter_map(|sample| {
            let area = sample.container.cross_section(D - 1);
            Some(packing_fraction(&sample.grains, area)?.value)
        })
        .collect();
    if axis == D - 1 && level && !inner.is_empty() {
        let mean = blocked_mean(&inner);
        words.push(format!(
            "φ = {} between 25 % and 75 % of the heap's height",
            with_error(&mean)
        ));
    }
    words.push(format!(
        "{} slabs across {name}, {:.3} d thick",
        bins.count(),
        bins.width()
    ));
    Ok(Finding {
        name: "profile",
        words,
        table,
        picture: chart.to_svg()?,
    })
}

/// The mean map over all samples, and its bins.
fn mean_map<const D: usize>(
    task: &Task<'_, D>,
    each: f64,
) -> Result<(Bins, Bins, Vec<f64>), ProgramError> {
    let axes = [task.across()?, D - 1];
    let across = task.bins(axes[0], each)?;
    // Cells as high as they are wide.
    let (low, high) = task.extent(axes[1])?;
    let up = Bins::of_width(low, high, across.width())?;
    let mut sum = vec![0.0; across.count() * up.count()];
    for sample in task.samples {
        let map = fraction_map(&sample.grains, &sample.container, axes, &across, &up)?;
        for (sum, value) in sum.iter_mut().zip(map) {
            *sum += value;
        }
    }
    let frames = task.samples.len() as f64;
    let mean = sum.into_iter().map(|sum| sum / frames).collect();
    Ok((across, up, mean))
}

pub(super) fn map<const D: usize>(task: &Task<'_, D>) -> Result<Finding, ProgramError> {
    let (across, up, values) = mean_map(task, FINE)?;
    let [first, second] = [axis_name(task.across()?), axis_name(D - 1)];
    let mut table = Columns::new([first, second, "packing_fraction"]);
    for row in 0..up.count() {
        for column in 0..across.count() {
            let value = values[row * across.count() + column];
            table.numbers([across.centre(column), up.centre(row), value]);
        }
    }
    let close = RANDOM_CLOSE[usize::from(D == 3)];
    let mut map = Map::new(
        "Packing fraction",
        across.count(),
        values,
        [across.from(), across.to()],
        [up.from(), up.to()],
    )
    .with_axes(
        Axis::new(first, "d"),
        Axis::new(second, "d"),
        Axis::new("φ", "").with_range(0.0, DENSEST[usize::from(D == 3)]),
    );
    if across.count() > 1 && up.count() > 1 {
        for (share, name) in [(0.25, "¼ RCP"), (0.5, "½ RCP"), (0.75, "¾ RCP")] {
            map = map.with_level(share * close, name);
        }
    }
    Ok(Finding {
        name: "map",
        words: vec![format!(
            "{} × {} cells of {:.3} × {:.3} d, lines at ¼, ½ and ¾ of φ = {close}",
            across.count(),
            up.count(),
            across.width(),
            up.width()
        )],
        table,
        picture: map.to_svg()?,
    })
}

/// The line through a surface, within the slab that was asked for.
fn fit<const D: usize>(task: &Task<'_, D>, surface: &[[f64; 2]], across: usize) -> Option<LineFit> {
    let slab = task.slab(across);
    let inside = surface
        .iter()
        .filter(|point| slab.is_none_or(|(low, high)| (low..=high).contains(&point[0])))
        .copied()
        .collect::<Vec<_>>();
    line_fit(&inside, None)
}

/// The mean angle of several fits, with the error that fits: that of their scatter,
/// or of the only one.
fn mean_angle(fits: &[LineFit]) -> Mean {
    // Less than that is rounding.
    let angle = |fit: &LineFit| (fit.angle().0 * 1.0e9).round() / 1.0e9 + 0.0;
    let angles: Vec<f64> = fits.iter().map(angle).collect();
    let mut mean = blocked_mean(&angles);
    if let [fit] = fits {
        mean.error = fit.angle().1;
    }
    mean
}

pub(super) fn angle<const D: usize>(task: &Task<'_, D>) -> Result<Finding, ProgramError> {
    let (across, level) = (task.across()?, level(task));
    let name = axis_name(across);
    let bins = task.bins(across, 1.0)?;
    let (low, high) = task.extent(D - 1)?;
    // Above the highest grain there is a cell without any.
    let up = Bins::of_width(low, high + bins.width(), 0.5 * bins.width())?;
    let (mut of_maps, mut of_grains) = (Vec::new(), Vec::new());
    let (mut fits, mut others) = (Vec::new(), Vec::new());
    for sample in task.samples {
        // A base lies below the surface, but the ring of a drum above it as well.
        let free: Vec<_> = sample.grains.iter().copied().filter(is_free).collect();
        let map = fraction_map(&free, &sample.container, [across, D - 1], &bins, &up)?;
        let surface = surface_of_map(&map, &bins, &up, level)?;
        fits.extend(fit(task, &surface, across));
        of_maps.push(surface);
        let surface = surface_of_grains(&free, across, D - 1, &bins, |_| true)?;
        others.extend(fit(task, &surface, across));
        of_grains.push(surface);
    }
    let profile = |surfaces: &[Vec<[f64; 2]>]| {
        let heights: Vec<Vec<f64>> = surfaces
            .iter()
            .map(|surface| surface.iter().map(|point| point[1]).collect())
            .collect();
        Profile::of_frames(&bins, heights.iter().map(Vec::as_slice))
    };
    let (map, grains) = (profile(&of_maps), profile(&of_grains));
    let mut table = Columns::new([
        name,
        "height_of_map",
        "error",
        "height_of_highest_grain",
        "error_of_highest_grain",
    ]);
    for ((centre, one), other) in bins.centres().iter().zip(&map.means).zip(&grains.means) {
        table.numbers([*centre, one.value, one.error, other.value, other.error]);
    }
    let mut chart = Chart::new("Free surface")
        .with_axes(Axis::new(name, "d"), Axis::new("height", "d"))
        .with(Series::points(format!("φ = {level}"), map.points()).with_errors(map.errors()))
        .with(
            Series::points("highest grain", grains.points())
                .with_marker(Marker::Circle)
                .with_errors(grains.errors()),
        );
    let mut words = Vec::new();
    for (what, profile, fits) in [
        (format!("where φ = {level}"), &map, &fits),
        ("of the highest grains".to_owned(), &grains, &others),
    ] {
        let Some(line) = fit(task, &profile.points(), across) else {
            words.push(format!(
                "the surface {what} has fewer than two points: no angle"
            ));
            continue;
        };
        let (low, high) = task.slab(across).unwrap_or((bins.from(), bins.to()));
        chart = chart.with(Series::dashed(
            "",
            [[low, line.at(low)], [high, line.at(high)]],
        ));
        words.push(format!(
            "the surface {what} rises at {}° along {name}, from {low:.2} to {high:.2} d",
            with_error(&mean_angle(fits))
        ));
    }
    Ok(Finding {
        name: "angle",
        words,
        table,
        picture: chart.to_svg()?,
    })
}
