//! What is drawn in a chart.

use crate::plot::{Colour, PlotError};

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stroke {
    /// In one piece.
    Solid,
    /// In long pieces.
    Dashed,
    /// In short pieces.
    Dotted,
}

/// How a point is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marker {
    /// A full circle.
    Disk,
    /// An empty circle.
    Circle,
    /// A full square.
    Square,
    /// A full triangle.
    Triangle,
    /// Two short lines, crossed.
    Cross,
    /// A full circle as small as can be seen, for crowds.
    Dot,
}

/// One curve, or one set of points.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    pub(super) name: String,
    pub(super) points: Vec<[f64; 2]>,
    pub(super) errors: Vec<f64>,
    pub(super) horizontal_errors: Vec<f64>,
    pub(super) stroke: Option<Stroke>,
    pub(super) marker: Option<Marker>,
    pub(super) colour: Option<Colour>,
}

impl Series {
    fn new(name: impl Into<String>, points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        Series {
            name: name.into(),
            points: points.into_iter().collect(),
            errors: Vec::new(),
            horizontal_errors: Vec::new(),
            stroke: None,
            marker: None,
            colour: None,
        }
    }

    /// A line through points (x, y). The legend shows the name; an empty one is
    /// left out of it. Where a coordinate is not finite the line is
    /// interrupted.
    #[must_use]
    pub fn line(name: impl Into<String>, points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        let mut series = Series::new(name, points);
        series.stroke = Some(Stroke::Solid);
        series
    }

    /// A dashed line through points.
    #[must_use]
    pub fn dashed(name: impl Into<String>, points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        Series::line(name, points).with_stroke(Stroke::Dashed)
    }

    /// Points without a line.
    #[must_use]
    pub fn points(name: impl Into<String>, points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        Series::new(name, points).with_marker(Marker::Disk)
    }

    /// Steps: the value k between the edges k and k + 1, as of a histogram. Edges
    /// or values that have no partner are left out.
    #[must_use]
    pub fn steps(name: impl Into<String>, edges: &[f64], values: &[f64]) -> Self {
        let pieces = edges.windows(2).zip(values);
        let points = pieces.flat_map(|(edge, &value)| [[edge[0], value], [edge[1], value]]);
        Series::line(name, points)
    }

    /// The same with vertical error bars of these half-lengths, one a point. A
    /// length that is not a number has no bar.
    #[must_use]
    pub fn with_errors(mut self, errors: Vec<f64>) -> Self {
        self.errors = errors;
        self
    }

    /// The same with horizontal error bars, likewise.
    #[must_use]
    pub fn with_horizontal_errors(mut self, errors: Vec<f64>) -> Self {
        self.horizontal_errors = errors;
        self
    }

    /// The same with a line of this kind through its points.
    #[must_use]
    pub fn with_stroke(mut self, stroke: Stroke) -> Self {
        self.stroke = Some(stroke);
        self
    }

    /// The same with such markers at its points.
    #[must_use]
    pub fn with_marker(mut self, marker: Marker) -> Self {
        self.marker = Some(marker);
        self
    }

    /// The same in this colour, in place of the next of
    /// [`SERIES_COLOURS`](crate::plot::SERIES_COLOURS).
    #[must_use]
    pub fn with_colour(mut self, colour: Colour) -> Self {
        self.colour = Some(colour);
        self
    }

    pub(super) fn check(&self) -> Result<(), PlotError> {
        let wanted = self.points.len();
        for (what, errors) in [
            ("the list of errors", &self.errors),
            ("the list of horizontal errors", &self.horizontal_errors),
        ] {
            if !errors.is_empty() && errors.len() != wanted {
                return Err(PlotError::Length {
                    what,
                    name: self.name.clone(),
                    found: errors.len(),
                    wanted,
                });
            }
        }
        Ok(())
    }

    /// What lies on an axis (0 across, 1 up), error bars included.
    pub(super) fn values(&self, axis: usize) -> impl Iterator<Item = f64> {
        let errors = [&self.horizontal_errors, &self.errors][axis];
        let shown = self
            .points
            .iter()
            .enumerate()
            .filter(|(_, point)| point.iter().all(|part| part.is_finite()));
        shown.flat_map(move |(number, point)| {
            let error = errors.get(number).copied().unwrap_or(0.0);
            let error = if error.is_finite() { error } else { 0.0 };
            [point[axis] - error, point[axis], point[axis] + error]
        })
    }
}

/// A straight line across a chart, at a value.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    pub(super) at: f64,
    pub(super) vertical: bool,
    pub(super) label: String,
}

impl Mark {
    /// At a height y, with a label at its end.
    #[must_use]
    pub fn horizontal(at: f64, label: impl Into<String>) -> Self {
        Mark {
            at,
            vertical: false,
            label: label.into(),
        }
    }

    /// At a place x, with a label at its top.
    #[must_use]
    pub fn vertical(at: f64, label: impl Into<String>) -> Self {
        Mark {
            at,
            vertical: true,
            label: label.into(),
        }
    }
}
