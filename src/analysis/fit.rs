//! Straight lines through points.

/// A straight line y = intercept + slope x, fitted by least squares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineFit {
    /// Its value at x = 0.
    pub intercept: f64,
    /// Its slope.
    pub slope: f64,
    /// Standard error of the intercept.
    pub intercept_error: f64,
    /// Standard error of the slope.
    pub slope_error: f64,
    /// Sum of the squares of the residuals, each over its error if errors are
    /// given: χ².
    pub residual: f64,
    /// How many points it goes through.
    pub points: usize,
}

impl LineFit {
    /// Its value at x.
    #[must_use]
    pub fn at(&self, x: f64) -> f64 {
        self.intercept + self.slope * x
    }

    /// Its angle to the x axis in degrees, and the standard error of that, where
    /// both axes have the same unit.
    #[must_use]
    pub fn angle(&self) -> (f64, f64) {
        let error = self.slope_error / (1.0 + self.slope * self.slope);
        (libm::atan(self.slope).to_degrees(), error.to_degrees())
    }
}

/// The straight line through points (x, y); `None` unless there are two with
/// different x. Points that are not finite are passed over.
///
/// With `errors`, one for each point and above 0, points weigh 1/error² and the
/// errors of the line follow from them alone. Without, all weigh the same, and
/// the errors of the line follow from the scatter about it (not a number for two
/// points).
#[must_use]
pub fn line_fit(points: &[[f64; 2]], errors: Option<&[f64]>) -> Option<LineFit> {
    let weighted: Vec<([f64; 2], f64)> = points
        .iter()
        .enumerate()
        .map(|(number, point)| {
            let error = errors.map_or(1.0, |errors| {
                errors.get(number).copied().unwrap_or(f64::NAN)
            });
            (*point, 1.0 / (error * error))
        })
        .filter(|([x, y], weight)| x.is_finite() && y.is_finite() && weight.is_finite())
        .collect();
    let total: f64 = weighted.iter().map(|(_, weight)| weight).sum();
    let mean = |axis: usize| {
        let sum: f64 = weighted
            .iter()
            .map(|(point, weight)| weight * point[axis])
            .sum();
        sum / total
    };
    let (x, y) = (mean(0), mean(1));
    let (mut spread, mut common) = (0.0, 0.0);
    for (point, weight) in &weighted {
        spread += weight * (point[0] - x) * (point[0] - x);
        common += weight * (point[0] - x) * (point[1] - y);
    }
    if !(spread > 0.0 && spread.is_finite()) {
        return None;
    }
    let slope = common / spread;
    let intercept = y - slope * x;
    let residual: f64 = weighted
        .iter()
        .map(|(point, weight)| {
            let off = point[1] - intercept - slope * point[0];
            weight * off * off
        })
        .sum();
    let variance = match (errors, weighted.len()) {
        (Some(_), _) => 1.0,
        (None, count) if count > 2 => residual / (count as f64 - 2.0),
        (None, _) => f64::NAN,
    };
    Some(LineFit {
        intercept,
        slope,
        intercept_error: (variance * (1.0 / total + x * x / spread)).sqrt(),
        slope_error: (variance / spread).sqrt(),
        residual,
        points: weighted.len(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_on_a_line_give_it_back() {
        let points: Vec<[f64; 2]> = (0..9).map(f64::from).map(|x| [x, 2.0 - 0.5 * x]).collect();
        let fit = line_fit(&points, None).unwrap();
        assert!((fit.slope + 0.5).abs() < 1.0e-15 && (fit.intercept - 2.0).abs() < 1.0e-14);
        assert!(fit.slope_error < 1.0e-14 && fit.residual < 1.0e-28);
        assert!((fit.angle().0 + 26.565_051_177).abs() < 1.0e-8);
        assert!((fit.at(4.0)).abs() < 1.0e-14);
    }

    #[test]
    fn errors_are_those_of_the_textbook() {
        // x = −1, 0, 1 and errors 0.1: slope ± 0.1/√2, intercept ± 0.1/√3.
        let fit = line_fit(&[[-1.0, 0.0], [0.0, 1.0], [1.0, 0.0]], Some(&[0.1; 3])).unwrap();
        assert!((fit.slope_error - 0.1 / 2.0_f64.sqrt()).abs() < 1.0e-15);
        assert!((fit.intercept_error - 0.1 / 3.0_f64.sqrt()).abs() < 1.0e-15);
        assert!((fit.intercept - 1.0 / 3.0).abs() < 1.0e-15 && fit.slope == 0.0);
        assert!((fit.residual - 200.0 / 3.0).abs() < 1.0e-11);
        // From the scatter: residuals −1/3, 2/3, −1/3, one degree of freedom.
        let plain = line_fit(&[[-1.0, 0.0], [0.0, 1.0], [1.0, 0.0]], None).unwrap();
        assert!((plain.slope_error - (1.0 / 3.0_f64).sqrt()).abs() < 1.0e-15);
    }

    #[test]
    fn what_has_no_line_has_none() {
        assert_eq!(line_fit(&[], None), None);
        assert_eq!(line_fit(&[[1.0, 2.0]], None), None);
        assert_eq!(
            line_fit(&[[1.0, 2.0], [1.0, 3.0], [f64::NAN, 0.0]], None),
            None
        );
        assert!(
            line_fit(&[[1.0, 2.0], [2.0, 3.0]], None)
                .unwrap()
                .slope_error
                .is_nan()
        );
        assert_eq!(line_fit(&[[1.0, 2.0], [2.0, 3.0]], Some(&[1.0])), None);
    }
}
