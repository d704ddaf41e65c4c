//! Drawing by values, within the axes.

use crate::plot::axis::Scale;
use crate::plot::sheet::{Align, Area, GREY, Place, Sheet};
use crate::plot::{Colour, Mark, PlotError, Series, Stroke};

/// Draws values inside the axes.
pub(super) struct Pen<'a, 'b> {
    pub(super) sheet: &'a Sheet<'b>,
    pub(super) area: Area,
    pub(super) across: Scale,
    pub(super) up: Scale,
}

impl Pen<'_, '_> {
    /// As shares of the axes.
    fn shares(&self, [x, y]: [f64; 2]) -> Option<Place> {
        Some((self.across.share(x)?, self.up.share(y)?))
    }

    /// Draws a line as far as it lies inside.
    pub(super) fn line(
        &self,
        points: &[[f64; 2]],
        stroke: Stroke,
        colour: Colour,
        width: f64,
        drawn: &mut Vec<Place>,
    ) -> Result<(), PlotError> {
        let mut piece: Vec<Place> = Vec::new();
        let finish = |piece: &mut Vec<Place>| {
            let line = std::mem::take(piece);
            if line.len() < 2 {
                return Ok(());
            }
            self.sheet.line(&line, stroke, colour, width)
        };
        for pair in points.windows(2) {
            let ends = self.shares(pair[0]).zip(self.shares(pair[1]));
            let Some((from, to)) = ends.and_then(|(from, to)| clipped(from, to)) else {
                finish(&mut piece)?;
                continue;
            };
            let (from, to) = (self.area.at(from.0, from.1), self.area.at(to.0, to.1));
            if piece.last() != Some(&from) {
                finish(&mut piece)?;
                piece.push(from);
            }
            piece.push(to);
            drawn.extend((0..10).map(|step| {
                let part = f64::from(step) / 10.0;
                (
                    from.0 + part * (to.0 - from.0),
                    from.1 + part * (to.1 - from.1),
                )
            }));
        }
        finish(&mut piece)
    }

    pub(super) fn series(
        &self,
        series: &Series,
        colour: Colour,
        drawn: &mut Vec<Place>,
    ) -> Result<(), PlotError> {
        if let Some(stroke) = series.stroke {
            self.line(&series.points, stroke, colour, 1.6, drawn)?;
        }
        for (number, &point) in series.points.iter().enumerate() {
            for (axis, errors) in [(0, &series.horizontal_errors), (1, &series.errors)] {
                if let Some(&error) = errors.get(number) {
                    self.error_bar(point, axis, error, colour, drawn)?;
                }
            }
            let inside = |(x, y): &Place| {
                (-1.0e-9..=1.0 + 1.0e-9).contains(x) && (-1.0e-9..=1.0 + 1.0e-9).contains(y)
            };
            let Some((x, y)) = self.shares(point).filter(inside) else {
                continue;
            };
            let place = self.area.at(x, y);
            if let Some(marker) = series.marker {
                drawn.push(place);
                self.sheet.marker(place, marker, colour)?;
            }
        }
        Ok(())
    }

    fn error_bar(
        &self,
        point: [f64; 2],
        axis: usize,
        error: f64,
        colour: Colour,
        drawn: &mut Vec<Place>,
    ) -> Result<(), PlotError> {
        if !(error > 0.0 && error.is_finite()) {
            return Ok(());
        }
        let (mut low, mut high) = (point, point);
        low[axis] -= error;
        high[axis] += error;
        let Some(top) = self.shares(high) else {
            return Ok(());
        };
        // A bar that reaches down to where there is no logarithm goes on to the
        // end of the axis.
        let bottom = self.shares(low).or_else(|| {
            let mut end = self.shares(point)?;
            *[&mut end.0, &mut end.1][axis] = 0.0;
            Some(end)
        });
        let Some((from, to)) = bottom.and_then(|bottom| clipped(bottom, top)) else {
            return Ok(());
        };
        let ends = [self.area.at(from.0, from.1), self.area.at(to.0, to.1)];
        self.sheet.line(&ends, Stroke::Solid, colour, 1.0)?;
        for (x, y) in ends {
            let cap = if axis == 1 {
                [(x - 2.5, y), (x + 2.5, y)]
            } else {
                [(x, y - 2.5), (x, y + 2.5)]
            };
            self.sheet.line(&cap, Stroke::Solid, colour, 1.0)?;
            drawn.push((x, y));
        }
        Ok(())
    }

    pub(super) fn mark(&self, mark: &Mark) -> Result<(), PlotError> {
        let scale = if mark.vertical { self.across } else { self.up };
        let Some(share) = scale.share(mark.at).filter(|at| (0.0..=1.0).contains(at)) else {
            return Ok(());
        };
        let (from, to) = match mark.vertical {
            true => (self.area.at(share, 0.0), self.area.at(share, 1.0)),
            false => (self.area.at(0.0, share), self.area.at(1.0, share)),
        };
        self.sheet.line(&[from, to], Stroke::Dotted, GREY, 1.2)?;
        let (place, align) = match mark.vertical {
            true => ((to.0 + 4.0, to.1 + 9.0), Align::Left),
            false => ((to.0 - 4.0, to.1 - 7.0), Align::Right),
        };
        self.sheet.text(&mark.label, place, align, 11.0, GREY)
    }
}

/// What lies of a straight piece inside the unit square; `None` if nothing.
fn clipped(from: Place, to: Place) -> Option<(Place, Place)> {
    // Liang & Barsky: the shares of the way where it enters and leaves.
    let (mut enters, mut leaves) = (0.0_f64, 1.0_f64);
    for (start, way) in [(from.0, to.0 - from.0), (from.1, to.1 - from.1)] {
        // Both faces, each as (distance to the inside, speed towards the outside).
        for (inside, outwards) in [(start, -way), (1.0 - start, way)] {
            if outwards == 0.0 {
                if inside < 0.0 {
                    return None;
                }
                continue;
            }
            let reaches = inside / outwards;
            if outwards > 0.0 {
                leaves = leaves.min(reaches);
            } else {
                enters = enters.max(reaches);
            }
        }
    }
    if enters > leaves {
        return None;
    }
    let at = |part: f64| {
        if part == 0.0 {
            from
        } else if part == 1.0 {
            to
        } else {
            (
                from.0 + part * (to.0 - from.0),
                from.1 + part * (to.1 - from.1),
            )
        }
    };
    Some((at(enters), at(leaves)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn lines_end_at_the_frame() {
        let found = clipped((-1.0, 0.5), (3.0, 0.5)).unwrap();
        assert_eq!(found, ((0.0, 0.5), (1.0, 0.5)));
        assert_eq!(clipped((-1.0, 2.0), (2.0, 2.0)), None);
        assert_eq!(clipped((-1.0, 0.5), (0.5, 2.5)), None);
        assert_eq!(
            clipped((0.2, 0.3), (0.2, 0.3)),
            Some(((0.2, 0.3), (0.2, 0.3)))
        );
    }

    proptest! {
        #[test]
        fn what_is_kept_of_a_line_is_inside_and_on_it(
            a in -3.0..3.0f64, b in -3.0..3.0f64, c in -3.0..3.0f64, d in -3.0..3.0f64,
        ) {
            let (from, to) = ((a, b), (c, d));
            let inside = |(x, y): Place| {
                (-1e-9..=1.0 + 1e-9).contains(&x) && (-1e-9..=1.0 + 1e-9).contains(&y)
            };
            let kept = clipped(from, to);
            for step in 0..=200 {
                let part = f64::from(step) / 200.0;
                let point = (a + part * (c - a), b + part * (d - b));
                let well_inside = point.0.min(point.1) > 1e-9 && point.0.max(point.1) < 1.0 - 1e-9;
                prop_assert!(!well_inside || kept.is_some());
            }
            if let Some((begin, end)) = kept {
                prop_assert!(inside(begin) && inside(end));
                for (x, y) in [begin, end] {
                    let off = (x - a) * (d - b) - (y - b) * (c - a);
                    prop_assert!(off.abs() < 1e-9);
                }
            }
        }
    }
}
