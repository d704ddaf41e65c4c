//! Pictures of a frame: shaded spheres in space, disks in the plane, as SVG.
//!
//! ```
//! use grainfall::boundary::Cuboid;
//! use grainfall::output::Frame;
//! use grainfall::{Particle, Time, Vector};
//!
//! let grains = [Particle::<3>::fixed(Vector::<3>::zeros())];
//! let frame = Frame::new(&grains, Time::ZERO, &Cuboid::open());
//! let picture = grainfall::draw::svg(&frame);
//! assert!(picture.starts_with("<svg") && picture.contains("fixed"));
//! ```

mod canvas;
mod palette;
mod view;
mod visible;

use crate::draw::canvas::Canvas;
use crate::draw::palette::Palette;
use crate::draw::view::{Shape, View};
use crate::output::Frame;

/// A picture of `frame`.
///
/// Spheres are seen from the front, from a little to the right and above,
/// without perspective; disks as they lie. Colours are those of the paper's
/// Fig. 4: purple for fixed grains, dark blue for frozen ones, light blue for
/// falling ones, and shades of blue for normal ones by their kinetic energy.
/// Of falling grains only those near the heap are shown. Spheres that are
/// hidden behind others are left out, which keeps the file small.
#[must_use]
pub fn svg(frame: &Frame) -> String {
    let view = View::of(frame);
    let palette = Palette::of(frame);
    let mut shapes: Vec<Shape> = frame
        .grains
        .iter()
        .enumerate()
        .filter_map(|(id, grain)| view.shape(id, grain))
        .collect();
    // From the back to the front; of equals, in the order of their ids.
    shapes.sort_by(|a, b| a.depth.total_cmp(&b.depth).then(a.id.cmp(&b.id)));
    if frame.dimension == 3 {
        visible::keep_visible(&mut shapes, view.width(), view.height());
    }
    let mut canvas = Canvas::new(&view, frame);
    canvas.frame_lines(&view, frame);
    for shape in &shapes {
        canvas.grain(shape, palette.shade(&frame.grains[shape.id]));
    }
    canvas.legend(frame, &palette);
    canvas.finish()
}
