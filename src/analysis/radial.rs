//! The radial distribution function.

use crate::analysis::{AnalysisError, Bins, Container, ball_volume, for_each_pair};
use crate::particle::{Particle, Vector};

/// g(r) of one configuration, with the numbers that it was made from.
#[derive(Clone, Debug, PartialEq)]
pub struct RadialDistribution {
    /// The bins of the distance of centres, in d.
    pub bins: Bins,
    /// g in each bin: neighbours over those that as many grains at random would
    /// have. 1 where there is no order.
    pub values: Vec<f64>,
    /// How many grains were looked at from.
    pub centres: usize,
    /// Their number density, in 1/d^D.
    pub density: f64,
}

/// The radial distribution function of the centres up to `bins.to()`.
///
/// **Edges.** Along periodic axes images count, and the distance is at most half
/// a period. Along the other axes grains are looked at *from* only where the
/// whole ball of radius `bins.to()` lies inside the material: `filled` says from
/// where to where it reaches (`None` on an axis: as far as the centres do), and
/// the centres of those grains lie at least `bins.to()` inside. All other grains
/// are still looked *at*. The density is that of the grains looked from; if all
/// axes are periodic it is (N − 1)/V, so that an ideal gas has g = 1 without a
/// correction.
///
/// # Errors
///
/// When the bins begin below 0; when they reach farther than half a period;
/// when no grain is as far inside as that.
pub fn radial_distribution<const D: usize>(
    particles: &[Particle<D>],
    container: &Container<D>,
    filled: [Option<(f64, f64)>; D],
    bins: &Bins,
) -> Result<RadialDistribution, AnalysisError> {
    if bins.from() < 0.0 {
        return Err(AnalysisError::Parameter {
            field: "the least distance",
            value: bins.from(),
            allowed: "0 or more is allowed",
        });
    }
    let region = region(particles, container, filled, bins.to())?;
    let inside: Vec<bool> = particles
        .iter()
        .map(|particle| {
            (0..D).all(|axis| {
                let (low, high) = region[axis];
                container.periodic[axis] || (low..high).contains(&particle.position[axis])
            })
        })
        .collect();
    let centres = inside.iter().filter(|is| **is).count();
    if centres == 0 || particles.len() < 2 {
        return Err(AnalysisError::Nothing(
            "grains farther from all open faces than the greatest distance",
        ));
    }
    let mut counts = vec![0u64; bins.count()];
    for_each_pair(particles, container, bins.to(), |i, j, way| {
        if let Some(bin) = bins.bin_of(length(&way)) {
            counts[bin] += u64::from(inside[i]) + u64::from(inside[j]);
        }
    })?;
    let volume: f64 = region.iter().map(|(low, high)| high - low).product();
    let closed = container.periodic.iter().all(|periodic| *periodic);
    let density = if closed {
        (particles.len() - 1) as f64 / container.volume()
    } else {
        centres as f64 / volume
    };
    let values = counts.iter().enumerate().map(|(bin, &count)| {
        let shell = ball_volume::<D>(bins.edge(bin + 1)) - ball_volume::<D>(bins.edge(bin));
        count as f64 / (centres as f64 * density * shell)
    });
    Ok(RadialDistribution {
        bins: *bins,
        values: values.collect(),
        centres,
        density,
    })
}

fn length<const D: usize>(way: &Vector<D>) -> f64 {
    way.norm_squared().sqrt()
}

/// Where grains are looked from, along each axis.
fn region<const D: usize>(
    particles: &[Particle<D>],
    container: &Container<D>,
    filled: [Option<(f64, f64)>; D],
    margin: f64,
) -> Result<Vec<(f64, f64)>, AnalysisError> {
    (0..D)
        .map(|axis| {
            if container.periodic[axis] {
                return Ok(container.faces(axis));
            }
            let (low, high) = filled[axis].unwrap_or_else(|| {
                let places = || particles.iter().map(|particle| particle.position[axis]);
                (
                    places().fold(f64::INFINITY, f64::min),
                    places().fold(f64::NEG_INFINITY, f64::max),
                )
            });
            let (low, high) = (low + margin, high - margin);
            if low < high {
                return Ok((low, high));
            }
            Err(AnalysisError::Distance {
                distance: margin,
                allowed: margin + 0.5 * (high - low),
                reason: "half of the extent of the grains along an axis that is not periodic",
            })
        })
        .collect()
}
