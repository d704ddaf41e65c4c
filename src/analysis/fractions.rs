//! Packing fractions in slabs and columns: profiles and maps.

use crate::analysis::error::check_axis;
use crate::analysis::{AnalysisError, Bins, Container, ball_column_volume, ball_slab_volume};
use crate::particle::Particle;

/// The packing fraction in slabs across `axis`, one a bin: exact volumes of
/// spheres (areas of disks) over the volume of the slab.
///
/// The bins are in d, anywhere along the axis; the slabs are as wide across it as
/// the container. Where the axis is periodic, images count.
///
/// # Errors
///
/// When there is no such axis.
pub fn fraction_profile<const D: usize>(
    particles: &[Particle<D>],
    container: &Container<D>,
    axis: usize,
    bins: &Bins,
) -> Result<Vec<f64>, AnalysisError> {
    check_axis::<D>(axis)?;
    let mut solid = vec![0.0; bins.count()];
    let whole = (bins.from(), bins.to());
    for particle in particles {
        let (centre, radius) = (particle.position[axis], particle.radius());
        let ends = (centre - radius, centre + radius);
        for shift in container.shifts(axis, ends, whole) {
            for bin in bins.touched(ends.0 + shift, ends.1 + shift) {
                let (low, high) = (bins.edge(bin), bins.edge(bin + 1));
                solid[bin] += ball_slab_volume::<D>(radius, centre + shift, low, high);
            }
        }
    }
    let volume = bins.width() * container.cross_section(axis);
    Ok(solid.into_iter().map(|solid| solid / volume).collect())
}

/// The packing fraction in columns over the cells of a plane grid, row by row
/// from below: exact volumes of what each column cuts out of the spheres, over
/// its volume. In two dimensions the cells themselves.
///
/// `axes` are those across and up on the map; the columns stand along the third,
/// all the way through the container. Where an axis is periodic, images count.
/// The value of cell (column, row) is at `row * across.count() + column`.
///
/// # Errors
///
/// When there is no such axis, or both are the same.
pub fn fraction_map<const D: usize>(
    particles: &[Particle<D>],
    container: &Container<D>,
    axes: [usize; 2],
    across: &Bins,
    up: &Bins,
) -> Result<Vec<f64>, AnalysisError> {
    let [first, second] = axes;
    check_axis::<D>(first)?;
    check_axis::<D>(second)?;
    if first == second {
        return Err(AnalysisError::Parameter {
            field: "the second axis of the map",
            value: second as f64,
            allowed: "another than the first is allowed",
        });
    }
    let mut solid = vec![0.0; across.count() * up.count()];
    for particle in particles {
        let radius = particle.radius();
        let centre = axes.map(|axis| particle.position[axis]);
        let ends = centre.map(|place| (place - radius, place + radius));
        for right in container.shifts(first, ends[0], (across.from(), across.to())) {
            let columns = across.touched(ends[0].0 + right, ends[0].1 + right);
            for above in container.shifts(second, ends[1], (up.from(), up.to())) {
                let centre = [centre[0] + right, centre[1] + above];
                for row in up.touched(ends[1].0 + above, ends[1].1 + above) {
                    for column in columns.clone() {
                        let low = [across.edge(column), up.edge(row)];
                        let high = [across.edge(column + 1), up.edge(row + 1)];
                        solid[row * across.count() + column] +=
                            ball_column_volume::<D>(radius, centre, low, high);
                    }
                }
            }
        }
    }
    let depth: f64 = (0..D)
        .filter(|axis| !axes.contains(axis))
        .map(|axis| container.lengths[axis])
        .product();
    let volume = across.width() * up.width() * depth;
    Ok(solid.into_iter().map(|solid| solid / volume).collect())
}
