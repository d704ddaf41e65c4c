//! Who touches whom.

use crate::analysis::{AnalysisError, Container, for_each_pair};
use crate::particle::{Particle, Vector};

/// Two grains that are near each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact<const D: usize> {
    /// Index of the one.
    pub first: usize,
    /// Index of the other, which is larger.
    pub second: usize,
    /// Unit vector from the first to the second.
    pub normal: Vector<D>,
    /// Gap between the surfaces, in d; negative where they overlap.
    pub gap: f64,
}

/// All pairs of grains whose surfaces are at most `widest` apart, in d, by
/// index. Two grains at the same place have no normal and are left out.
///
/// # Errors
///
/// When the gap is negative; when two diameters and the gap are longer than a
/// period.
pub fn contacts<const D: usize>(
    particles: &[Particle<D>],
    container: &Container<D>,
    widest: f64,
) -> Result<Vec<Contact<D>>, AnalysisError> {
    if !(widest >= 0.0 && widest.is_finite()) {
        return Err(AnalysisError::Parameter {
            field: "the gap of a contact",
            value: widest,
            allowed: "a finite number from 0 on is allowed",
        });
    }
    let largest = particles
        .iter()
        .map(|particle| particle.diameter)
        .fold(0.0, f64::max);
    if largest + widest == 0.0 {
        return Ok(Vec::new());
    }
    // A touching pair may be farther apart than its diameters by rounding.
    let range = (largest + widest) * (1.0 + 1.0e-12);
    let mut found = Vec::new();
    for_each_pair(particles, container, range, |first, second, way| {
        let distance = way.norm_squared().sqrt();
        let gap = distance - particles[first].radius() - particles[second].radius();
        if gap <= widest && distance > 0.0 {
            found.push(Contact {
                first,
                second,
                normal: way / distance,
                gap,
            });
        }
    })?;
    found.sort_by_key(|contact| (contact.first, contact.second));
    Ok(found)
}

/// How many contacts grains have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coordination {
    /// Pairs whose surfaces are at most so far apart touch, in d.
    pub threshold: f64,
    /// How many grains were counted.
    pub grains: usize,
    /// Contacts of a counted grain, on the average.
    pub mean: f64,
    /// How many of them are rattlers.
    pub rattlers: usize,
    /// Contacts of a counted grain that is no rattler with others that are none,
    /// on the average; not a number if all are rattlers.
    pub mean_without_rattlers: f64,
}

/// The mean number of contacts, with and without rattlers, taking for contacts
/// those of `contacts` whose gap is at most `threshold`.
///
/// `counted` says which grains the mean is over, such as those that are not of
/// the base; contacts with the others count. A counted grain is a *rattler* if
/// it has fewer than `fewest` contacts, those with other rattlers not counted:
/// grains are taken out until all that are left have enough. D + 1 hold a grain
/// in place from all sides, D do so together with its weight.
#[must_use]
pub fn coordination<const D: usize>(
    contacts: &[Contact<D>],
    counted: &[bool],
    threshold: f64,
    fewest: usize,
) -> Coordination {
    let touching: Vec<(usize, usize)> = contacts
        .iter()
        .filter(|contact| contact.gap <= threshold)
        .map(|contact| (contact.first, contact.second))
        .filter(|&(first, second)| first.max(second) < counted.len())
        .collect();
    let of_counted = |numbers: &[usize]| {
        let each = numbers.iter().zip(counted).filter(|(_, counted)| **counted);
        each.map(|(number, _)| *number).collect::<Vec<_>>()
    };
    let mut partners = vec![Vec::new(); counted.len()];
    for &(first, second) in &touching {
        partners[first].push(second);
        partners[second].push(first);
    }
    let mut numbers: Vec<usize> = partners.iter().map(Vec::len).collect();
    let all = of_counted(&numbers);
    let mut rattles = vec![false; counted.len()];
    let mut doubtful: Vec<usize> = (0..counted.len()).collect();
    while let Some(grain) = doubtful.pop() {
        if rattles[grain] || !counted[grain] || numbers[grain] >= fewest {
            continue;
        }
        rattles[grain] = true;
        for &partner in &partners[grain] {
            numbers[partner] -= 1;
            doubtful.push(partner);
        }
    }
    let kept: Vec<usize> = (0..counted.len())
        .filter(|&grain| counted[grain] && !rattles[grain])
        .map(|grain| numbers[grain])
        .collect();
    let mean = |numbers: &[usize]| numbers.iter().sum::<usize>() as f64 / numbers.len() as f64;
    Coordination {
        threshold,
        grains: all.len(),
        mean: mean(&all),
        rattlers: all.len() - kept.len(),
        mean_without_rattlers: mean(&kept),
    }
}
