//! Leaves out spheres that nobody can see.

use crate::draw::view::Shape;

/// The most points of the picture that are looked at.
const MOST_POINTS: f64 = 1.0e6;
/// Points per radius of the smallest sphere, if there are enough.
const FINEST: f64 = 6.0;

/// Keeps the spheres of which some point can be seen: those that are the
/// nearest at some point of a fine grid.
pub(super) fn keep_visible(shapes: &mut Vec<Shape>, width: f64, height: f64) {
    // Coordinates at the ends of what a number can hold have no picture.
    let drawable = width > 0.0 && height > 0.0 && width * height < f64::INFINITY;
    if !drawable {
        return;
    }
    let smallest = shapes
        .iter()
        .map(|shape| shape.radius)
        .fold(f64::INFINITY, f64::min);
    let wanted = FINEST / smallest;
    let affordable = (MOST_POINTS / (width * height)).sqrt();
    // A picture as thin as a hair would else have more rows than can be counted.
    let finely = wanted.min(affordable).min(MOST_POINTS / width.max(height));
    let columns = (width * finely).ceil().max(1.0) as usize;
    let rows = (height * finely).ceil().max(1.0) as usize;
    let mut nearest: Vec<Option<(f64, usize)>> = vec![None; columns * rows];
    for (place, shape) in shapes.iter().enumerate() {
        let (x, y, radius) = (shape.x * finely, shape.y * finely, shape.radius * finely);
        let first = |centre: f64| (centre - radius).floor().max(0.0) as usize;
        let last = |centre: f64, count: usize| ((centre + radius).ceil() as usize).min(count);
        for row in first(y)..last(y, rows) {
            for column in first(x)..last(x, columns) {
                // The middle of the grid's cell, or the sphere's own middle if
                // it is smaller than a cell.
                let off = |at: usize, centre: f64| {
                    (at as f64 + 0.5 - centre).abs() - if radius < 0.71 { 0.71 } else { 0.0 }
                };
                let (dx, dy) = (off(column, x).max(0.0), off(row, y).max(0.0));
                let below = radius * radius - dx * dx - dy * dy;
                if below < 0.0 {
                    continue;
                }
                let depth = shape.depth + below.sqrt() / finely;
                let point = &mut nearest[row * columns + column];
                if point.is_none_or(|(other, _)| depth > other) {
                    *point = Some((depth, place));
                }
            }
        }
    }
    let mut seen = vec![false; shapes.len()];
    for (_, place) in nearest.into_iter().flatten() {
        seen[place] = true;
    }
    let mut seen = seen.into_iter();
    shapes.retain(|_| seen.next().unwrap_or(false));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape(id: usize, x: f64, depth: f64, radius: f64) -> Shape {
        Shape {
            id,
            x,
            y: 50.0,
            radius,
            depth,
        }
    }

    #[test]
    fn what_is_covered_goes() {
        let mut shapes = vec![
            shape(0, 50.0, 0.0, 10.0),
            shape(1, 58.0, 1.0, 10.0),
            shape(2, 50.0, 30.0, 20.0),
            shape(3, 80.0, 5.0, 10.0),
        ];
        keep_visible(&mut shapes, 100.0, 100.0);
        let ids: Vec<usize> = shapes.iter().map(|shape| shape.id).collect();
        assert_eq!(ids, [2, 3]);
    }

    #[test]
    fn a_rim_is_enough() {
        let mut shapes = vec![shape(0, 50.0, 0.0, 10.0), shape(1, 52.0, 20.0, 10.0)];
        keep_visible(&mut shapes, 100.0, 100.0);
        assert_eq!(shapes.len(), 2);
    }
}
