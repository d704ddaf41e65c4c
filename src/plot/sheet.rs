//! The sheet a plot is drawn on.

use std::fmt::Display;

use plotters::backend::SVGBackend;
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, IntoDrawingArea};
use plotters::element::{Circle, DashedPathElement, PathElement, Polygon, Rectangle, Text};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontTransform, IntoFont, RGBColor, ShapeStyle, TextStyle};

use crate::plot::{Colour, Marker, PlotError, Stroke};

/// The library draws on whole pixels; here each pixel is made of so many.
const FINE: f64 = 10.0;

/// Black, nearly.
pub(super) const INK: Colour = [0x22, 0x22, 0x22];
/// For what stays in the background.
pub(super) const GREY: Colour = [0x77, 0x77, 0x77];
/// For what is hardly to be seen.
pub(super) const PALE: Colour = [0xe4, 0xe4, 0xe4];

/// A place on the sheet, in pixels from its upper left corner.
pub(super) type Place = (f64, f64);

/// A rectangle, in pixels from the upper left corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Area {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
}

impl Area {
    /// From shares of its width and height, both from the lower left corner.
    pub(super) fn at(&self, x: f64, y: f64) -> Place {
        (
            self.left + x * (self.right - self.left),
            self.bottom - y * (self.bottom - self.top),
        )
    }
}

/// How a text lies about its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Align {
    Left,
    Middle,
    Right,
    /// Centred, read from below.
    Upwards,
}

pub(super) struct Sheet<'a> {
    area: DrawingArea<SVGBackend<'a>, Shift>,
}

/// Draws on a sheet of this size, in pixels, and returns the SVG.
pub(super) fn draw(
    (width, height): (f64, f64),
    on: impl FnOnce(&Sheet<'_>) -> Result<(), PlotError>,
) -> Result<String, PlotError> {
    let mut text = String::new();
    let (fine_width, fine_height) = (fine(width) as u32, fine(height) as u32);
    {
        let backend = SVGBackend::with_string(&mut text, (fine_width, fine_height));
        let sheet = Sheet {
            area: backend.into_drawing_area(),
        };
        let all = Area {
            left: 0.0,
            top: 0.0,
            right: width,
            bottom: height,
        };
        sheet.rectangle(all, [0xff; 3])?;
        on(&sheet)?;
        sheet.area.present().map_err(failed)?;
    }
    // Shown at its own size, not at that of its fine pixels; and no seams where
    // rectangles meet.
    let begin = format!("<svg width=\"{fine_width}\" height=\"{fine_height}\"");
    let shown = format!("<svg width=\"{width}\" height=\"{height}\"");
    let text = text.replacen(&begin, &shown, 1);
    let crisp = ">\n<style>rect { shape-rendering: crispEdges }</style>\n";
    Ok(text.replacen(">\n", crisp, 1))
}

fn failed(error: impl Display) -> PlotError {
    PlotError::Drawing(error.to_string())
}

fn fine(length: f64) -> i32 {
    (length * FINE).round() as i32
}

fn fine_place((x, y): Place) -> (i32, i32) {
    (fine(x), fine(y))
}

fn style([red, green, blue]: Colour, width: f64) -> ShapeStyle {
    ShapeStyle {
        color: RGBColor(red, green, blue).into(),
        filled: false,
        stroke_width: fine(width) as u32,
    }
}

fn filled(colour: Colour) -> ShapeStyle {
    style(colour, 0.0).filled()
}

impl Sheet<'_> {
    /// A line through places.
    pub(super) fn line(
        &self,
        places: &[Place],
        stroke: Stroke,
        colour: Colour,
        width: f64,
    ) -> Result<(), PlotError> {
        let style = style(colour, width);
        let places = places.iter().copied().map(fine_place);
        let (dash, gap) = match stroke {
            Stroke::Solid => {
                let path = PathElement::new(places.collect::<Vec<_>>(), style);
                return self.area.draw(&path).map_err(failed);
            }
            Stroke::Dashed => (7.0, 4.0),
            Stroke::Dotted => (1.6, 2.6),
        };
        let path = DashedPathElement::new(places, fine(dash), fine(gap), style);
        self.area.draw(&path).map_err(failed)
    }

    pub(super) fn rectangle(&self, area: Area, colour: Colour) -> Result<(), PlotError> {
        let corners = [
            fine_place((area.left, area.top)),
            fine_place((area.right, area.bottom)),
        ];
        let shape = Rectangle::new(corners, filled(colour));
        self.area.draw(&shape).map_err(failed)
    }

    pub(super) fn frame(&self, area: Area, colour: Colour, width: f64) -> Result<(), PlotError> {
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0)];
        let places = corners.map(|(x, y)| area.at(x, y));
        self.line(&places, Stroke::Solid, colour, width)
    }

    pub(super) fn marker(
        &self,
        (x, y): Place,
        marker: Marker,
        colour: Colour,
    ) -> Result<(), PlotError> {
        let centre = fine_place((x, y));
        let disk = |radius: f64, style| Circle::new(centre, fine(radius), style);
        let polygon = |corners: &[Place]| {
            let places = corners.iter().map(|(dx, dy)| fine_place((x + dx, y + dy)));
            self.area
                .draw(&Polygon::new(places.collect::<Vec<_>>(), filled(colour)))
                .map_err(failed)
        };
        match marker {
            Marker::Disk => self.area.draw(&disk(3.2, filled(colour))).map_err(failed),
            Marker::Dot => self.area.draw(&disk(1.1, filled(colour))).map_err(failed),
            Marker::Circle => {
                let circle = disk(3.2, style(colour, 1.2));
                self.area.draw(&circle).map_err(failed)
            }
            Marker::Square => polygon(&[(-3.0, -3.0), (3.0, -3.0), (3.0, 3.0), (-3.0, 3.0)]),
            Marker::Triangle => polygon(&[(0.0, -4.0), (3.6, 2.6), (-3.6, 2.6)]),
            Marker::Cross => {
                for side in [-3.0, 3.0] {
                    let ends = [(x - 3.0, y - side), (x + 3.0, y + side)];
                    self.line(&ends, Stroke::Solid, colour, 1.3)?;
                }
                Ok(())
            }
        }
    }

    /// A text of this height, in pixels, centred vertically on its place.
    pub(super) fn text(
        &self,
        text: &str,
        place: Place,
        align: Align,
        size: f64,
        colour: Colour,
    ) -> Result<(), PlotError> {
        if text.is_empty() {
            return Ok(());
        }
        let [red, green, blue] = colour;
        let ink = RGBColor(red, green, blue);
        let horizontal = match align {
            Align::Left => HPos::Left,
            Align::Middle | Align::Upwards => HPos::Center,
            Align::Right => HPos::Right,
        };
        // The backend shrinks fonts by this factor.
        let mut font = ("sans-serif", 1.24 * FINE * size).into_font();
        if align == Align::Upwards {
            font = font.transform(FontTransform::Rotate270);
        }
        let style = TextStyle::from(font)
            .pos(Pos::new(horizontal, VPos::Center))
            .color(&ink);
        self.area
            .draw(&Text::new(text.to_owned(), fine_place(place), style))
            .map_err(failed)
    }
}

/// About how wide a text of this size is, in pixels.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    0.57 * size * text.chars().count() as f64
}
