//! Where the grains of a drum are, and how fast, as seen from outside.

use crate::analysis::{
    Bins, Container, LineFit, Mean, blocked_mean, fraction_map, line_fit, surface_of_map,
};
use crate::output::Frame;
use crate::particle::{Mode, Particle, Vector};
use crate::program::error::ProgramError;
use crate::program::reproduce::drum::Turned;
use crate::time::Time;

/// φ of random close packing, to which the paper refers its lines.
pub(super) const CLOSE_PACKING: f64 = 0.64;
/// Half the width of the slab in which velocities are measured, in d.
const SLAB: f64 = 2.0;
/// Width of the bins of depth, in d.
pub(super) const BIN: f64 = 1.0;

/// The grains of a frame as they are seen from outside, in the plane of the drum
/// and along its axis, with velocities relative to the drum.
pub(super) fn seen(drum: &Turned, frame: &Frame) -> Vec<Particle<3>> {
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
pub(super) struct Field {
    pub(super) bins: Bins,
    pub(super) values: Vec<f64>,
    pub(super) frames: usize,
}

pub(super) fn field(drum: &Turned, frames: &[Frame]) -> Result<Field, ProgramError> {
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

/// The free surface at the centre: a line through heights above the axis, which is
/// at x = 0.
pub(super) struct Surface(pub(super) LineFit);

impl Surface {
    /// Its distance from the axis, below it.
    pub(super) fn depth(&self) -> f64 {
        let LineFit {
            intercept, slope, ..
        } = self.0;
        -intercept / libm::sqrt(1.0 + slope * slope)
    }
}

pub(super) fn surface(drum: &Turned, field: &Field) -> Result<Surface, ProgramError> {
    let points = surface_of_map(&field.values, &field.bins, &field.bins, 0.5 * CLOSE_PACKING)?;
    let near: Vec<[f64; 2]> = points
        .into_iter()
        .filter(|[x, height]| x.abs() < 0.16 * drum.radius && height.is_finite())
        .collect();
    let fit = line_fit(&near, None).ok_or_else(|| ProgramError::Reproduction {
        what: format!("{} has no free surface at its centre", drum.run.name),
    })?;
    Ok(Surface(fit))
}

/// Mean velocities along the surface by depth below it, in a thin slab across it
/// at the centre.
pub(super) fn profile(
    drum: &Turned,
    frames: &[Frame],
    surface: &Surface,
) -> Result<(Bins, Vec<Mean>), ProgramError> {
    let deepest = libm::floor(drum.radius - 1.0);
    let bins = Bins::of_width(0.0, deepest, BIN)?;
    let LineFit {
        intercept: height,
        slope,
        ..
    } = surface.0;
    let length = libm::sqrt(1.0 + slope * slope);
    let (cos, sin) = (1.0 / length, slope / length);
    let mut columns = vec![Vec::new(); bins.count()];
    for frame in counted(drum, frames) {
        let mut sums = vec![(0.0, 0.0); bins.count()];
        for grain in seen(drum, frame) {
            if grain.mode == Mode::Fixed {
                continue;
            }
            let (x, z) = (grain.position[0], grain.position[2] - height);
            let along = x * cos + z * sin;
            let depth = x * sin - z * cos;
            let (true, Some(bin)) = (along.abs() < SLAB, bins.bin_of(depth)) else {
                continue;
            };
            // Down the slope counts positive.
            let speed = grain.velocity[0] * cos + grain.velocity[2] * sin;
            let down = if slope > 0.0 { -speed } else { speed };
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
