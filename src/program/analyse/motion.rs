//! How grains move: velocity, temperature, displacement.

use crate::analysis::{BinnedMotion, Paths, Probe, Profile, binned_motion};
use crate::model::Dynamics;
use crate::particle::{Particle, Vector};
use crate::plot::{Axis, Chart, Mark, Marker, Series, Stroke};
use crate::program::analyse::Task;
use crate::program::analyse::arguments::axis_name;
use crate::program::analyse::finding::{Columns, Finding};
use crate::program::analyse::frames::{is_free, turning_ground};
use crate::program::error::ProgramError;

/// The bins, and what grains do in them in each sample.
fn motion<const D: usize>(
    task: &Task<'_, D>,
) -> Result<(Probe<D>, Vec<BinnedMotion<D>>), ProgramError> {
    let turning = turning_ground::<D>(&task.options.run)?;
    let axis = task.axis()?;
    let mut probe = Probe::new(axis, task.bins(axis, 1.0)?)?;
    for other in 0..D {
        if let Some((low, high)) = task.slab(other) {
            probe = probe.within(other, low, high)?;
        }
    }
    let frames: Vec<BinnedMotion<D>> = task
        .samples
        .iter()
        .map(|sample| {
            let ground = |grain: &Particle<D>| match &turning {
                Some(turning) => turning.ground_velocity(&grain.position, sample.time),
                None => Vector::zeros(),
            };
            binned_motion(&sample.grains, &probe, ground, is_free)
        })
        .collect();
    if frames
        .iter()
        .all(|frame| frame.counts.iter().all(|count| *count == 0))
    {
        return Err(ProgramError::NotAnalysed {
            run: task.name.clone(),
            reason: "no grain but fixed and falling ones is where velocities are wanted".to_owned(),
        });
    }
    Ok((probe, frames))
}

fn profile<const D: usize>(
    probe: &Probe<D>,
    frames: &[BinnedMotion<D>],
    of: impl Fn(&BinnedMotion<D>) -> Vec<f64>,
) -> Profile {
    let values: Vec<Vec<f64>> = frames.iter().map(of).collect();
    Profile::of_frames(&probe.bins, values.iter().map(Vec::as_slice))
}

fn finding<const D: usize>(
    task: &Task<'_, D>,
    (name, column, title, unit): (&'static str, &'static str, String, &str),
    frames: &[BinnedMotion<D>],
    profile: &Profile,
) -> Result<Finding, ProgramError> {
    let along = axis_name(task.axis()?);
    let grains = |bin: usize| {
        let total: usize = frames.iter().map(|frame| frame.counts[bin]).sum();
        total as f64 / frames.len() as f64
    };
    let mut table = Columns::new([along, column, "error", "frames", "grains"]);
    for (bin, mean) in profile.means.iter().enumerate() {
        let centre = profile.bins.centre(bin);
        let count = mean.count as f64;
        table.numbers([centre, mean.value, mean.error, count, grains(bin)]);
    }
    let chart = Chart::new(title.clone())
        .with_axes(Axis::new(along, "d"), Axis::new(title.to_lowercase(), unit))
        .with(
            Series::points("", profile.points())
                .with_stroke(Stroke::Solid)
                .with_errors(profile.errors()),
        );
    let greatest = profile
        .points()
        .into_iter()
        .filter(|point| point[1].is_finite())
        .reduce(|one, other| {
            if other[1].abs() > one[1].abs() {
                other
            } else {
                one
            }
        });
    let words = match greatest {
        Some([place, value]) => format!(
            "{} bins of {:.3} d along {along}; greatest {value:.4} {unit} at {along} = {place:.2} d",
            profile.bins.count(),
            profile.bins.width(),
        ),
        None => "no bin holds two grains or more in any frame".to_owned(),
    };
    Ok(Finding {
        name,
        words: vec![words],
        table,
        picture: chart.to_svg()?,
    })
}

pub(super) fn velocity<const D: usize>(task: &Task<'_, D>) -> Result<Finding, ProgramError> {
    let component = task.component()?;
    let (probe, frames) = motion(task)?;
    let profile = profile(&probe, &frames, |frame| {
        frame
            .velocities
            .iter()
            .map(|velocity| velocity[component])
            .collect()
    });
    let title = format!("Mean velocity along {}", axis_name(component));
    let column = ["velocity_x", "velocity_y", "velocity_z"][component];
    finding(
        task,
        ("velocity", column, title, "√(gd)"),
        &frames,
        &profile,
    )
}

pub(super) fn temperature<const D: usize>(task: &Task<'_, D>) -> Result<Finding, ProgramError> {
    let (probe, frames) = motion(task)?;
    let profile = profile(&probe, &frames, |frame| frame.temperatures.clone());
    let title = "Granular temperature".to_owned();
    finding(
        task,
        ("temperature", "temperature", title, "mgd"),
        &frames,
        &profile,
    )
}

/// A step of this share of a period may well have been a longer one.
const LONG_STEP: f64 = 0.4;

pub(super) fn msd<const D: usize>(task: &Task<'_, D>) -> Result<Finding, ProgramError> {
    let first = task.samples.first();
    let (Some(first), true) = (first, task.samples.len() > 1) else {
        return Err(ProgramError::NotAnalysed {
            run: task.name.clone(),
            reason:
                "a displacement needs two frames, and there is one; output.frames_every of the \
                     scenario makes more"
                    .to_owned(),
        });
    };
    // The box of an open axis is as long as grains are apart; no image is there.
    let mut paths = Paths::new(first.container);
    for sample in task.samples {
        paths.push(sample.time, &sample.grains)?;
    }
    let counted = |grain: usize| is_free(&first.grains[grain]);
    if !(0..first.grains.len()).any(counted) {
        return Err(ProgramError::NotAnalysed {
            run: task.name.clone(),
            reason: format!(
                "all grains are fixed or still falling in the first frame, at t = {}; --from takes \
                 a later one",
                first.time.units()
            ),
        });
    }
    let curve = paths.mean_square(counted);
    let mut table = Columns::new(["lapse", "mean_square_displacement", "origins"]);
    for point in &curve {
        table.numbers([point.lapse, point.value, point.origins as f64]);
    }
    let chart = Chart::new("Mean square displacement")
        .with_axes(
            Axis::new("lapse of time", "√(d/g)").logarithmic(),
            Axis::new("mean square displacement", "d²").logarithmic(),
        )
        .with(
            Series::points("", curve.iter().map(|point| [point.lapse, point.value]))
                .with_marker(Marker::Disk)
                .with_stroke(Stroke::Solid),
        )
        .with_mark(Mark::horizontal(1.0, "one diameter"));
    let mut words = Vec::new();
    if let (Some(first), Some(last)) = (curve.first(), curve.last()) {
        words.push(format!(
            "{:.4} d² after {:.3}, {:.4} d² after {:.3} √(d/g)",
            first.value, first.lapse, last.value, last.lapse
        ));
    }
    if paths.longest_step() > LONG_STEP {
        words.push(format!(
            "doubtful: a grain comes {:.2} periods from frame to frame, and from ½ on it would be \
             taken for another image; frames closer in time are needed",
            paths.longest_step()
        ));
    }
    Ok(Finding {
        name: "msd",
        words,
        table,
        picture: chart.to_svg()?,
    })
}
