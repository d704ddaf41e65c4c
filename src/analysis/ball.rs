//! Volumes of balls and of what slabs cut out of them, in any dimension.

use std::f64::consts::{FRAC_PI_2, PI};

/// Volume of a ball of this radius, in d^D: a length for D = 1, an area for
/// D = 2.
#[must_use]
pub fn ball_volume<const D: usize>(radius: f64) -> f64 {
    // V(n) = V(n − 2) 2π r²/n from V(0) = 1 and V(1) = 2 r.
    let (mut dimension, mut volume) = if D.is_multiple_of(2) {
        (0, 1.0)
    } else {
        (1, 2.0 * radius)
    };
    while dimension < D {
        dimension += 2;
        volume *= 2.0 * PI * radius * radius / dimension as f64;
    }
    volume
}

/// Volume that the slab between heights `low` and `high` cuts out of a ball
/// centred at height `centre`, in d^D; exact but for rounding.
///
/// In two dimensions that is the area a strip cuts out of a disk. A slab with
/// `high ≤ low` is empty.
#[must_use]
pub fn ball_slab_volume<const D: usize>(radius: f64, centre: f64, low: f64, high: f64) -> f64 {
    if !(radius > 0.0 && low < high) {
        return 0.0;
    }
    let below = |height: f64| share_below::<D>((height - centre) / radius);
    ball_volume::<D>(radius) * (below(high) - below(low)).max(0.0)
}

/// The share of a unit ball that lies below the height `u`.
///
/// A cross-section at height s is a ball of radius √(1 − s²), so the share is
/// J(u)/J(1) with J(u) = ∫ (1 − s²)^((D−1)/2) ds from −1 to u. By parts
/// (k + 1) J_k = u (1 − u²)^(k/2) + k J_(k−2).
fn share_below<const D: usize>(u: f64) -> f64 {
    if u <= -1.0 {
        return 0.0;
    }
    if u >= 1.0 {
        return 1.0;
    }
    let square = (1.0 - u) * (1.0 + u);
    let root = square.sqrt();
    // (k, J_k(u), J_k(1), (1 − u²)^(k/2)); the ball is cut at k = D − 1.
    let (mut k, mut part, mut whole, mut power) = if D % 2 == 1 {
        (0, 1.0 + u, 2.0, 1.0)
    } else {
        let part = 0.5 * (FRAC_PI_2 + libm::asin(u) + u * root);
        (1, part, FRAC_PI_2, root)
    };
    while k + 1 < D {
        k += 2;
        power *= square;
        let order = k as f64;
        part = (u * power + order * part) / (order + 1.0);
        whole = order * whole / (order + 1.0);
    }
    part / whole
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::quadrature::simpson;
    use proptest::prelude::*;

    #[test]
    fn balls_have_their_volumes() {
        let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-15, "{a} {b}");
        close(ball_volume::<1>(0.5), 1.0);
        close(ball_volume::<2>(0.5), PI / 4.0);
        close(ball_volume::<3>(0.5), PI / 6.0);
        close(ball_volume::<4>(2.0), 8.0 * PI * PI);
        close(ball_volume::<5>(1.0), 8.0 * PI * PI / 15.0);
    }

    #[test]
    fn half_a_ball_is_half_a_ball() {
        fn check<const D: usize>() {
            let half = ball_slab_volume::<D>(0.7, 3.0, 3.0, 10.0);
            assert!(
                (half / ball_volume::<D>(0.7) - 0.5).abs() < 1e-15,
                "D = {D}"
            );
        }
        check::<1>();
        check::<2>();
        check::<3>();
        check::<4>();
        check::<5>();
    }

    #[test]
    fn caps_are_those_of_the_textbook() {
        // Height h of the cap of a unit ball: π h² (3 − h)/3; of a unit disk:
        // acos(1 − h) − (1 − h) √(2h − h²).
        for h in [0.01, 0.3, 0.5, 1.0, 1.7, 1.99f64] {
            let cap = ball_slab_volume::<3>(1.0, 0.0, -5.0, h - 1.0);
            assert!((cap - PI * h * h * (3.0 - h) / 3.0).abs() < 1e-14);
            let segment = ball_slab_volume::<2>(1.0, 0.0, -5.0, h - 1.0);
            let known = (1.0 - h).acos() - (1.0 - h) * (2.0 * h - h * h).sqrt();
            assert!((segment - known).abs() < 1e-14);
        }
    }

    #[test]
    fn slabs_that_miss_cut_nothing() {
        assert_eq!(ball_slab_volume::<3>(0.5, 0.0, 0.5, 1.0), 0.0);
        assert_eq!(ball_slab_volume::<3>(0.5, 0.0, -2.0, -0.6), 0.0);
        assert_eq!(ball_slab_volume::<2>(0.5, 0.0, 0.2, 0.1), 0.0);
        assert_eq!(ball_slab_volume::<2>(0.0, 0.0, -1.0, 1.0), 0.0);
        let whole = ball_slab_volume::<3>(0.5, 0.0, f64::NEG_INFINITY, f64::INFINITY);
        assert_eq!(whole, ball_volume::<3>(0.5));
    }

    /// ∫ of the cross-section by Simpson's rule in the angle, where it is smooth.
    fn by_quadrature<const D: usize>(radius: f64, centre: f64, low: f64, high: f64) -> f64 {
        let angle = |height: f64| ((height - centre) / radius).clamp(-1.0, 1.0).asin();
        let (from, to) = (angle(low), angle(high));
        // Volume of the (D − 1)-ball of unit radius.
        let unit = [1.0, 2.0, PI, 4.0 * PI / 3.0][D - 1];
        let section = |angle: f64| {
            let cos = angle.cos();
            unit * (radius * cos).powi(D as i32 - 1) * radius * cos
        };
        (to - from) * simpson(400, |u| section(from + (to - from) * u))
    }

    proptest! {
        #[test]
        fn agrees_with_quadrature(
            radius in 0.1..3.0f64, centre in -5.0..5.0f64,
            low in -9.0..9.0f64, thickness in 0.0..9.0f64,
        ) {
            let high = low + thickness;
            let near = |a: f64, b: f64| (a - b).abs() < 1e-9 * radius.powi(4).max(1.0);
            prop_assert!(near(
                ball_slab_volume::<1>(radius, centre, low, high),
                by_quadrature::<1>(radius, centre, low, high)
            ));
            prop_assert!(near(
                ball_slab_volume::<2>(radius, centre, low, high),
                by_quadrature::<2>(radius, centre, low, high)
            ));
            prop_assert!(near(
                ball_slab_volume::<3>(radius, centre, low, high),
                by_quadrature::<3>(radius, centre, low, high)
            ));
            prop_assert!(near(
                ball_slab_volume::<4>(radius, centre, low, high),
                by_quadrature::<4>(radius, centre, low, high)
            ));
        }

        #[test]
        fn slabs_add_up(
            radius in 0.1..3.0f64, centre in -1.0..1.0f64,
            mut cuts in proptest::collection::vec(-4.0..4.0f64, 2..8),
        ) {
            cuts.sort_by(f64::total_cmp);
            let parts: f64 = cuts
                .windows(2)
                .map(|pair| ball_slab_volume::<3>(radius, centre, pair[0], pair[1]))
                .sum();
            let whole = ball_slab_volume::<3>(radius, centre, cuts[0], cuts[cuts.len() - 1]);
            prop_assert!((parts - whole).abs() < 1e-13 * ball_volume::<3>(radius));
        }
    }
}
