//! What is measured on grains at rest: exact volumes in slabs, packing
//! fractions, the extent of a heap.
//!
//! The last axis is "up".

mod ball;
mod packing;

pub use ball::{ball_slab_volume, ball_volume};
pub use packing::{SlabFraction, highest_surface, lowest_surface, packing_fraction, slab_fraction};
