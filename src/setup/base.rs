//! A rough base.

use rand_chacha::ChaCha8Rng;

use crate::analysis::{ball_volume, lowest_surface};
use crate::error::SetupError;
use crate::particle::{Particle, Vector};
use crate::setup::growth::{Failure, packed};
use crate::setup::region::Region;
use crate::setup::{Sizes, mass_of, require};

/// Cuts through the packing that are compared.
const CUTS: usize = 8;

/// Packings that are tried, each sparser than the last: between narrow walls
/// grains jam early.
const ATTEMPTS: usize = 16;

/// A slab of fixed grains cut from a random packing (the base of the paper's
/// section 3, there "to avoid a local crystalline order in the lower layers").
///
/// The packing is made by growth in a box with the lateral lengths and about
/// three diameters more than the thickness, periodic along the last axis; its
/// packing fraction is 0.60 in three dimensions, 0.72 in two, less between
/// narrow walls. The slab keeps the grains whose *centres* lie within the
/// thickness, and is shifted until its lowest surface, the bottom from which
/// the heights of a deposit are counted, is at `origin[D - 1]`. So it reaches
/// from there to almost the thickness plus one diameter; where exactly, tells
/// [`highest_surface`](crate::analysis::highest_surface).
///
/// A hole is where a grain of the smallest size, dropped straight down, would
/// fall through. Of eight cuts through the packing the first without a hole is
/// taken, for 2 d nearly always the very first. If all have holes, as they do
/// when the slab is much thinner than that, it is the one where they are
/// smallest.
#[derive(Clone, Debug, PartialEq)]
pub struct Base<const D: usize> {
    /// Diameters of the grains.
    pub sizes: Sizes,
    /// Lateral lengths and, last, the thickness, in d.
    pub lengths: Vector<D>,
    /// Lower lateral corner and, last, the height of the lowest surface, in d.
    pub origin: Vector<D>,
    /// Which lateral axes are periodic; between the walls of the others grains
    /// lie inside. The last entry is not used.
    pub periodic: [bool; D],
}

impl<const D: usize> Default for Base<D> {
    /// The paper's: equal grains, 2 d thick, periodic with 10 d.
    fn default() -> Self {
        let mut lengths = Vector::repeat(10.0);
        lengths[D - 1] = 2.0;
        Base {
            sizes: Sizes::default(),
            lengths,
            origin: Vector::zeros(),
            periodic: [true; D],
        }
    }
}

impl<const D: usize> Base<D> {
    /// The grains, all [`Mode::Fixed`](crate::Mode::Fixed) and at rest.
    ///
    /// # Errors
    ///
    /// When a parameter is out of range, a period is shorter than two of the
    /// largest diameters, walls are so near to each other that the grains jam
    /// (hardly wider than the largest diameter), or the slab is too thin to hold a
    /// single grain.
    pub fn grains(&self, rng: &mut ChaCha8Rng) -> Result<Vec<Particle<D>>, SetupError> {
        let sizes = self.sizes.validated()?;
        let thickness = self.lengths[D - 1];
        require(
            thickness > 0.0 && thickness.is_finite(),
            "thickness",
            thickness,
            "a positive number is allowed",
        )?;
        let region = Region {
            origin: self.origin,
            lengths: self.lengths,
            periodic: self.periodic,
        }
        .validated(D - 1, sizes.largest())?;

        let (packing, height) = packing(region, &sizes, rng)?;
        let mut best: Option<(usize, Vec<Particle<D>>)> = None;
        for cut in 0..CUTS {
            let from = self.origin[D - 1] + height * (cut as f64 / CUTS as f64);
            let slab = slab(&packing, from, thickness, height);
            let holes = holes(&region, &slab, sizes.smallest());
            if !slab.is_empty() && best.as_ref().is_none_or(|(fewest, _)| holes < *fewest) {
                best = Some((holes, slab));
            }
            if holes == 0 {
                break;
            }
        }
        let (_, mut slab) = best.ok_or(SetupError::NoRoom {
            placed: 0,
            wanted: packing.len(),
            reason: "no centre of a grain lies in so thin a base; give it more thickness",
        })?;
        let lowest = lowest_surface(&slab).unwrap_or(0.0);
        for grain in &mut slab {
            let radius = grain.radius();
            // In this order the lowest is exactly where it is wanted.
            let above = (grain.position[D - 1] - radius) - lowest;
            grain.position[D - 1] = self.origin[D - 1] + radius + above;
        }
        Ok(slab)
    }
}

/// A random packing over the lateral extent of `region`, periodic along the last
/// axis, and its height, in d.
fn packing<const D: usize>(
    mut region: Region<D>,
    sizes: &Sizes,
    rng: &mut ChaCha8Rng,
) -> Result<(Vec<Particle<D>>, f64), SetupError> {
    let least_height = region.lengths[D - 1] + 3.0 * sizes.largest();
    let area = region.lateral_area();
    region.periodic[D - 1] = true;
    let mut fraction = packing_fraction(D);
    for _ in 0..ATTEMPTS {
        let mut diameters = Vec::new();
        let mut solid = 0.0;
        while solid < fraction * area * least_height {
            let diameter = sizes.sample(rng);
            solid += ball_volume::<D>(0.5 * diameter);
            diameters.push(diameter);
        }
        // The last grain fills the box a little more than full.
        region.lengths[D - 1] = solid / (fraction * area);
        match packed(&region, &diameters, rng) {
            Ok(places) => {
                let grains = places
                    .into_iter()
                    .zip(diameters)
                    .map(|(place, diameter)| {
                        Particle::fixed(place)
                            .with_diameter(diameter)
                            .with_mass(mass_of::<D>(diameter))
                    })
                    .collect();
                return Ok((grains, region.lengths[D - 1]));
            }
            Err(Failure::Jammed) => fraction *= 0.95,
            Err(Failure::Setup(error)) => return Err(error),
        }
    }
    Err(SetupError::NoRoom {
        placed: 0,
        wanted: 1,
        reason: "the base's grains jam between the walls; wider or periodic sides would help",
    })
}

/// The packing fraction a base is cut from: dense, but still far enough from
/// jamming to be made quickly, and in two dimensions from crystallising.
fn packing_fraction(dimension: usize) -> f64 {
    match dimension {
        1 => 0.9,
        2 => 0.72,
        _ => (3..dimension).fold(0.60, |fraction, _| fraction * 0.66),
    }
}

/// The grains with centres in `from ≤ z < from + thickness`, periodic with
/// `height`.
fn slab<const D: usize>(
    packing: &[Particle<D>],
    from: f64,
    thickness: f64,
    height: f64,
) -> Vec<Particle<D>> {
    packing
        .iter()
        .filter_map(|grain| {
            let mut above = grain.position[D - 1] - from;
            above -= height * libm::floor(above / height);
            let mut grain = *grain;
            grain.position[D - 1] = from + above;
            (above < thickness).then_some(grain)
        })
        .collect()
}

/// How many lateral places of a fine lattice are not surely above a grain that
/// stops one of diameter `smallest` dropped there.
///
/// A lattice cell counts as safe if its centre lies within the contact distance
/// of a grain, less the cell's half-diagonal; so none means no hole, whatever
/// the place.
fn holes<const D: usize>(region: &Region<D>, slab: &[Particle<D>], smallest: f64) -> usize {
    const CELLS: f64 = 1.0e6;
    let lateral = D - 1;
    let coarsest = libm::pow(region.lateral_area() / CELLS, 1.0 / lateral.max(1) as f64);
    let wanted = coarsest.max(0.1 * smallest);
    let mut start = [0.0; D];
    let mut spacing = [0.0; D];
    let mut count = [1i64; D];
    for axis in 0..lateral {
        // Where the centre of the dropped grain can be.
        let inset = if region.periodic[axis] {
            0.0
        } else {
            0.5 * smallest
        };
        let length = region.lengths[axis] - 2.0 * inset;
        count[axis] = ((length / wanted).ceil() as i64).max(1);
        spacing[axis] = length / count[axis] as f64;
        start[axis] = region.origin[axis] + inset;
    }
    let half_diagonal = 0.5 * spacing.iter().map(|s| s * s).sum::<f64>().sqrt();
    let total: i64 = count.iter().product();
    let mut safe = vec![false; total as usize];

    for grain in slab {
        let reach = 0.5 * (grain.diameter + smallest) - half_diagonal;
        if reach <= 0.0 {
            continue;
        }
        // The block of lattice cells that may be in reach.
        let mut low = [0i64; D];
        let mut high = [0i64; D];
        for axis in 0..lateral {
            let along = |place: f64| {
                let steps = (place - start[axis]) / spacing[axis].max(f64::MIN_POSITIVE);
                steps.clamp(-1.0e9, 1.0e9).floor() as i64
            };
            low[axis] = along(grain.position[axis] - reach);
            high[axis] = along(grain.position[axis] + reach);
            if !region.periodic[axis] {
                low[axis] = low[axis].clamp(0, count[axis] - 1);
                high[axis] = high[axis].clamp(0, count[axis] - 1);
            }
        }
        let mut at = low;
        'block: loop {
            let mut distance = 0.0;
            let mut cell = 0;
            for axis in 0..lateral {
                let centre = start[axis] + spacing[axis] * (at[axis] as f64 + 0.5);
                let offset = centre - grain.position[axis];
                distance += offset * offset;
                cell = cell * count[axis] + at[axis].rem_euclid(count[axis]);
            }
            if distance <= reach * reach {
                safe[cell as usize] = true;
            }
            for axis in 0..lateral {
                if at[axis] < high[axis] {
                    at[axis] += 1;
                    continue 'block;
                }
                at[axis] = low[axis];
            }
            break;
        }
    }
    safe.iter().filter(|&&safe| !safe).count()
}
