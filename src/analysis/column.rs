//! What rectangles cut out of disks, and rectangular columns out of balls.

use std::f64::consts::FRAC_PI_4;

/// Volume that an endless column along the third axis cuts out of a sphere, in
/// d³; in two dimensions the area that a rectangle cuts out of a disk, in d².
/// Exact but for rounding, of some 10⁻¹⁶ of the cube (square) of the radius.
///
/// `centre`, `low` and `high` are of the two axes across the column; the third
/// may be any axis. A column with `high ≤ low` along either is empty. Other
/// dimensions than 2 and 3 do not compile.
#[must_use]
pub fn ball_column_volume<const D: usize>(
    radius: f64,
    centre: [f64; 2],
    low: [f64; 2],
    high: [f64; 2],
) -> f64 {
    const { assert!(D == 2 || D == 3, "columns are known in 2 and 3 dimensions") };
    if !(radius > 0.0 && low[0] < high[0] && low[1] < high[1]) {
        return 0.0;
    }
    // In radii from the centre. Beyond ±1 there is nothing more.
    let place = |value: f64, axis: usize| ((value - centre[axis]) / radius).clamp(-1.0, 1.0);
    let (left, right) = (place(low[0], 0), place(high[0], 0));
    let (below, above) = (place(low[1], 1), place(high[1], 1));
    if left >= right || below >= above {
        return 0.0;
    }
    let corner = if D == 2 {
        area_to_corner
    } else {
        volume_to_corner
    };
    let part =
        corner(right, above) - corner(left, above) - corner(right, below) + corner(left, below);
    let unit = if D == 2 {
        radius * radius
    } else {
        radius * radius * radius
    };
    part.max(0.0) * unit
}

/// Area of the unit disk between the axes and (x, y), signed: ∫∫ du dv.
fn area_to_corner(x: f64, y: f64) -> f64 {
    let sign = x.signum() * y.signum();
    let (x, y) = (x.abs(), y.abs());
    let area = if x * x + y * y <= 1.0 {
        x * y
    } else {
        // The corner is outside: a quarter of the disk, without what is beyond
        // x and what is beyond y, which do not meet.
        FRAC_PI_4 - beyond(x) - beyond(y)
    };
    sign * area
}

/// Area of the quarter disk beyond x: ∫ √(1 − u²) du from x to 1.
fn beyond(x: f64) -> f64 {
    0.5 * (libm::acos(x) - x * ((1.0 - x) * (1.0 + x)).sqrt())
}

/// Volume of the unit ball over the rectangle between the axes and (x, y),
/// signed: ∫∫ 2 √(1 − u² − v²) du dv.
///
/// With s = √(1 − x² − y²) it is (2/3) x y s + (x/3)(3 − x²) atan(y/s) +
/// (y/3)(3 − y²) atan(x/s) − (2/3) atan(x y/s): its mixed derivative is 2 s and
/// it vanishes on both axes. Where the corner is outside of the disk, s is 0,
/// which gives the ball without what is beyond x and what is beyond y.
fn volume_to_corner(x: f64, y: f64) -> f64 {
    let sign = x.signum() * y.signum();
    let (x, y) = (x.abs(), y.abs());
    if x == 0.0 || y == 0.0 {
        return 0.0;
    }
    let s = (1.0 - x * x - y * y).max(0.0).sqrt();
    let thirds = 2.0 * x * y * s
        + x * (3.0 - x * x) * libm::atan2(y, s)
        + y * (3.0 - y * y) * libm::atan2(x, s)
        - 2.0 * libm::atan2(x * y, s);
    sign * thirds / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::quadrature::simpson;
    use crate::analysis::{ball_slab_volume, ball_volume};
    use proptest::prelude::*;
    use std::f64::consts::PI;

    const FAR: f64 = 1.0e3;

    #[test]
    fn quarters_and_corners() {
        // A column over one quadrant cuts out a quarter.
        let quarter = ball_column_volume::<3>(0.5, [1.0, 2.0], [1.0, 2.0], [FAR, FAR]);
        assert!((quarter - PI / 24.0).abs() < 1.0e-16);
        let quarter = ball_column_volume::<2>(0.5, [1.0, 2.0], [-FAR, -FAR], [1.0, 2.0]);
        assert!((quarter - PI / 16.0).abs() < 1.0e-16);
        // The square inscribed in a disk of radius 1, and beside it nothing.
        let half = 0.5_f64.sqrt();
        let square = ball_column_volume::<2>(1.0, [0.0; 2], [-half; 2], [half; 2]);
        assert!((square - 2.0).abs() < 1.0e-15);
        let corner = ball_column_volume::<3>(1.0, [0.0; 2], [half; 2], [FAR; 2]);
        assert!(corner < 1.0e-15);
        assert_eq!(
            ball_column_volume::<3>(1.0, [0.0; 2], [0.1, 0.2], [0.1, 0.9]),
            0.0
        );
        assert_eq!(
            ball_column_volume::<3>(1.0, [0.0; 2], [1.0, -1.0], [2.0, 1.0]),
            0.0
        );
    }

    #[test]
    fn a_thin_column_through_the_centre_is_a_prism() {
        // Its length is the diameter, but for the fourth order of its width.
        let h = 1.0e-4;
        let thin = ball_column_volume::<3>(1.0, [0.0; 2], [-h; 2], [h; 2]);
        assert!((thin / (8.0 * h * h) - 1.0).abs() < 1.0e-7, "{thin:e}");
    }

    /// The same by the chord of the disk, or the segment of the circular section,
    /// at each x: Simpson's rule in the angle.
    fn by_quadrature<const D: usize>(radius: f64, low: [f64; 2], high: [f64; 2]) -> f64 {
        let angle = |x: f64| (x / radius).clamp(-1.0, 1.0).asin();
        let (from, to) = (angle(low[0]), angle(high[0]));
        let section = |x: f64| {
            let half = (radius * radius - x * x).max(0.0).sqrt();
            match D {
                2 => (high[1].min(half) - low[1].max(-half)).max(0.0),
                _ => ball_slab_volume::<2>(half, 0.0, low[1], high[1]),
            }
        };
        // Where y enters or leaves the circle the section has a kink: split there.
        let mut cuts = vec![from, to];
        for y in [low[1], high[1]] {
            if y.abs() < radius {
                let x = (radius * radius - y * y).sqrt();
                cuts.extend([-angle(x), angle(x)]);
            }
        }
        cuts.retain(|cut| (from..=to).contains(cut));
        cuts.sort_by(f64::total_cmp);
        let mut sum = 0.0;
        for piece in cuts.windows(2) {
            // Substituted so that square roots at the ends become smooth.
            let at = |u: f64| piece[0] + (piece[1] - piece[0]) * u * u * (3.0 - 2.0 * u);
            let slope = |u: f64| (piece[1] - piece[0]) * 6.0 * u * (1.0 - u);
            sum += simpson(400, |u| {
                section(radius * at(u).sin()) * radius * at(u).cos() * slope(u)
            });
        }
        sum
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn agrees_with_quadrature(
            radius in 0.2..2.0f64,
            a in -3.0..3.0f64, b in -3.0..3.0f64, width in 0.0..3.0f64, height in 0.0..3.0f64,
        ) {
            let (low, high) = ([a, b], [a + width, b + height]);
            let exact = ball_column_volume::<3>(radius, [0.0; 2], low, high);
            let other = by_quadrature::<3>(radius, low, high);
            prop_assert!((exact - other).abs() < 1.0e-8, "{exact} {other}");
            let exact = ball_column_volume::<2>(radius, [0.0; 2], low, high);
            let other = by_quadrature::<2>(radius, low, high);
            prop_assert!((exact - other).abs() < 1.0e-8, "{exact} {other}");
        }

        #[test]
        fn parts_add_up_to_the_whole_and_to_slabs(
            radius in 0.1..2.0f64, x in -1.0..1.0f64, y in -1.0..1.0f64,
            mut across in proptest::collection::vec(-4.0..4.0f64, 1..6),
            mut up in proptest::collection::vec(-4.0..4.0f64, 1..6),
        ) {
            for cuts in [&mut across, &mut up] {
                cuts.extend([-FAR, FAR]);
                cuts.sort_by(f64::total_cmp);
            }
            fn check<const D: usize>(
                radius: f64, centre: [f64; 2], across: &[f64], up: &[f64],
            ) -> Result<(), TestCaseError> {
                let whole = ball_volume::<D>(radius);
                let mut total = 0.0;
                for columns in across.windows(2) {
                    let mut slab = 0.0;
                    for rows in up.windows(2) {
                        slab += ball_column_volume::<D>(
                            radius, centre, [columns[0], rows[0]], [columns[1], rows[1]],
                        );
                    }
                    let known = ball_slab_volume::<D>(radius, centre[0], columns[0], columns[1]);
                    prop_assert!((slab - known).abs() < 1.0e-13 * whole.max(1.0));
                    total += slab;
                }
                prop_assert!((total - whole).abs() < 1.0e-13 * whole.max(1.0));
                Ok(())
            }
            check::<2>(radius, [x, y], &across, &up)?;
            check::<3>(radius, [x, y], &across, &up)?;
        }
    }
}
