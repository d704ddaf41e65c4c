//! How densely grains lie.

use crate::analysis::ball_slab_volume;
use crate::particle::{Mode, Particle};

/// A packing fraction and the slab it was measured in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlabFraction {
    /// Volume of grains over volume of the slab.
    pub value: f64,
    /// Lower face of the slab, in d, on the axis of the positions.
    pub from: f64,
    /// Upper face of the slab, in d.
    pub to: f64,
}

/// The height of the lowest point of any grain, in d; `None` without grains.
#[must_use]
pub fn lowest_surface<'a, const D: usize>(
    particles: impl IntoIterator<Item = &'a Particle<D>>,
) -> Option<f64> {
    particles
        .into_iter()
        .map(|particle| particle.position[D - 1] - particle.radius())
        .reduce(f64::min)
}

/// The height of the highest point of any grain, in d; `None` without grains.
#[must_use]
pub fn highest_surface<'a, const D: usize>(
    particles: impl IntoIterator<Item = &'a Particle<D>>,
) -> Option<f64> {
    particles
        .into_iter()
        .map(|particle| particle.position[D - 1] + particle.radius())
        .reduce(f64::max)
}

/// Volume of grains in the slab between heights `from` and `to`, over the
/// slab's volume: exact sphere volumes (areas of disks in two dimensions).
///
/// `area` is the extent of the container across the last axis, in d^(D−1).
/// Grains of every mode count. Not a number if the slab has no volume.
#[must_use]
pub fn slab_fraction<const D: usize>(
    particles: &[Particle<D>],
    area: f64,
    from: f64,
    to: f64,
) -> f64 {
    let solid: f64 = particles
        .iter()
        .map(|particle| {
            ball_slab_volume::<D>(particle.radius(), particle.position[D - 1], from, to)
        })
        .sum();
    solid / (area * (to - from))
}

/// The packing fraction of the middle of a deposit (the paper's section 3),
/// between 25 % and 75 % of its height.
///
/// The bottom is the lowest surface of the fixed grains, of all grains if none
/// is fixed. The height is that of the nearest-rank 99th percentile of the
/// centres of the frozen grains above the bottom: the grain of rank ⌈0.99 n⌉
/// from below, so that a few grains on a hill of their own do not count. All
/// grains in the slab count, the fixed ones too.
///
/// `area` is the extent of the container across the last axis, in d^(D−1).
/// `None` if no grain is frozen, or the slab has no volume.
#[must_use]
pub fn packing_fraction<const D: usize>(
    particles: &[Particle<D>],
    area: f64,
) -> Option<SlabFraction> {
    let of_mode = |mode| particles.iter().filter(move |p| p.mode == mode);
    let bottom = lowest_surface(of_mode(Mode::Fixed)).or_else(|| lowest_surface(particles))?;
    let mut centres: Vec<f64> = of_mode(Mode::Frozen).map(|p| p.position[D - 1]).collect();
    centres.sort_by(f64::total_cmp);
    let rank = (99 * centres.len()).div_ceil(100);
    let height = *centres.get(rank.checked_sub(1)?)? - bottom;
    let (from, to) = (bottom + 0.25 * height, bottom + 0.75 * height);
    let has_volume = area > 0.0 && area.is_finite() && to > from;
    has_volume.then(|| SlabFraction {
        value: slab_fraction(particles, area, from, to),
        from,
        to,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::particle::Vector;
    use std::f64::consts::{PI, SQRT_2};

    /// Touching spheres of unit diameter on a face-centred cubic lattice of
    /// `cells`³ cells.
    fn fcc(cells: usize, mode: Mode) -> Vec<Particle<3>> {
        let edge = SQRT_2;
        let mut grains = Vec::new();
        for x in 0..cells {
            for y in 0..cells {
                for z in 0..cells {
                    let corner = Vector::<3>::new(x as f64, y as f64, z as f64);
                    for offset in [
                        [0.0, 0.0, 0.0],
                        [0.5, 0.5, 0.0],
                        [0.5, 0.0, 0.5],
                        [0.0, 0.5, 0.5],
                    ] {
                        let place = (corner + Vector::<3>::from(offset)) * edge;
                        grains.push(Particle::new(place, Vector::<3>::zeros()).with_mode(mode));
                    }
                }
            }
        }
        grains
    }

    #[test]
    fn face_centred_cubic() {
        let grains = fcc(8, Mode::Frozen);
        let area = (8.0 * SQRT_2) * (8.0 * SQRT_2);
        // Whole periods of the stacking, anywhere inside.
        for from in [2.0, 2.345, 3.1] {
            let found = slab_fraction(&grains, area, from, from + 4.0 * SQRT_2);
            assert!((found - PI / (3.0 * SQRT_2)).abs() < 1e-13, "{found}");
        }
    }

    #[test]
    fn square_lattice_of_disks() {
        let mut grains = Vec::new();
        for x in 0..5 {
            for y in 0..9 {
                let place = Vector::<2>::new(f64::from(x), f64::from(y) - 3.0);
                grains.push(Particle::new(place, Vector::<2>::zeros()));
            }
        }
        for from in [-2.0, -1.77, 0.3] {
            let found = slab_fraction(&grains, 5.0, from, from + 4.0);
            assert!((found - PI / 4.0).abs() < 1e-14, "{found}");
        }
    }

    #[test]
    fn the_middle_is_between_a_quarter_and_three_quarters() {
        // 200 frozen grains with centres at 1, 2, … 200, the bottom at −0.5: the
        // 99th percentile is the grain of rank 198.
        let mut grains: Vec<Particle<3>> = (1..=200)
            .map(|z| Particle::frozen(Vector::<3>::new(0.0, 0.0, f64::from(z))))
            .collect();
        grains.push(Particle::fixed(Vector::<3>::new(0.0, 0.0, 0.0)));
        let slab = packing_fraction(&grains, 2.0).unwrap();
        assert_eq!(slab.from, -0.5 + 0.25 * 198.5);
        assert_eq!(slab.to, -0.5 + 0.75 * 198.5);
        // One sphere per unit of height, two units of area; the cut spheres at
        // the faces are counted in part.
        let whole = slab_fraction(&grains, 2.0, slab.from, slab.to);
        assert_eq!(slab.value, whole);
        assert!((whole - PI / 12.0).abs() < 0.01);
    }

    #[test]
    fn fixed_and_moving_grains_count_as_volume_but_not_as_height() {
        let frozen: Vec<Particle<3>> = (0..20)
            .map(|z| Particle::frozen(Vector::<3>::new(0.0, 0.0, f64::from(z))))
            .collect();
        let plain = packing_fraction(&frozen, 4.0).unwrap();
        // The same column once more beside it, as normal grains; and a very
        // high one that is still falling.
        let mut more = frozen.clone();
        more.extend(frozen.iter().map(|p| p.with_mode(Mode::Normal)));
        more.push(Particle::new(
            Vector::<3>::new(0.0, 0.0, 99.0),
            Vector::<3>::zeros(),
        ));
        let both = packing_fraction(&more, 4.0).unwrap();
        assert_eq!((both.from, both.to), (plain.from, plain.to));
        assert!((both.value - 2.0 * plain.value).abs() < 1e-15);
    }

    #[test]
    fn the_percentile_is_the_nearest_rank() {
        // The rank is ⌈0.99 n⌉: 1 of 1, 99 of 99, 99 of 100, 100 of 101.
        for (count, rank) in [(1, 1), (99, 99), (100, 99), (101, 100), (4800, 4752)] {
            let grains: Vec<Particle<3>> = (1..=count)
                .map(|z| Particle::frozen(Vector::<3>::new(0.0, 0.0, f64::from(z))))
                .collect();
            let slab = packing_fraction(&grains, 1.0).unwrap();
            assert_eq!(slab.to, 0.5 + 0.75 * (f64::from(rank) - 0.5));
        }
    }

    #[test]
    fn nothing_frozen_has_no_fraction() {
        assert_eq!(packing_fraction::<3>(&[], 1.0), None);
        let normal = Particle::new(Vector::<3>::zeros(), Vector::<3>::zeros());
        assert_eq!(packing_fraction(&[normal], 1.0), None);
        let frozen = [normal, Particle::frozen(Vector::<3>::new(0.0, 0.0, 1.0))];
        assert_eq!(packing_fraction(&frozen, 0.0), None);
        assert_eq!(packing_fraction(&frozen, f64::NAN), None);
    }

    #[test]
    fn surfaces() {
        let grains = [
            Particle::fixed(Vector::<2>::new(0.0, 1.0)).with_diameter(3.0),
            Particle::fixed(Vector::<2>::new(0.0, 2.0)),
        ];
        assert_eq!(lowest_surface(&grains), Some(-0.5));
        assert_eq!(highest_surface(&grains), Some(2.5));
        assert_eq!(highest_surface::<2>(&[]), None);
    }
}
