//! Means with their errors, and how numbers are shown.

/// A mean and its standard error.
#[derive(Clone, Copy, Debug)]
pub(super) struct Estimate {
    pub(super) mean: f64,
    pub(super) error: f64,
}

impl Estimate {
    /// Of independent samples. A single one has no known error.
    pub(super) fn of(samples: &[f64]) -> Self {
        let count = samples.len() as f64;
        let mean = samples.iter().sum::<f64>() / count;
        let square = samples.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
        Estimate {
            mean,
            error: (square / (count * (count - 1.0))).sqrt(),
        }
    }

    /// Known to rounding.
    pub(super) fn exact(mean: f64) -> Self {
        Estimate { mean, error: 0.0 }
    }

    /// The same in another unit.
    pub(super) fn times(self, factor: f64) -> Self {
        Estimate {
            mean: self.mean * factor,
            error: self.error * factor,
        }
    }

    /// With two digits of the error, if it has one.
    pub(super) fn with_error(self) -> Option<String> {
        if !(self.error > 0.0 && self.error.is_finite()) {
            return None;
        }
        let places = (1.0 - libm::floor(libm::log10(self.error))).clamp(0.0, 12.0) as usize;
        Some(format!("{:.places$} ± {:.places$}", self.mean, self.error))
    }
}

/// Six digits.
pub(super) fn significant(value: f64) -> String {
    let places = if value == 0.0 {
        0.0
    } else {
        5.0 - libm::floor(libm::log10(value.abs()))
    };
    format!("{value:.*}", places.clamp(0.0, 12.0) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_that_mean_something() {
        let shown = |mean, error| Estimate { mean, error }.with_error();
        assert_eq!(shown(3.98512, 0.00123).as_deref(), Some("3.9851 ± 0.0012"));
        assert_eq!(shown(1234.5, 12.0).as_deref(), Some("1234 ± 12"));
        assert_eq!(shown(1234.5, 0.0), None);
        assert_eq!(shown(1234.5, f64::NAN), None);
        assert_eq!(significant(3.983983), "3.98398");
    }

    #[test]
    fn the_error_is_that_of_the_mean() {
        let estimate = Estimate::of(&[1.0, 2.0, 3.0, 6.0]);
        assert_eq!(estimate.mean, 3.0);
        // The variance is (4 + 1 + 0 + 9)/3, a fourth of it that of the mean.
        assert!((estimate.error - (14.0_f64 / 12.0).sqrt()).abs() < 1.0e-15);
        assert!(Estimate::of(&[1.0]).error.is_nan());
    }
}
