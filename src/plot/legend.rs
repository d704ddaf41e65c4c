//! The legend of a chart.

use crate::plot::chart::Corner;
use crate::plot::sheet::{Align, Area, INK, PALE, Place, Sheet, text_width};
use crate::plot::{Colour, PlotError, Series, Stroke};

/// Height of a line, in pixels.
const LINE: f64 = 17.0;
/// Height of the letters, in pixels.
const LETTERS: f64 = 12.0;
/// Length of a sample, in pixels.
const SAMPLE: f64 = 26.0;
/// Between its frame and what is in it, and between it and the axes.
const MARGIN: f64 = 7.0;

/// Where the legend of these series lies in each corner of a chart.
fn area(corner: Corner, entries: &[(&Series, Colour)], chart: Area) -> Area {
    let widest = entries
        .iter()
        .map(|(series, _)| text_width(&series.name, LETTERS))
        .fold(0.0, f64::max);
    let width = widest + SAMPLE + 3.0 * MARGIN;
    let height = LINE * entries.len() as f64 + MARGIN;
    let (left, top) = match corner {
        Corner::TopLeft => (chart.left + MARGIN, chart.top + MARGIN),
        Corner::TopRight => (chart.right - MARGIN - width, chart.top + MARGIN),
        Corner::BottomLeft => (chart.left + MARGIN, chart.bottom - MARGIN - height),
        Corner::BottomRight => (chart.right - MARGIN - width, chart.bottom - MARGIN - height),
    };
    Area {
        left,
        top,
        right: left + width,
        bottom: top + height,
    }
}

/// The corner where the legend covers the least of what is drawn; the first of
/// several.
fn emptiest(entries: &[(&Series, Colour)], chart: Area, drawn: &[Place]) -> Corner {
    let corners = [
        Corner::TopRight,
        Corner::TopLeft,
        Corner::BottomRight,
        Corner::BottomLeft,
    ];
    let covered = |corner: &Corner| {
        let area = area(*corner, entries, chart);
        drawn
            .iter()
            .filter(|(x, y)| {
                (area.left..area.right).contains(x) && (area.top..area.bottom).contains(y)
            })
            .count()
    };
    corners
        .into_iter()
        .min_by_key(covered)
        .unwrap_or(Corner::TopRight)
}

/// Draws the legend of all series that have a name.
pub(super) fn draw(
    sheet: &Sheet<'_>,
    chart: Area,
    corner: Option<Corner>,
    series: &[(&Series, Colour)],
    drawn: &[Place],
) -> Result<(), PlotError> {
    let entries: Vec<_> = series
        .iter()
        .copied()
        .filter(|(series, _)| !series.name.is_empty())
        .collect();
    if entries.is_empty() {
        return Ok(());
    }
    let corner = corner.unwrap_or_else(|| emptiest(&entries, chart, drawn));
    let area = area(corner, &entries, chart);
    sheet.rectangle(area, [0xff; 3])?;
    sheet.frame(area, PALE, 1.0)?;
    for (number, (series, colour)) in entries.into_iter().enumerate() {
        let y = area.top + 0.5 * MARGIN + LINE * (number as f64 + 0.5);
        let x = area.left + MARGIN;
        if let Some(stroke) = series.stroke {
            sheet.line(&[(x, y), (x + SAMPLE, y)], stroke, colour, 1.6)?;
        }
        if let Some(marker) = series.marker {
            let centre = (x + 0.5 * SAMPLE, y);
            if !series.errors.is_empty() {
                let ends = [(centre.0, y - 6.0), (centre.0, y + 6.0)];
                sheet.line(&ends, Stroke::Solid, colour, 1.0)?;
            }
            sheet.marker(centre, marker, colour)?;
        }
        let place = (x + SAMPLE + MARGIN, y);
        sheet.text(&series.name, place, Align::Left, LETTERS, INK)?;
    }
    Ok(())
}
