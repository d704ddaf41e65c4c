//! Built-in dynamics: no force, uniform gravity, gravity or ground that turns,
//! growing diameters.

mod flights;
mod force_free;
mod growing;
mod trochoid;
mod turning_gravity;
mod turning_ground;
mod uniform_gravity;

pub use flights::{Parabola, Straight};
pub use force_free::ForceFree;
pub use growing::Growing;
pub use trochoid::Trochoid;
pub use turning_gravity::TurningGravity;
pub use turning_ground::TurningGround;
pub use uniform_gravity::UniformGravity;
