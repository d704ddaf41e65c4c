//! What parameters of criteria may be.

use crate::error::SetupError;

/// Refuses what is not a finite number greater than 0.
pub(super) fn positive(field: &'static str, value: f64) -> Result<(), SetupError> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(SetupError::Parameter {
        field,
        value,
        allowed: "a number greater than 0 is allowed",
    })
}
