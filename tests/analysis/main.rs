//! What is measured on grains, where the answer is known.

mod crystals;
mod density;
mod motion;
#[cfg(feature = "program")]
mod program;
mod transfer;

use grainfall::analysis::Container;
use grainfall::{Particle, Vector};

/// Touching spheres on a face-centred cubic lattice of `cells`³ cells, and the
/// cube they fill.
fn fcc(cells: usize, periodic: bool) -> (Vec<Particle<3>>, Container<3>) {
    let edge = std::f64::consts::SQRT_2;
    let mut grains = Vec::new();
    for cell in 0..cells * cells * cells {
        let corner = [cell % cells, cell / cells % cells, cell / cells / cells];
        for offset in [
            [0.0, 0.0, 0.0],
            [0.5, 0.5, 0.0],
            [0.5, 0.0, 0.5],
            [0.0, 0.5, 0.5],
        ] {
            let place = Vector::<3>::from_fn(|axis, _| (corner[axis] as f64 + offset[axis]) * edge);
            grains.push(Particle::frozen(place));
        }
    }
    let lengths = Vector::repeat(cells as f64 * edge);
    let container = Container::new(Vector::zeros(), lengths, [periodic; 3]).unwrap();
    (grains, container)
}

fn near(found: f64, known: f64, allowed: f64) {
    assert!((found - known).abs() <= allowed, "{found} is not {known}");
}
