//! Who is near whom: radial distribution, contacts, fabric.

use nalgebra::SMatrix;

use crate::analysis::{
    Bins, Contact, Coordination, Fabric, Mean, Profile, blocked_mean, contacts, coordination,
    fabric, radial_distribution,
};
use crate::particle::{Particle, Vector};
use crate::plot::{Axis, Chart, Mark, Marker, Series, Stroke};
use crate::program::analyse::Task;
use crate::program::analyse::arguments::axis_name;
use crate::program::analyse::finding::{Columns, Finding, with_error};
use crate::program::analyse::frames::{Sample, has_landed, is_free};
use crate::program::error::ProgramError;

/// The farthest distance of g(r) if nothing else is asked for, in d.
const FARTHEST: f64 = 5.0;
/// Higher peaks of g(r) are cut off in the plot.
const HIGHEST: f64 = 5.0;
/// Gaps for which contacts are counted, in d.
const GAPS: [f64; 11] = [
    1.0e-8, 1.0e-7, 1.0e-6, 1.0e-5, 1.0e-4, 3.0e-4, 1.0e-3, 3.0e-3, 1.0e-2, 3.0e-2, 1.0e-1,
];
/// Bins of the angle of contacts to the vertical.
const ANGLES: usize = 18;

/// Along an axis that is not periodic, from where to where there is material: the
/// slab that was asked for, or from the lowest centre to the nearest-rank 99th
/// percentile, so that a few grains on a hill of their own do not count.
fn filled<const D: usize>(
    task: &Task<'_, D>,
    grains: &[Particle<D>],
    axis: usize,
) -> Option<(f64, f64)> {
    if let Some(slab) = task.slab(axis) {
        return Some(slab);
    }
    let mut centres: Vec<f64> = grains.iter().map(|grain| grain.position[axis]).collect();
    centres.sort_by(f64::total_cmp);
    let rank = (99 * centres.len()).div_ceil(100).checked_sub(1)?;
    Some((*centres.first()?, *centres.get(rank)?))
}

/// How far g(r) can be measured.
fn farthest<const D: usize>(task: &Task<'_, D>) -> f64 {
    let mut farthest = FARTHEST;
    for sample in task.samples {
        let landed: Vec<_> = sample.grains.iter().copied().filter(has_landed).collect();
        for axis in 0..D {
            let allowed = if sample.container.periodic[axis] {
                0.5 * sample.container.lengths[axis]
            } else {
                // A part of the heap is left to look from.
                filled(task, &landed, axis).map_or(0.0, |(low, high)| 0.4 * (high - low))
            };
            farthest = farthest.min(allowed);
        }
    }
    farthest
}

pub(super) fn rdf<const D: usize>(task: &Task<'_, D>) -> Result<Finding, ProgramError> {
    let farthest = task.options.farthest.unwrap_or_else(|| farthest(task));
    let each = task.options.bins.map_or(50.0 * farthest, f64::from);
    let bins = Bins::new(0.0, farthest, (each.round() as usize).max(1))?;
    let mut found = Vec::new();
    for sample in task.samples {
        let landed: Vec<_> = sample.grains.iter().copied().filter(has_landed).collect();
        let ends = std::array::from_fn(|axis| filled(task, &landed, axis));
        found.push(radial_distribution(
            &landed,
            &sample.container,
            ends,
            &bins,
        )?);
    }
    let profile = Profile::of_frames(&bins, found.iter().map(|one| one.values.as_slice()));
    let mut table = Columns::new(["r", "g", "error", "frames"]);
    table.profile(&profile);
    let values: Vec<f64> = profile.means.iter().map(|mean| mean.value).collect();
    let highest = profile.points().into_iter().reduce(|one, other| {
        // Of equals the first.
        if other[1] > one[1] { other } else { one }
    });
    let [place, peak] = highest.unwrap_or([0.0, 0.0]);
    // The peak of touching grains would hide all else.
    let height = if peak > HIGHEST {
        HIGHEST
    } else {
        1.05 * peak.max(1.0)
    };
    let chart = Chart::new("Radial distribution function")
        .with_axes(
            Axis::new("r", "d"),
            Axis::new("g(r)", "").with_range(0.0, height),
        )
        .with(Series::steps("", &bins.edges(), &values))
        .with_mark(Mark::horizontal(1.0, "no order"));
    let centres: usize = found.iter().map(|one| one.centres).sum();
    Ok(Finding {
        name: "rdf",
        words: vec![format!(
            "g(r) up to {farthest:.3} d in bins of {:.4} d, seen from {} grains a frame; highest at \
             r = {place:.3} d: {peak:.2}",
            bins.width(),
            centres / task.samples.len().max(1),
        )],
        table,
        picture: chart.to_svg()?,
    })
}

/// The contacts of all samples up to a gap, and which grains are counted.
fn near<const D: usize>(
    sample: &Sample<D>,
    widest: f64,
) -> Result<(Vec<Contact<D>>, Vec<bool>), ProgramError> {
    let found = contacts(&sample.grains, &sample.container, widest)?;
    let landed = found.into_iter().filter(|contact| {
        [contact.first, contact.second]
            .iter()
            .all(|&grain| has_landed(&sample.grains[grain]))
    });
    Ok((
        landed.collect(),
        sample.grains.iter().map(is_free).collect(),
    ))
}

pub(super) fn count<const D: usize>(task: &Task<'_, D>) -> Result<Finding, ProgramError> {
    let mut gaps: Vec<f64> = GAPS.to_vec();
    if !gaps.contains(&task.options.gap) {
        gaps.push(task.options.gap);
        gaps.sort_by(f64::total_cmp);
    }
    let widest = gaps.iter().copied().fold(0.0, f64::max);
    let mut found: Vec<[Vec<Coordination>; 2]> = vec![Default::default(); gaps.len()];
    for sample in task.samples {
        let (touching, counted) = near(sample, widest)?;
        for (gap, found) in gaps.iter().zip(&mut found) {
            for (few, found) in found.iter_mut().enumerate() {
                found.push(coordination(&touching, &counted, *gap, D + few));
            }
        }
    }
    let mean = |of: &dyn Fn(&Coordination) -> f64, all: &[Coordination]| -> Mean {
        blocked_mean(&all.iter().map(of).collect::<Vec<_>>())
    };
    let mut table = Columns::new([
        "gap",
        "contacts",
        "error",
        "rattlers_under_weight",
        "contacts_without_rattlers_under_weight",
        "rattlers",
        "contacts_without_rattlers",
    ]);
    let mut curves: [Vec<[f64; 2]>; 3] = Default::default();
    let mut words = Vec::new();
    for (gap, [weight, all_sides]) in gaps.iter().zip(&found) {
        let all = mean(&|one| one.mean, weight);
        let share = |one: &Coordination| one.rattlers as f64 / one.grains as f64;
        let without = mean(&|one| one.mean_without_rattlers, all_sides);
        table.numbers([
            *gap,
            all.value,
            all.error,
            mean(&share, weight).value,
            mean(&|one| one.mean_without_rattlers, weight).value,
            mean(&share, all_sides).value,
            without.value,
        ]);
        curves[0].push([*gap, all.value]);
        let held = mean(&|one| one.mean_without_rattlers, weight);
        curves[1].push([*gap, held.value]);
        curves[2].push([*gap, without.value]);
        if *gap == task.options.gap {
            let held = |all: &[Coordination]| {
                let mean_share = 100.0 * mean(&share, all).value;
                let without = mean(&|one| one.mean_without_rattlers, all);
                match without.count {
                    0 => "all".to_owned(),
                    _ => format!(
                        "{mean_share:.1} %; the others have {}",
                        with_error(&without)
                    ),
                }
            };
            words.push(format!(
                "closer than {gap} d: {} contacts a grain",
                with_error(&all)
            ));
            words.push(format!("with fewer than {D}: {}", held(weight)));
            words.push(format!("with fewer than {}: {}", D + 1, held(all_sides)));
        }
    }
    let around = |gap: f64| {
        curves[0]
            .iter()
            .find(|point| point[0] == gap)
            .map(|point| point[1])
    };
    if let (Some(less), Some(more)) = (around(1.0e-4), around(1.0e-2)) {
        words.push(format!(
            "closer than 1e-4 d: {less:.3}, than 1e-2 d: {more:.3}"
        ));
    }
    let [all, held, without] = curves;
    let chart = Chart::new("Contacts per grain")
        .with_axes(
            Axis::new("widest gap of a contact", "d").logarithmic(),
            Axis::new("contacts per grain", ""),
        )
        .with(Series::points("all grains", all).with_stroke(Stroke::Solid))
        .with(
            Series::points(format!("without grains of fewer than {D}"), held)
                .with_stroke(Stroke::Dashed)
                .with_marker(Marker::Circle),
        )
        .with(
            Series::points(format!("without grains of fewer than {}", D + 1), without)
                .with_stroke(Stroke::Dotted)
                .with_marker(Marker::Triangle),
        )
        .with_mark(Mark::vertical(task.options.gap, ""));
    Ok(Finding {
        name: "contacts",
        words,
        table,
        picture: chart.to_svg()?,
    })
}

/// The share of contacts in each bin of the angle to the vertical, over that of
/// contacts in random directions.
fn directions<const D: usize>(touching: &[Contact<D>], bins: &Bins) -> Vec<f64> {
    let mut counts = vec![0.0; bins.count()];
    for contact in touching {
        let degrees = libm::acos(contact.normal[D - 1].abs().min(1.0)).to_degrees();
        counts[bins.bin_of(degrees).unwrap_or(bins.count() - 1)] += 1.0;
    }
    let total: f64 = counts.iter().sum();
    let random = |bin: usize| {
        let (low, high) = (bins.edge(bin), bins.edge(bin + 1));
        match D {
            2 => (high - low) / 90.0,
            _ => libm::cos(low.to_radians()) - libm::cos(high.to_radians()),
        }
    };
    let shares = counts.iter().enumerate();
    shares
        .map(|(bin, count)| count / total / random(bin))
        .collect()
}

pub(super) fn tensor<const D: usize>(task: &Task<'_, D>) -> Result<Finding, ProgramError> {
    let bins = Bins::new(0.0, 90.0, ANGLES)?;
    let (mut fabrics, mut angles): (Vec<Fabric<D>>, Vec<Vec<f64>>) = Default::default();
    for sample in task.samples {
        let (touching, counted) = near(sample, task.options.gap)?;
        // Of contacts between two grains of the base nothing can be learnt.
        let touching: Vec<Contact<D>> = touching
            .into_iter()
            .filter(|contact| counted[contact.first] || counted[contact.second])
            .collect();
        fabrics.extend(fabric(&touching));
        angles.push(directions(&touching, &bins));
    }
    if fabrics.is_empty() {
        return Err(ProgramError::NotAnalysed {
            run: task.name.clone(),
            reason: format!(
                "no grains are closer than {} d: no fabric",
                task.options.gap
            ),
        });
    }
    let mean =
        |of: &dyn Fn(&Fabric<D>) -> f64| blocked_mean(&fabrics.iter().map(of).collect::<Vec<_>>());
    let mut table = Columns::new(["quantity", "value", "error", "frames"]);
    let mut row = |name: String, mean: Mean| {
        table.named(name, [mean.value, mean.error, mean.count as f64]);
    };
    row("contacts".to_owned(), mean(&|one| one.contacts as f64));
    let anisotropy = mean(&|one| one.anisotropy);
    row("anisotropy".to_owned(), anisotropy);
    let mut tensor = SMatrix::<f64, D, D>::zeros();
    for (i, j) in (0..D).flat_map(|i| (i..D).map(move |j| (i, j))) {
        let part = mean(&|one| one.tensor[(i, j)]);
        tensor[(i, j)] = part.value;
        row(format!("F_{}{}", axis_name(i), axis_name(j)), part);
    }
    for number in 0..D {
        let name = format!("eigenvalue_{}", number + 1);
        row(name, mean(&|one| one.eigenvalues[number]));
    }
    let up: Vector<D> = Vector::from_fn(|axis, _| if axis + 1 == D { 1.0 } else { 0.0 });
    let tilt = mean(&|one| libm::acos(one.principal.dot(&up).abs().min(1.0)).to_degrees());
    row("principal_direction_to_vertical_degrees".to_owned(), tilt);
    let shares = Profile::of_frames(&bins, angles.iter().map(Vec::as_slice));
    let values: Vec<f64> = shares.means.iter().map(|mean| mean.value).collect();
    let chart = Chart::new("Directions of contacts")
        .with_axes(
            Axis::new("angle to the vertical", "degrees").with_range(0.0, 90.0),
            Axis::new("contacts, over those in random directions", ""),
        )
        .with(Series::steps("", &bins.edges(), &values))
        .with_mark(Mark::horizontal(1.0, "random"));
    Ok(Finding {
        name: "fabric",
        words: vec![format!(
            "closer than {} d: anisotropy {}; the vertical has F = {:.4}, an isotropic fabric {:.4}",
            task.options.gap,
            with_error(&anisotropy),
            tensor[(D - 1, D - 1)],
            1.0 / D as f64
        )],
        table,
        picture: chart.to_svg()?,
    })
}
