//! Intervals of equal length.

use crate::analysis::AnalysisError;

/// The greatest number of bins along one axis.
const MOST_BINS: usize = 1_000_000;

/// `count` bins of equal width between two values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bins {
    from: f64,
    to: f64,
    count: usize,
}

impl Bins {
    /// Bins between `from` and `to`.
    ///
    /// # Errors
    ///
    /// Unless both ends are finite, the first smaller, and there are 1 to a
    /// million bins.
    pub fn new(from: f64, to: f64, count: usize) -> Result<Self, AnalysisError> {
        let refuse = |field, value, allowed| {
            Err(AnalysisError::Parameter {
                field,
                value,
                allowed,
            })
        };
        if !from.is_finite() {
            return refuse(
                "the first edge of the bins",
                from,
                "a finite number is allowed",
            );
        }
        if !(to - from > 0.0 && to.is_finite()) {
            let allowed = "a finite number greater than the first edge is allowed";
            return refuse("the last edge of the bins", to, allowed);
        }
        if !(1..=MOST_BINS).contains(&count) {
            let allowed = "a whole number from 1 to a million is allowed";
            return refuse("the number of bins", count as f64, allowed);
        }
        Ok(Bins { from, to, count })
    }

    /// Bins of about this width that fill the length from `from` to `to`.
    ///
    /// # Errors
    ///
    /// As [`Bins::new`]; and when the width is not above 0.
    pub fn of_width(from: f64, to: f64, width: f64) -> Result<Self, AnalysisError> {
        let count = (to - from) / width;
        if !(width > 0.0 && count.is_finite()) {
            return Err(AnalysisError::Parameter {
                field: "the width of the bins",
                value: width,
                allowed: "a finite number greater than 0 is allowed",
            });
        }
        Bins::new(from, to, (count.round() as usize).max(1))
    }

    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.count
    }

    /// The first edge.
    #[must_use]
    pub fn from(&self) -> f64 {
        self.from
    }

    /// The last edge.
    #[must_use]
    pub fn to(&self) -> f64 {
        self.to
    }

    /// The width of each.
    #[must_use]
    pub fn width(&self) -> f64 {
        (self.to - self.from) / self.count as f64
    }

    /// Edge `number`, from 0 to the number of bins.
    #[must_use]
    pub fn edge(&self, number: usize) -> f64 {
        let share = number as f64 / self.count as f64;
        // Exact at both ends.
        self.from * (1.0 - share) + self.to * share
    }

    /// All edges, one more than there are bins.
    #[must_use]
    pub fn edges(&self) -> Vec<f64> {
        (0..=self.count).map(|number| self.edge(number)).collect()
    }

    /// The middle of bin `number`.
    #[must_use]
    pub fn centre(&self, number: usize) -> f64 {
        0.5 * (self.edge(number) + self.edge(number + 1))
    }

    /// All middles.
    #[must_use]
    pub fn centres(&self) -> Vec<f64> {
        (0..self.count).map(|number| self.centre(number)).collect()
    }

    /// The bin that a value lies in; `None` outside. The first edge belongs to
    /// the first bin, the last to none.
    #[must_use]
    pub fn bin_of(&self, value: f64) -> Option<usize> {
        if !(value >= self.from && value < self.to) {
            return None;
        }
        let guess = ((value - self.from) / self.width()) as usize;
        let mut bin = guess.min(self.count - 1);
        // Rounding may have put it one too far.
        if value < self.edge(bin) {
            bin -= 1;
        } else if bin + 1 < self.count && value >= self.edge(bin + 1) {
            bin += 1;
        }
        Some(bin)
    }

    /// The bins that an interval touches.
    pub(super) fn touched(&self, low: f64, high: f64) -> std::ops::Range<usize> {
        if !(low < self.to && high > self.from && low <= high) {
            return 0..0;
        }
        let first = self.bin_of(low).unwrap_or(0);
        let last = self.bin_of(high).unwrap_or(self.count - 1);
        first..last + 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn what_makes_no_bins_is_refused() {
        for (from, to, count) in [
            (0.0, 0.0, 3),
            (1.0, 0.0, 3),
            (f64::NAN, 1.0, 3),
            (0.0, f64::INFINITY, 3),
            (0.0, 1.0, 0),
            (0.0, 1.0, MOST_BINS + 1),
        ] {
            assert!(Bins::new(from, to, count).is_err(), "{from} {to} {count}");
        }
        assert!(Bins::of_width(0.0, 1.0, 0.0).is_err());
        assert_eq!(Bins::of_width(0.0, 1.0, 0.26).unwrap().count(), 4);
    }

    proptest! {
        #[test]
        fn every_value_is_between_the_edges_of_its_bin(
            from in -1e3..1e3f64, length in 1e-6..1e3f64, count in 1usize..500, share in 0.0..1.0f64,
        ) {
            let bins = Bins::new(from, from + length, count).unwrap();
            let edges = bins.edges();
            prop_assert_eq!((edges[0], edges[count]), (from, from + length));
            for value in [from + share * length, edges[(share * count as f64) as usize]] {
                match bins.bin_of(value) {
                    Some(bin) => prop_assert!(edges[bin] <= value && value < edges[bin + 1]),
                    None => prop_assert!(value >= from + length),
                }
            }
        }
    }
}
