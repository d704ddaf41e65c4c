//! What parameters of criteria may be.

use crate::error::{SetupError, require};

/// Refuses what is not a finite number greater than 0.
pub(super) fn positive(field: &'static str, value: f64) -> Result<(), SetupError> {
    let holds = value > 0.0 && value.is_finite();
    require(holds, field, value, "a number greater than 0 is allowed")
}

/// Refuses what is below 0, and what is not a number; infinity is allowed.
pub(super) fn not_negative(field: &'static str, value: f64) -> Result<(), SetupError> {
    require(value >= 0.0, field, value, "0 or more is allowed")
}

/// Refuses what is no part of a whole, 0 … 1.
pub(super) fn fraction(field: &'static str, value: f64) -> Result<(), SetupError> {
    let holds = (0.0..=1.0).contains(&value);
    require(holds, field, value, "0 … 1 is allowed")
}

/// Refuses what is no range of neighbours, in units of the distance at contact.
pub(super) fn neighbour_range(field: &'static str, value: f64) -> Result<(), SetupError> {
    let holds = (1.0..=2.0).contains(&value);
    require(holds, field, value, "1 … 2 is allowed")
}
