//! Built-in boundaries: a box with periodic, walled or open axes.

mod cuboid;
mod plane;

pub use cuboid::{Cuboid, Side};
pub use plane::Plane;
