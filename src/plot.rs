//! Plots as SVG: curves and points with error bars, fields in the plane.
//!
//! A [`Chart`] holds [`Series`] over two [`Axis`]; a [`Map`] a field in colours,
//! with lines of equal value. Both are values that are filled and then drawn:
//!
//! ```
//! use grainfall::plot::{Axis, Chart, Mark, PlotError, Series};
//!
//! # fn main() -> Result<(), PlotError> {
//! let measured = [[0.01, 0.639], [0.05, 0.632], [0.1, 0.627]];
//! let picture = Chart::new("Packing fraction")
//!     .with_axes(Axis::new("threshold", "√(gd)").logarithmic(), Axis::new("φ", ""))
//!     .with(Series::points("measured", measured).with_errors(vec![0.001, 0.002, 0.0005]))
//!     .with(Series::dashed("fit", [[0.01, 0.6389], [0.1, 0.629]]))
//!     .with_mark(Mark::horizontal(0.64, "random close packing"))
//!     .to_svg()?;
//! assert!(picture.starts_with("<svg") && picture.contains("threshold (√(gd))"));
//! # Ok(())
//! # }
//! ```
//!
//! Texts stay texts, in the reader's sans-serif font. The same input gives the
//! same bytes on every machine.

mod axis;
mod chart;
mod colour;
mod iso;
mod legend;
mod map;
mod series;
mod sheet;

pub use axis::Axis;
pub use chart::{Chart, Corner};
pub use colour::{Colour, SERIES_COLOURS, sequential};
pub use iso::iso_lines;
pub use map::Map;
pub use series::{Mark, Marker, Series, Stroke};

/// Why a plot can't be drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlotError {
    /// A list is not as long as it has to be.
    #[error("{what} of `{name}` has {found} entries; {wanted} are wanted")]
    Length {
        /// Which list.
        what: &'static str,
        /// Of which series or map.
        name: String,
        /// Its length.
        found: usize,
        /// The length it has to have.
        wanted: usize,
    },
    /// The range of an axis is empty, or has no logarithm.
    #[error(
        "the range of the axis `{axis}` is {low} to {high}; two finite numbers are wanted, the \
         first smaller, both above 0 where the axis is logarithmic"
    )]
    Range {
        /// Its label.
        axis: String,
        /// Where it begins.
        low: f64,
        /// Where it ends.
        high: f64,
    },
    /// The drawing library has failed.
    #[error("the picture can't be drawn: {0}")]
    Drawing(String),
}
