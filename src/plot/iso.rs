//! Lines of equal value in a field.

use contour::ContourBuilder;

use crate::plot::PlotError;

/// Lines along which a field has the value `level`, each as a list of points in
/// the plane.
///
/// The field is given by its values at the centres of `columns` × rows cells,
/// row by row from below, each row from the left; `across` and `up` are its
/// extents, from edge to edge. Between the centres it is interpolated linearly.
/// Lines end at the outermost centres and where a value is not a number; those
/// that close end where they begin.
///
/// # Errors
///
/// When the values do not fill whole rows, at least two of at least two columns.
pub fn iso_lines(
    values: &[f64],
    columns: usize,
    across: [f64; 2],
    up: [f64; 2],
    level: f64,
) -> Result<Vec<Vec<[f64; 2]>>, PlotError> {
    let rows = values.len() / columns.max(1);
    if columns < 2 || rows < 2 || rows * columns != values.len() {
        return Err(PlotError::Length {
            what: "the field",
            name: format!("lines at {level}"),
            found: values.len(),
            wanted: columns.max(2) * rows.max(2),
        });
    }
    // Cells are 1 × 1 here, the first from 0 to 1, so that its centre is at 0.5.
    let found = ContourBuilder::new(columns, rows, true)
        .lines(values, &[level])
        .map_err(|error| PlotError::Drawing(error.to_string()))?;
    let inside = |x: f64, y: f64| {
        let within = |place: f64, count: usize| place > 0.25 && place < count as f64 - 0.25;
        within(x, columns) && within(y, rows)
    };
    let mut lines = Vec::new();
    for ring in found.iter().flat_map(|line| &line.geometry().0) {
        // What is outside counts as below the level, so every line is closed
        // there: these pieces are taken out again.
        let points: Vec<Option<[f64; 2]>> = ring
            .0
            .iter()
            .map(|point| {
                inside(point.x, point.y).then(|| {
                    [
                        across[0] + (across[1] - across[0]) * point.x / columns as f64,
                        up[0] + (up[1] - up[0]) * point.y / rows as f64,
                    ]
                })
            })
            .collect();
        lines.extend(pieces(points));
    }
    Ok(lines)
}

/// The unbroken pieces of a ring whose last point is its first.
fn pieces(mut ring: Vec<Option<[f64; 2]>>) -> Vec<Vec<[f64; 2]>> {
    if let Some(gap) = ring.iter().position(Option::is_none) {
        // Begun at a gap, no piece goes over the seam.
        ring.pop();
        ring.rotate_left(gap);
    }
    ring.split(Option::is_none)
        .map(|piece| piece.iter().copied().flatten().collect::<Vec<_>>())
        .filter(|piece| piece.len() > 1)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A field of 20 × 10 cells over 4 × 2.
    fn field(of: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        let mut values = Vec::new();
        for row in 0..10 {
            for column in 0..20 {
                let at = |cell: i32| 0.2 * (f64::from(cell) + 0.5);
                values.push(of(at(column), at(row)));
            }
        }
        values
    }

    const EXTENT: ([f64; 2], [f64; 2]) = ([0.0, 4.0], [0.0, 2.0]);

    #[test]
    fn a_plane_has_one_straight_line_from_edge_to_edge() {
        let values = field(|x, y| y + 0.25 * x);
        let lines = iso_lines(&values, 20, EXTENT.0, EXTENT.1, 1.27).unwrap();
        assert_eq!(lines.len(), 1);
        for [x, y] in &lines[0] {
            assert!((y + 0.25 * x - 1.27).abs() < 1.0e-12);
        }
        let mut ends = [lines[0][0][0], lines[0][lines[0].len() - 1][0]];
        ends.sort_by(f64::total_cmp);
        assert!((ends[0] - 0.1).abs() < 1.0e-12 && (ends[1] - 3.9).abs() < 1.0e-12);
    }

    #[test]
    fn a_hill_has_a_closed_line() {
        let values = field(|x, y| -(x - 2.0) * (x - 2.0) - (y - 1.0) * (y - 1.0));
        let lines = iso_lines(&values, 20, EXTENT.0, EXTENT.1, -0.49).unwrap();
        assert_eq!(lines.len(), 1);
        assert_eq!(lines[0].first(), lines[0].last());
        for [x, y] in &lines[0] {
            // Linear interpolation of a parabola between centres 0.2 apart.
            let off = (x - 2.0) * (x - 2.0) + (y - 1.0) * (y - 1.0) - 0.49;
            assert!(off.abs() <= 0.25 * 0.04 + 1.0e-12, "{off}");
        }
    }

    #[test]
    fn lines_end_where_nothing_is_known() {
        let values = field(|x, y| if x < 2.0 { f64::NAN } else { y });
        let lines = iso_lines(&values, 20, EXTENT.0, EXTENT.1, 1.0).unwrap();
        assert_eq!(lines.len(), 1);
        assert!(lines[0].iter().all(|point| point[0] > 2.0));
        assert!(
            iso_lines(&values, 20, EXTENT.0, EXTENT.1, 9.0)
                .unwrap()
                .is_empty()
        );
    }

    #[test]
    fn fields_that_are_no_rectangles_are_refused() {
        assert!(iso_lines(&[1.0; 7], 3, EXTENT.0, EXTENT.1, 0.5).is_err());
        assert!(iso_lines(&[1.0; 3], 3, EXTENT.0, EXTENT.1, 0.5).is_err());
        assert!(iso_lines(&[], 0, EXTENT.0, EXTENT.1, 0.5).is_err());
    }
}
