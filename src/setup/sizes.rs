//! Distributions of diameters.

use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

use crate::error::SetupError;
use crate::setup::random::{normal, uniform};
use crate::setup::require;

/// How many spreads a log-normal diameter may lie from its median, in ln σ.
const LOG_NORMAL_CUT: f64 = 3.0;

/// How the diameters of grains are distributed.
///
/// Fractions count grains, not volume.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "program", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Sizes {
    /// All the same.
    Equal {
        /// The diameter, in d.
        #[cfg_attr(feature = "program", schemars(range(min = 1.0e-6, max = 1.0e6), extend("x-unit" = "d")))]
        diameter: f64,
    },
    /// Two sizes.
    Bimodal {
        /// The smaller diameter, in d.
        #[cfg_attr(feature = "program", schemars(range(min = 1.0e-6, max = 1.0e6), extend("x-unit" = "d")))]
        small: f64,
        /// The larger diameter, in d.
        #[cfg_attr(feature = "program", schemars(range(min = 1.0e-6, max = 1.0e6), extend("x-unit" = "d")))]
        large: f64,
        /// The probability that a grain is large, in 0 … 1.
        #[cfg_attr(feature = "program", schemars(range(min = 0.0, max = 1.0)))]
        large_fraction: f64,
    },
    /// Every diameter of an interval is equally probable.
    Uniform {
        /// The smallest diameter, in d.
        #[cfg_attr(feature = "program", schemars(range(min = 1.0e-6, max = 1.0e6), extend("x-unit" = "d")))]
        least: f64,
        /// The largest diameter, in d.
        #[cfg_attr(feature = "program", schemars(range(min = 1.0e-6, max = 1.0e6), extend("x-unit" = "d")))]
        most: f64,
    },
    /// The logarithm of the diameter is normally distributed, cut off at three
    /// spreads on either side.
    LogNormal {
        /// The median diameter, in d.
        #[cfg_attr(feature = "program", schemars(range(min = 1.0e-6, max = 1.0e6), extend("x-unit" = "d")))]
        median: f64,
        /// The standard deviation of ln σ before the cut.
        #[cfg_attr(feature = "program", schemars(range(min = 0.0, max = 2.0)))]
        spread: f64,
    },
}

impl Default for Sizes {
    /// All have the diameter 1 d.
    fn default() -> Self {
        Sizes::Equal { diameter: 1.0 }
    }
}

impl Sizes {
    /// One diameter, in d.
    #[must_use]
    pub fn sample(&self, rng: &mut ChaCha8Rng) -> f64 {
        match *self {
            Sizes::Equal { diameter } => diameter,
            Sizes::Bimodal {
                small,
                large,
                large_fraction,
            } => {
                if uniform(rng) < large_fraction {
                    large
                } else {
                    small
                }
            }
            Sizes::Uniform { least, most } => least + (most - least) * uniform(rng),
            Sizes::LogNormal { median, spread } => loop {
                let z = normal(rng);
                if z.abs() <= LOG_NORMAL_CUT {
                    return median * libm::exp(spread * z);
                }
            },
        }
    }

    /// The largest diameter that can occur, in d.
    #[must_use]
    pub fn largest(&self) -> f64 {
        match *self {
            Sizes::Equal { diameter } => diameter,
            Sizes::Bimodal { large, .. } => large,
            Sizes::Uniform { most, .. } => most,
            Sizes::LogNormal { median, spread } => median * libm::exp(spread * LOG_NORMAL_CUT),
        }
    }

    /// The smallest diameter that can occur, in d.
    #[must_use]
    pub fn smallest(&self) -> f64 {
        match *self {
            Sizes::Equal { diameter } => diameter,
            Sizes::Bimodal { small, .. } => small,
            Sizes::Uniform { least, .. } => least,
            Sizes::LogNormal { median, spread } => median * libm::exp(-spread * LOG_NORMAL_CUT),
        }
    }

    /// The same distribution, if its numbers make one.
    ///
    /// # Errors
    ///
    /// When a diameter is not positive and finite, two are out of order, a
    /// fraction is outside 0 … 1, or a spread is outside 0 … 2 (at 2 the
    /// largest grain is already 160 000 times the smallest).
    pub fn validated(self) -> Result<Self, SetupError> {
        let diameter = |field, value: f64| {
            require(
                value.is_finite() && value > 0.0,
                field,
                value,
                "a positive diameter is allowed",
            )
        };
        match self {
            Sizes::Equal { diameter: value } => diameter("diameter", value)?,
            Sizes::Bimodal {
                small,
                large,
                large_fraction,
            } => {
                diameter("small", small)?;
                diameter("large", large)?;
                require(
                    small <= large,
                    "large",
                    large,
                    "at least `small` is allowed",
                )?;
                require(
                    (0.0..=1.0).contains(&large_fraction),
                    "large_fraction",
                    large_fraction,
                    "0 … 1 is allowed",
                )?;
            }
            Sizes::Uniform { least, most } => {
                diameter("least", least)?;
                diameter("most", most)?;
                require(least <= most, "most", most, "at least `least` is allowed")?;
            }
            Sizes::LogNormal { median, spread } => {
                diameter("median", median)?;
                require(
                    (0.0..=2.0).contains(&spread),
                    "spread",
                    spread,
                    "0 … 2 is allowed",
                )?;
            }
        }
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup::seeded;

    /// First three moments of 200 000 diameters.
    fn moments(sizes: Sizes) -> [f64; 3] {
        let mut rng = seeded(7);
        let count = 200_000;
        let mut sums = [0.0; 3];
        for _ in 0..count {
            let diameter = sizes.sample(&mut rng);
            assert!(diameter >= sizes.smallest() && diameter <= sizes.largest());
            let mut power = 1.0;
            for sum in &mut sums {
                power *= diameter;
                *sum += power / f64::from(count);
            }
        }
        sums
    }

    fn assert_near(sizes: Sizes, known: [f64; 3]) {
        let found = moments(sizes);
        for k in 0..3 {
            // The widest of these distributions has ⟨σ⁶⟩ − ⟨σ³⟩² < 3.3 ⟨σ³⟩²; five
            // standard errors of that are 2 %.
            let error = (found[k] / known[k] - 1.0).abs();
            assert!(error < 0.025, "{sizes:?}: moment {} off by {error}", k + 1);
        }
    }

    #[test]
    fn equal_sizes_are_equal() {
        let sizes = Sizes::Equal { diameter: 0.3 };
        let mut rng = seeded(7);
        assert!((0..100).all(|_| sizes.sample(&mut rng) == 0.3));
        // And nothing is drawn for them.
        assert_eq!(uniform(&mut rng), uniform(&mut seeded(7)));
    }

    #[test]
    fn bimodal_moments() {
        let sizes = Sizes::Bimodal {
            small: 1.0,
            large: 1.4,
            large_fraction: 0.3,
        };
        assert_near(sizes, [1.12, 1.288, 0.7 + 0.3 * 2.744]);
    }

    #[test]
    fn uniform_moments() {
        let (a, b): (f64, f64) = (0.5, 1.5);
        let known = [2, 3, 4].map(|k| (b.powi(k) - a.powi(k)) / (f64::from(k) * (b - a)));
        assert_near(Sizes::Uniform { least: a, most: b }, known);
    }

    #[test]
    fn log_normal_moments() {
        // ⟨σ^k⟩ of the cut distribution: exp(k²s²/2) times the normal
        // distribution's share between −3 − ks and 3 − ks, over its share in ±3.
        let spread = 0.4;
        let share = |low: f64, high: f64| {
            0.5 * (libm::erf(high / 2.0_f64.sqrt()) - libm::erf(low / 2.0_f64.sqrt()))
        };
        let known = [1.0, 2.0, 3.0].map(|k: f64| {
            let shift = k * spread;
            2.0_f64.powf(k) * (0.5 * shift * shift).exp() * share(-3.0 - shift, 3.0 - shift)
                / share(-3.0, 3.0)
        });
        assert_near(
            Sizes::LogNormal {
                median: 2.0,
                spread,
            },
            known,
        );
    }

    #[test]
    fn nonsense_is_refused() {
        let wrong = [
            Sizes::Equal { diameter: 0.0 },
            Sizes::Equal { diameter: f64::NAN },
            Sizes::Bimodal {
                small: 2.0,
                large: 1.0,
                large_fraction: 0.5,
            },
            Sizes::Bimodal {
                small: 1.0,
                large: 2.0,
                large_fraction: 1.5,
            },
            Sizes::Uniform {
                least: -1.0,
                most: 1.0,
            },
            Sizes::LogNormal {
                median: 1.0,
                spread: -0.1,
            },
        ];
        for sizes in wrong {
            assert!(sizes.validated().is_err(), "{sizes:?}");
        }
    }

    #[test]
    fn text_comes_back() {
        let text = r#"{"kind":"bimodal","small":1.0,"large":1.4,"large_fraction":0.5}"#;
        let sizes: Sizes = serde_json::from_str(text).unwrap();
        assert_eq!(serde_json::to_string(&sizes).unwrap(), text);
        let wrong = r#"{"kind":"equal","diameter":1.0,"radius":2.0}"#;
        assert!(serde_json::from_str::<Sizes>(wrong).is_err());
    }
}
