//! What is measured on grains at rest: exact volumes in slabs, packing
//! fractions, the extent of a heap. And what theory knows of grains that move:
//! equations of state, kinetic theory.
//!
//! The last axis is "up".

mod ball;
mod equation_of_state;
pub mod kinetic_theory;
mod packing;

pub use ball::{ball_slab_volume, ball_volume};
pub use equation_of_state::{
    carnahan_starling, contact_value, henderson, kolafa_labik_malijevsky, periodic_correction,
    virial_disks, virial_spheres,
};
pub use packing::{SlabFraction, highest_surface, lowest_surface, packing_fraction, slab_fraction};
