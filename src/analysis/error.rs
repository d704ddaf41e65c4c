//! What cannot be measured, and why.

/// A measurement that is refused: what is wrong, its value, what is allowed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AnalysisError {
    /// A number is out of its range.
    #[error("{field} is {value}; {allowed}")]
    Parameter {
        /// Which.
        field: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// There is no such axis.
    #[error("axis {axis} is asked for; in {dimension} dimensions the axes are 0 to {}", dimension - 1)]
    Axis {
        /// The axis.
        axis: usize,
        /// The number of dimensions.
        dimension: usize,
    },
    /// A distance reaches farther than what is known.
    #[error("the distance {distance} is too long; {allowed} is the longest here: {reason}")]
    Distance {
        /// The distance, in d.
        distance: f64,
        /// The longest one, in d.
        allowed: f64,
        /// Why.
        reason: &'static str,
    },
    /// There is nothing to measure.
    #[error("there are no {0} to measure")]
    Nothing(&'static str),
    /// Frames that do not belong together.
    #[error("frame {frame} has {found} grains, the first has {wanted}; {what} needs the same ones")]
    Grains {
        /// Counted from 0.
        frame: usize,
        /// How many grains it has.
        found: usize,
        /// How many the first one has.
        wanted: usize,
        /// What is to be measured.
        what: &'static str,
    },
}

/// Refuses an axis that is not there.
pub(super) fn check_axis<const D: usize>(axis: usize) -> Result<(), AnalysisError> {
    if axis < D {
        return Ok(());
    }
    Err(AnalysisError::Axis { axis, dimension: D })
}
