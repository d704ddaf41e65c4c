//! The free surface of a heap and its angle.

use crate::analysis::error::check_axis;
use crate::analysis::{AnalysisError, Bins};
use crate::particle::Particle;

/// The height of the highest grain in each bin along an axis: the largest
/// position on `up` plus the radius, of the grains whose centres are in the bin,
/// in d; not a number in empty bins. One point (middle of the bin, height) a bin.
///
/// `counted` says which grains belong to the heap: those that fly above it do
/// not. Of bins as wide as a grain the height is that of the surface and somewhat
/// more, all along by the same amount, so that its angle is right.
///
/// # Errors
///
/// When there is no such axis.
pub fn surface_of_grains<const D: usize>(
    particles: &[Particle<D>],
    across: usize,
    up: usize,
    bins: &Bins,
    counted: impl Fn(&Particle<D>) -> bool,
) -> Result<Vec<[f64; 2]>, AnalysisError> {
    check_axis::<D>(across)?;
    check_axis::<D>(up)?;
    let mut heights = vec![f64::NAN; bins.count()];
    for particle in particles.iter().filter(|particle| counted(particle)) {
        if let Some(bin) = bins.bin_of(particle.position[across]) {
            // The other one, if one is not a number.
            heights[bin] = heights[bin].max(particle.position[up] + particle.radius());
        }
    }
    Ok(bins
        .centres()
        .into_iter()
        .zip(heights)
        .map(<[f64; 2]>::from)
        .collect())
}

/// The height of the surface in each column of a map of the packing fraction:
/// where, from above, it first reaches `level`, interpolated between the middles
/// of cells. One point (middle of the column, height) a column; not a number
/// where it is nowhere reached, or already in the highest cell.
///
/// `values` are those of [`fraction_map`](crate::analysis::fraction_map).
///
/// # Errors
///
/// When there are not as many values as cells.
pub fn surface_of_map(
    values: &[f64],
    across: &Bins,
    up: &Bins,
    level: f64,
) -> Result<Vec<[f64; 2]>, AnalysisError> {
    let (columns, rows) = (across.count(), up.count());
    if values.len() != columns * rows {
        return Err(AnalysisError::Parameter {
            field: "the number of values of the map",
            value: values.len() as f64,
            allowed: "as many as there are cells is allowed",
        });
    }
    let height = |column: usize| {
        let at = |row: usize| values[row * columns + column];
        let row = (0..rows).rev().find(|&row| at(row) >= level)?;
        if row + 1 == rows {
            return None;
        }
        let share = (at(row) - level) / (at(row) - at(row + 1));
        Some(up.centre(row) + share * up.width())
    };
    Ok((0..columns)
        .map(|column| [across.centre(column), height(column).unwrap_or(f64::NAN)])
        .collect())
}
