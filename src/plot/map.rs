//! Fields in the plane.

use crate::plot::axis::Scale;
use crate::plot::chart::{Pen, axes, title};
use crate::plot::sheet::{Align, Area, INK, Sheet, draw, text_width};
use crate::plot::{Axis, Colour, PlotError, Stroke, iso_lines, sequential};

/// So many shades are told apart, so that neighbours of one shade are one
/// rectangle.
const SHADES: usize = 64;
/// Cells of which nothing is known.
const UNKNOWN: Colour = [0xee, 0xee, 0xee];
/// The longer side of what is shown, in pixels.
const LONGEST: f64 = 520.0;

/// A field over a rectangle, in colours, with lines of equal value.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    title: String,
    across: Axis,
    up: Axis,
    values_axis: Axis,
    columns: usize,
    values: Vec<f64>,
    extent: [[f64; 2]; 2],
    levels: Vec<(f64, String)>,
}

impl Map {
    /// The values of a field in cells, row by row from below, each row of
    /// `columns` cells from the left; `across` and `up` are the extents of the
    /// whole. Cells whose value is not a number stay grey.
    ///
    /// Both axes have the same scale unless one is more than eight times the
    /// other.
    #[must_use]
    pub fn new(
        title: impl Into<String>,
        columns: usize,
        values: Vec<f64>,
        across: [f64; 2],
        up: [f64; 2],
    ) -> Self {
        Map {
            title: title.into(),
            across: Axis::new("x", "d"),
            up: Axis::new("y", "d"),
            values_axis: Axis::new("", ""),
            columns,
            values,
            extent: [across, up],
            levels: Vec::new(),
        }
    }

    /// The same with these axes: across, up, and the scale of the colours. The
    /// ranges of the first two are those of the field.
    #[must_use]
    pub fn with_axes(mut self, across: Axis, up: Axis, values: Axis) -> Self {
        self.across = across;
        self.up = up;
        self.values_axis = values;
        self
    }

    /// The same with lines where the field has this value, and what to call
    /// them beside the scale of the colours.
    #[must_use]
    pub fn with_level(mut self, value: f64, label: impl Into<String>) -> Self {
        self.levels.push((value, label.into()));
        self
    }

    /// The picture.
    ///
    /// # Errors
    ///
    /// When the values do not fill whole rows, at least two of at least two
    /// columns; when an extent or the range of the colours is empty.
    pub fn to_svg(&self) -> Result<String, PlotError> {
        let mut lines = Vec::new();
        let [across, up] = self.extent;
        for (number, (level, _)) in self.levels.iter().enumerate() {
            for line in iso_lines(&self.values, self.columns, across, up, *level)? {
                lines.push((number, line));
            }
        }
        let rows = self.values.len() / self.columns.max(1);
        if rows == 0 || rows * self.columns != self.values.len() {
            return Err(PlotError::Length {
                what: "the field",
                name: self.title.clone(),
                found: self.values.len(),
                wanted: self.columns.max(1) * rows.max(1),
            });
        }
        let ranged =
            |axis: &Axis, [low, high]: [f64; 2]| axis.clone().with_range(low, high).scale([], 0.0);
        let across = ranged(&self.across, across)?;
        let up = ranged(&self.up, up)?;
        let shades = self.values_axis.scale(self.values.iter().copied(), 0.0)?;
        let area = self.area(across.width(), up.width());
        let labels = self.levels.iter().map(|(_, label)| label);
        let widest = labels
            .map(|label| 82.0 + text_width(label, 11.0))
            .fold(30.0 + text_width(&self.values_axis.label(), 13.0), f64::max);
        let size = (area.right + widest.max(90.0).ceil(), area.bottom + 54.0);
        draw(size, |sheet| {
            self.cells(sheet, area, rows, &shades)?;
            let pen = Pen {
                sheet,
                area,
                across,
                up,
            };
            for (number, line) in &lines {
                let stroke = [Stroke::Solid, Stroke::Dashed, Stroke::Dotted][number % 3];
                // Light under dark is seen on every shade.
                pen.line(line, Stroke::Solid, [0xff; 3], 2.4, &mut Vec::new())?;
                pen.line(line, stroke, INK, 1.2, &mut Vec::new())?;
            }
            axes(sheet, area, (&self.across, &across), (&self.up, &up), false)?;
            sheet.frame(area, INK, 1.0)?;
            title(sheet, &self.title, size)?;
            self.shade_scale(sheet, area, &shades)
        })
    }

    fn area(&self, width: f64, height: f64) -> Area {
        let aspect = (height / width).clamp(0.125, 8.0);
        let (width, height) = match aspect {
            tall if tall > 1.0 => ((LONGEST / tall).max(160.0), LONGEST),
            flat => (LONGEST, (LONGEST * flat).max(120.0)),
        };
        Area {
            left: 78.0,
            top: 38.0,
            right: (78.0 + width).round(),
            bottom: (38.0 + height).round(),
        }
    }

    /// The cells, those of one shade that lie side by side in one piece.
    fn cells(
        &self,
        sheet: &Sheet<'_>,
        area: Area,
        rows: usize,
        shades: &Scale,
    ) -> Result<(), PlotError> {
        sheet.rectangle(area, UNKNOWN)?;
        for row in 0..rows {
            let values = &self.values[row * self.columns..(row + 1) * self.columns];
            let shade = |column: usize| shades.share(values[column]).map(shade_of);
            let mut column = 0;
            while column < self.columns {
                let first = column;
                let found = shade(first);
                while column < self.columns && shade(column) == found {
                    column += 1;
                }
                let Some(found) = found else {
                    continue;
                };
                let at = |column: usize, row: usize| {
                    let (x, y) = (column as f64, row as f64);
                    area.at(x / self.columns as f64, y / rows as f64)
                };
                let (left, bottom) = at(first, row);
                let (right, top) = at(column, row + 1);
                let piece = Area {
                    left,
                    top,
                    right,
                    bottom,
                };
                sheet.rectangle(piece, colour_of(found))?;
            }
        }
        Ok(())
    }

    fn shade_scale(&self, sheet: &Sheet<'_>, area: Area, shades: &Scale) -> Result<(), PlotError> {
        let scale = Area {
            left: area.right + 20.0,
            right: area.right + 36.0,
            ..area
        };
        for shade in 0..SHADES {
            let (left, bottom) = scale.at(0.0, shade as f64 / SHADES as f64);
            let (right, top) = scale.at(1.0, (shade + 1) as f64 / SHADES as f64);
            let piece = Area {
                left,
                top,
                right,
                bottom,
            };
            sheet.rectangle(piece, colour_of(shade))?;
        }
        let wanted = ((scale.bottom - scale.top) / 50.0) as usize;
        for tick in shades.ticks(wanted.clamp(2, 10)) {
            let (x, y) = scale.at(1.0, tick.share);
            sheet.line(&[(x, y), (x + 4.0, y)], Stroke::Solid, INK, 0.8)?;
            sheet.text(&tick.label, (x + 7.0, y), Align::Left, 12.0, INK)?;
        }
        for (number, (level, label)) in self.levels.iter().enumerate() {
            let Some(share) = shades.share(*level).filter(|at| (0.0..=1.0).contains(at)) else {
                continue;
            };
            let (x, y) = scale.at(0.0, share);
            let ends = [(x, y), (scale.right, y)];
            let stroke = [Stroke::Solid, Stroke::Dashed, Stroke::Dotted][number % 3];
            sheet.line(&ends, Stroke::Solid, [0xff; 3], 2.4)?;
            sheet.line(&ends, stroke, INK, 1.2)?;
            sheet.text(label, (scale.right + 40.0, y), Align::Left, 11.0, INK)?;
        }
        sheet.frame(scale, INK, 1.0)?;
        let place = (scale.left, area.bottom + 36.0);
        sheet.text(&self.values_axis.label(), place, Align::Left, 13.0, INK)
    }
}

fn shade_of(share: f64) -> usize {
    ((share.clamp(0.0, 1.0) * SHADES as f64) as usize).min(SHADES - 1)
}

fn colour_of(shade: usize) -> Colour {
    sequential((shade as f64 + 0.5) / SHADES as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(values: Vec<f64>) -> Map {
        Map::new("field", 3, values, [0.0, 3.0], [0.0, 2.0]).with_axes(
            Axis::new("x", "d"),
            Axis::new("z", "d"),
            Axis::new("φ", "").with_range(0.0, 1.0),
        )
    }

    #[test]
    fn neighbours_of_one_shade_are_one_rectangle() {
        let rectangles = |values| map(values).to_svg().unwrap().matches("<rect").count();
        let plain = rectangles(vec![0.5; 6]);
        assert_eq!(rectangles(vec![0.1, 0.5, 0.9, 0.5, 0.5, 0.5]), plain + 2);
        // Nothing known: only the ground.
        assert_eq!(rectangles(vec![f64::NAN; 6]), plain - 2);
    }

    #[test]
    fn levels_are_drawn_and_named() {
        let values = vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        let picture = map(values.clone())
            .with_level(0.5, "a half")
            .to_svg()
            .unwrap();
        assert!(picture.contains("a half"));
        // Above and below the line at the height 1: half the picture is dark.
        assert_eq!(
            picture.matches("<polyline").count(),
            map(values.clone())
                .to_svg()
                .unwrap()
                .matches("<polyline")
                .count()
                + 4
        );
        assert!(map(values[..5].to_vec()).to_svg().is_err());
        assert!(map(Vec::new()).to_svg().is_err());
    }
}
