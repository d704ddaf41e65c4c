//! Charts: series over two axes.

use crate::plot::axis::Scale;
use crate::plot::legend;
use crate::plot::sheet::{Align, Area, GREY, INK, PALE, Place, Sheet, draw};
use crate::plot::{Axis, Colour, Mark, PlotError, SERIES_COLOURS, Series, Stroke};

/// Where a legend lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Corner {
    /// Above, on the left.
    TopLeft,
    /// Above, on the right.
    TopRight,
    /// Below, on the left.
    BottomLeft,
    /// Below, on the right.
    BottomRight,
}

/// Curves and points over two axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    title: String,
    across: Axis,
    up: Axis,
    series: Vec<Series>,
    marks: Vec<Mark>,
    corner: Option<Corner>,
    size: (f64, f64),
}

impl Chart {
    /// An empty chart of 640 × 440 pixels.
    #[must_use]
    pub fn new(title: impl Into<String>) -> Self {
        Chart {
            title: title.into(),
            across: Axis::new("", ""),
            up: Axis::new("", ""),
            series: Vec::new(),
            marks: Vec::new(),
            corner: None,
            size: (640.0, 440.0),
        }
    }

    /// The same over these axes: the first across, the second up.
    #[must_use]
    pub fn with_axes(mut self, across: Axis, up: Axis) -> Self {
        self.across = across;
        self.up = up;
        self
    }

    /// The same with one more series, drawn over those before.
    #[must_use]
    pub fn with(mut self, series: Series) -> Self {
        self.series.push(series);
        self
    }

    /// The same with one more mark, drawn under all series. It does not widen
    /// an axis; a mark outside of the range is not drawn.
    #[must_use]
    pub fn with_mark(mut self, mark: Mark) -> Self {
        self.marks.push(mark);
        self
    }

    /// The same with the legend in this corner, in place of the emptiest.
    #[must_use]
    pub fn with_legend(mut self, corner: Corner) -> Self {
        self.corner = Some(corner);
        self
    }

    /// The same in another size, in pixels; at least 200 × 150.
    #[must_use]
    pub fn with_size(mut self, width: u32, height: u32) -> Self {
        let at_least = |length: u32, least: u32| f64::from(length.clamp(least, 10_000));
        self.size = (at_least(width, 200), at_least(height, 150));
        self
    }

    /// The picture.
    ///
    /// # Errors
    ///
    /// When the range of an axis is empty, or a series has more or fewer error
    /// bars than points.
    pub fn to_svg(&self) -> Result<String, PlotError> {
        for series in &self.series {
            series.check()?;
        }
        let values = |axis| {
            self.series
                .iter()
                .flat_map(move |series| series.values(axis))
        };
        let across = self.across.scale(values(0), 0.03)?;
        let up = self.up.scale(values(1), 0.05)?;
        let area = plot_area(self.size, !self.title.is_empty());
        draw(self.size, |sheet| {
            axes(sheet, area, (&self.across, &across), (&self.up, &up), true)?;
            title(sheet, &self.title, self.size)?;
            let pen = Pen {
                sheet,
                area,
                across,
                up,
            };
            for mark in &self.marks {
                pen.mark(mark)?;
            }
            let coloured: Vec<(&Series, Colour)> = self
                .series
                .iter()
                .enumerate()
                .map(|(number, series)| {
                    let next = SERIES_COLOURS[number % SERIES_COLOURS.len()];
                    (series, series.colour.unwrap_or(next))
                })
                .collect();
            let mut drawn = Vec::new();
            for (series, colour) in &coloured {
                pen.series(series, *colour, &mut drawn)?;
            }
            sheet.frame(area, INK, 1.0)?;
            legend::draw(sheet, area, self.corner, &coloured, &drawn)
        })
    }
}

/// What axes, ticks and labels leave of a sheet.
pub(super) fn plot_area((width, height): (f64, f64), with_title: bool) -> Area {
    Area {
        left: 78.0,
        top: if with_title { 38.0 } else { 14.0 },
        right: width - 22.0,
        bottom: height - 54.0,
    }
}

pub(super) fn title(
    sheet: &Sheet<'_>,
    text: &str,
    (width, _): (f64, f64),
) -> Result<(), PlotError> {
    if text.is_empty() {
        return Ok(());
    }
    sheet.text(text, (0.5 * width, 19.0), Align::Middle, 15.0, INK)
}

/// Ticks, their labels, those of the axes, and a grid if wanted.
pub(super) fn axes(
    sheet: &Sheet<'_>,
    area: Area,
    (across, across_scale): (&Axis, &Scale),
    (up, up_scale): (&Axis, &Scale),
    grid: bool,
) -> Result<(), PlotError> {
    let thin = |from: Place, to: Place, colour| sheet.line(&[from, to], Stroke::Solid, colour, 0.8);
    let wanted = |length: f64, each: f64| ((length / each) as usize).clamp(2, 12);
    for tick in across_scale.ticks(wanted(area.right - area.left, 75.0)) {
        let (x, y) = area.at(tick.share, 0.0);
        let major = !tick.label.is_empty();
        if grid && major {
            thin((x, y), (x, area.top), PALE)?;
        }
        thin((x, y), (x, y - if major { 6.0 } else { 3.0 }), INK)?;
        sheet.text(&tick.label, (x, y + 13.0), Align::Middle, 12.0, INK)?;
    }
    for tick in up_scale.ticks(wanted(area.bottom - area.top, 50.0)) {
        let (x, y) = area.at(0.0, tick.share);
        let major = !tick.label.is_empty();
        if grid && major {
            thin((x, y), (area.right, y), PALE)?;
        }
        thin((x, y), (x + if major { 6.0 } else { 3.0 }, y), INK)?;
        sheet.text(&tick.label, (x - 6.0, y), Align::Right, 12.0, INK)?;
    }
    let middle = area.at(0.5, 0.5);
    let below = (middle.0, area.bottom + 36.0);
    sheet.text(&across.label(), below, Align::Middle, 13.0, INK)?;
    let beside = (16.0, middle.1);
    sheet.text(&up.label(), beside, Align::Upwards, 13.0, INK)
}

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

    fn series(
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

    fn mark(&self, mark: &Mark) -> Result<(), PlotError> {
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

    #[test]
    fn charts_show_their_texts_and_survive_anything() {
        let odd = [
            [f64::NAN, 1.0],
            [1.0, f64::INFINITY],
            [0.0, -3.0],
            [1e-300, 1e300],
        ];
        let chart = Chart::new("a < b & c")
            .with_axes(Axis::new("x", "d").logarithmic(), Axis::new("y", "m"))
            .with(Series::line("odd", odd).with_errors(vec![f64::NAN, 1.0, -1.0, 1e300]))
            .with(Series::points("", []))
            .with_mark(Mark::vertical(f64::NAN, "nowhere"));
        let picture = chart.to_svg().unwrap();
        assert!(picture.contains("a &lt; b &amp; c") && picture.contains("x (d)"));
        assert!(!picture.contains("NaN") && !picture.contains("nowhere"));
        assert_eq!(picture, chart.to_svg().unwrap());
    }

    #[test]
    fn points_outside_of_a_range_are_not_drawn() {
        let chart = |range: f64| {
            Chart::new("")
                .with_axes(Axis::new("", "").with_range(0.0, range), Axis::new("", ""))
                .with(Series::points("", [[1.0, 1.0], [2.0, 2.0], [3.0, 3.0]]))
                .to_svg()
                .unwrap()
        };
        assert_eq!(chart(2.5).matches("<circle").count(), 2);
        assert_eq!(chart(5.0).matches("<circle").count(), 3);
    }

    #[test]
    fn error_bars_and_points_are_as_many() {
        let series = Series::points("speed", [[1.0, 1.0]]).with_errors(vec![0.1, 0.2]);
        let error = Chart::new("").with(series).to_svg().unwrap_err();
        assert!(
            error
                .to_string()
                .contains("`speed` has 2 entries; 1 are wanted")
        );
    }
}
