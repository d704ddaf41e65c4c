//! Stress and forces.

use std::cell::OnceCell;

use nalgebra::SMatrix;

use crate::analysis::{Mean, blocked_mean};
use crate::particle::Vector;
use crate::plot::{Axis, Chart, Mark, Marker, Series, Stroke};
use crate::program::analyse::Task;
use crate::program::analyse::arguments::axis_name;
use crate::program::analyse::finding::{Columns, Finding, with_error};
use crate::program::analyse::replay::{Forces, Replayed, Watched, replay};
use crate::program::error::ProgramError;
use crate::time::Time;

/// The run once more, carried out for the first that asks.
pub(super) type Again<const D: usize> = OnceCell<Replayed<D>>;

fn again<'a, const D: usize>(
    task: &Task<'a, D>,
    again: &'a Again<D>,
) -> Result<&'a Replayed<D>, ProgramError> {
    if let Some(replayed) = again.get() {
        return Ok(replayed);
    }
    let refuse = |reason: String| ProgramError::NotAnalysed {
        run: task.name.clone(),
        reason,
    };
    let (Some(first), Some(last)) = (task.samples.first(), task.samples.last()) else {
        return Err(refuse("there are no frames in it".to_owned()));
    };
    let asked = |time: Option<f64>, else_: Time| time.map_or(else_, Time::from_units);
    let from = asked(task.options.from, first.time).max(Time::ZERO);
    let to = asked(task.options.to, last.time).min(task.end);
    if from >= to {
        return Err(refuse(format!(
            "stress and force are means over time, and none passes from t = {} to {}",
            from.units(),
            to.units()
        )));
    }
    let axis = task.axis()?;
    let watched = Watched {
        container: last.container,
        axis,
        bins: task.bins(axis, 1.0)?,
        from,
        to,
        frame: (last.time == to).then_some(last.grains.as_slice()),
    };
    let replayed = replay(&task.options.run, &watched)?;
    if replayed.same == Some(false) {
        return Err(refuse(
            "carried out again, it comes to another frame: its scenario.toml has been changed, or it \
             was made by another version of grainfall"
                .to_owned(),
        ));
    }
    Ok(again.get_or_init(|| replayed))
}

/// How sure it is that the same was seen.
fn certainty<const D: usize>(replayed: &Replayed<D>) -> String {
    let [from, to] = [replayed.from, replayed.to].map(Time::units);
    let same = match replayed.same {
        Some(_) => "; the last frame came out the same, bit by bit",
        None => "",
    };
    format!("carried out again and watched, t = {from:.2} to {to:.2}{same}")
}

pub(super) fn stress<const D: usize>(
    task: &Task<'_, D>,
    cell: &Again<D>,
) -> Result<Finding, ProgramError> {
    let replayed = again(task, cell)?;
    let (axis, stresses) = (task.axis()?, &replayed.stresses);
    let bins = task.bins(axis, 1.0)?;
    const NAMES: [[&str; 6]; 2] = [
        [
            "collisional_xx",
            "collisional_yy",
            "collisional_xy",
            "collisional_zz",
            "collisional_xz",
            "collisional_yz",
        ],
        [
            "kinetic_xx",
            "kinetic_yy",
            "kinetic_xy",
            "kinetic_zz",
            "kinetic_xz",
            "kinetic_yz",
        ],
    ];
    // In the order of the names; the first three are of the plane.
    let places: &[(usize, usize)] = match D {
        2 => &[(0, 0), (1, 1), (0, 1)],
        _ => &[(0, 0), (1, 1), (0, 1), (2, 2), (0, 2), (1, 2)],
    };
    let mut names = vec![axis_name(axis)];
    for part in NAMES {
        names.extend(&part[..places.len()]);
    }
    let mut table = Columns::new(names);
    for (centre, stress) in bins.centres().into_iter().zip(stresses) {
        let parts = [&stress.collisional, &stress.kinetic];
        let cells = parts
            .into_iter()
            .flat_map(|part: &SMatrix<f64, D, D>| places.iter().map(|&place| part[place]));
        table.numbers(std::iter::once(centre).chain(cells));
    }
    let unit = if D == 2 { "mg/d" } else { "mg/d²" };
    let mut chart = Chart::new("Stress of what moves")
        .with_axes(Axis::new(axis_name(axis), "d"), Axis::new("stress", unit));
    let strokes = [Stroke::Solid, Stroke::Dashed, Stroke::Dotted];
    for (component, stroke) in (0..D).zip(strokes) {
        let name = axis_name(component);
        let points = bins
            .centres()
            .into_iter()
            .zip(stresses)
            .map(|(centre, stress)| [centre, stress.total()[(component, component)]]);
        let series = Series::points(format!("σ_{name}{name}"), points);
        chart = chart.with(series.with_marker(Marker::Dot).with_stroke(stroke));
    }
    let greatest = bins
        .centres()
        .into_iter()
        .zip(stresses.iter().map(crate::analysis::Stress::pressure))
        .reduce(|one, other| if other.1 > one.1 { other } else { one });
    let mut words = vec![certainty(replayed)];
    if let Some((place, pressure)) = greatest {
        words.push(format!(
            "greatest pressure {pressure:.4} {unit} at {} = {place:.2} d; what sleeps transmits none",
            axis_name(axis)
        ));
    }
    Ok(Finding {
        name: "stress",
        words,
        table,
        picture: chart.to_svg()?,
    })
}

/// A part of the forces.
type Part<const D: usize> = fn(&Forces<D>) -> Vector<D>;

pub(super) fn force<const D: usize>(
    task: &Task<'_, D>,
    cell: &Again<D>,
) -> Result<Finding, ProgramError> {
    const COLUMNS: [[&str; 3]; 3] = [
        ["fixed_x", "fixed_y", "fixed_z"],
        ["asleep_x", "asleep_y", "asleep_z"],
        ["by_sleep_x", "by_sleep_y", "by_sleep_z"],
    ];
    const WALLS: [[&str; 3]; 6] = [
        ["wall_0_x", "wall_0_y", "wall_0_z"],
        ["wall_1_x", "wall_1_y", "wall_1_z"],
        ["wall_2_x", "wall_2_y", "wall_2_z"],
        ["wall_3_x", "wall_3_y", "wall_3_z"],
        ["wall_4_x", "wall_4_y", "wall_4_z"],
        ["wall_5_x", "wall_5_y", "wall_5_z"],
    ];
    let replayed = again(task, cell)?;
    let forces = &replayed.forces;
    let walls = forces.first().map_or(0, |first| first.walls.len());
    let mut names = vec!["time"];
    for part in COLUMNS.iter().chain(WALLS.iter().take(walls)) {
        names.extend(&part[..D]);
    }
    let mut table = Columns::new(names);
    for one in forces {
        let parts = [&one.fixed, &one.asleep, &one.by_sleep];
        let all = parts
            .into_iter()
            .chain(&one.walls)
            .flat_map(|part| part.iter());
        table.numbers(std::iter::once(one.time).chain(all.copied()));
    }
    let up = D - 1;
    let mean = |of: &dyn Fn(&Forces<D>) -> f64| -> Mean {
        blocked_mean(&forces.iter().map(of).collect::<Vec<_>>())
    };
    let mut chart = Chart::new("Vertical force of what moves")
        .with_axes(Axis::new("t", "√(d/g)"), Axis::new("upward force", "mg"));
    let mut words = vec![certainty(replayed)];
    let parts: [(&str, Part<D>); 3] = [
        ("on fixed grains", |one| one.fixed),
        ("on grains asleep", |one| one.asleep),
        ("where grains fall asleep", |one| one.by_sleep),
    ];
    for (what, part) in parts {
        if forces.iter().all(|one| part(one) == Vector::<D>::zeros()) {
            continue;
        }
        let points = forces.iter().map(|one| [one.time, part(one)[up]]);
        chart = chart.with(Series::line(what, points));
        words.push(format!(
            "{} mg {what}",
            with_error(&mean(&|one| part(one)[up]))
        ));
    }
    for wall in 0..walls {
        let size = |one: &Forces<D>| one.walls[wall].norm_squared().sqrt();
        words.push(format!("{} mg on wall {wall}", with_error(&mean(&size))));
        let points = forces.iter().map(|one| [one.time, one.walls[wall][up]]);
        chart = chart.with(Series::line(format!("on wall {wall}"), points));
    }
    Ok(Finding {
        name: "force",
        words,
        table,
        picture: chart.with_mark(Mark::horizontal(0.0, "")).to_svg()?,
    })
}
