//! Built-in dynamics: no force, uniform gravity, growing diameters.

mod flights;
mod force_free;
mod growing;
mod uniform_gravity;

pub use flights::{Parabola, Straight};
pub use force_free::ForceFree;
pub use growing::Growing;
pub use uniform_gravity::UniformGravity;
