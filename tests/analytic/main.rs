//! Systems of one or two grains whose whole course can be written down.

#[path = "../common/mod.rs"]
mod common;

mod ball;
mod carried;
mod meetings;
mod observers;
