//! Axes: their names, ranges, scales and ticks.

use crate::plot::PlotError;

/// An axis of a plot, or the scale of its colours.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    name: String,
    unit: String,
    logarithmic: bool,
    range: Option<(f64, f64)>,
}

impl Axis {
    /// A linear axis for a quantity and the unit its values are in, such as
    /// `("height", "d")`; no unit for a pure number.
    #[must_use]
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Axis {
            name: name.into(),
            unit: unit.into(),
            logarithmic: false,
            range: None,
        }
    }

    /// The same with a logarithmic scale. Values that have no logarithm are left
    /// out of the plot.
    #[must_use]
    pub fn logarithmic(mut self) -> Self {
        self.logarithmic = true;
        self
    }

    /// The same from `low` to `high`, whatever is shown on it. What lies outside
    /// is cut off.
    #[must_use]
    pub fn with_range(mut self, low: f64, high: f64) -> Self {
        self.range = Some((low, high));
        self
    }

    /// The quantity with its unit in brackets.
    #[must_use]
    pub fn label(&self) -> String {
        if self.unit.is_empty() {
            self.name.clone()
        } else {
            format!("{} ({})", self.name, self.unit)
        }
    }

    /// The scale of this axis for these values: its range if it has one, else
    /// from the least to the greatest value and a little more on both sides,
    /// the share `margin` of the whole.
    pub(super) fn scale(
        &self,
        values: impl IntoIterator<Item = f64>,
        margin: f64,
    ) -> Result<Scale, PlotError> {
        let at = |value| place(value, self.logarithmic);
        if let Some((low, high)) = self.range {
            return match (at(low), at(high)) {
                (Some(from), Some(to)) if from < to => Ok(Scale {
                    from,
                    to,
                    logarithmic: self.logarithmic,
                }),
                _ => Err(PlotError::Range {
                    axis: self.name.clone(),
                    low,
                    high,
                }),
            };
        }
        let mut ends: Option<(f64, f64)> = None;
        for value in values.into_iter().filter_map(at) {
            let (low, high) = ends.unwrap_or((value, value));
            ends = Some((low.min(value), high.max(value)));
        }
        let (low, high) = ends.unwrap_or((0.0, 1.0));
        // Of a single value there is no width; a part of it, or a decade.
        let width = if high > low {
            margin * (high - low)
        } else if self.logarithmic || low == 0.0 {
            0.5
        } else {
            0.1 * low.abs()
        };
        Ok(Scale {
            from: low - width,
            to: high + width,
            logarithmic: self.logarithmic,
        })
    }
}

/// Where a value lies on a straight or logarithmic scale; `None` if nowhere.
fn place(value: f64, logarithmic: bool) -> Option<f64> {
    let place = match logarithmic {
        true if value <= 0.0 => return None,
        true => libm::log10(value),
        false => value,
    };
    // Far beyond what anybody plots, so that widths stay finite.
    (place.abs() < 1.0e300).then_some(place)
}

/// A label beside an axis, and where.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tick {
    /// As a share of the axis.
    pub(super) share: f64,
    /// Empty for a minor tick.
    pub(super) label: String,
}

/// From values to shares of the length of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    /// In values, or in decades.
    from: f64,
    to: f64,
    logarithmic: bool,
}

impl Scale {
    /// 0 at the beginning of the axis, 1 at its end; `None` if the value has no
    /// place on it at all.
    pub(super) fn share(&self, value: f64) -> Option<f64> {
        place(value, self.logarithmic).map(|place| (place - self.from) / (self.to - self.from))
    }

    /// From the least to the greatest value on it.
    pub(super) fn width(&self) -> f64 {
        self.to - self.from
    }

    /// The ticks, about `wanted` of them with labels.
    pub(super) fn ticks(&self, wanted: usize) -> Vec<Tick> {
        let decades = self.width();
        if self.logarithmic && decades > 0.7 {
            return self.decades(wanted);
        }
        let (low, high) = match self.logarithmic {
            true => (libm::exp10(self.from), libm::exp10(self.to)),
            false => (self.from, self.to),
        };
        let (step, exponent) = step((high - low) / wanted.max(1) as f64);
        let first = (low / step - 1.0e-9).ceil() as i64;
        let last = (high / step + 1.0e-9).floor() as i64;
        let greatest = low.abs().max(high.abs());
        (first..=last)
            .filter_map(|number| {
                let value = number as f64 * step;
                Some(Tick {
                    share: self.share(value)?,
                    label: written(value, exponent, greatest),
                })
            })
            .collect()
    }

    fn decades(&self, wanted: usize) -> Vec<Tick> {
        let (first, last) = (self.from.floor() as i32, self.to.ceil() as i32);
        let every = (((last - first) as usize).div_ceil(wanted.max(1)) as i32).max(1);
        let wide = self.width() > 2.0;
        let mut ticks = Vec::new();
        for decade in first..=last {
            for digit in 1..10 {
                let label = match digit {
                    1 if decade.rem_euclid(every) == 0 => power(decade),
                    2 | 5 if !wide => multiple(digit, decade),
                    1 => String::new(),
                    _ if every > 1 => continue,
                    _ => String::new(),
                };
                let place = f64::from(decade) + libm::log10(f64::from(digit));
                let share = (place - self.from) / self.width();
                if (-1.0e-9..=1.0 + 1.0e-9).contains(&share) {
                    ticks.push(Tick { share, label });
                }
            }
        }
        ticks
    }
}

/// 1, 2 or 5 times a power of ten that is nearest above `least`, and the power.
fn step(least: f64) -> (f64, i32) {
    let exponent = libm::floor(libm::log10(least)) as i32;
    let unit = libm::exp10(f64::from(exponent));
    for factor in [1.0, 2.0, 5.0] {
        // What is exactly as long as wanted is not made longer by rounding.
        if factor * unit >= least * (1.0 - 1.0e-9) {
            return (factor * unit, exponent);
        }
    }
    (10.0 * unit, exponent + 1)
}

/// A number that is a multiple of 10^exponent, in as few digits as that takes.
fn written(value: f64, exponent: i32, greatest: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !(-5..5).contains(&exponent) || greatest >= 1.0e7 {
        // One power for the whole axis.
        let power = libm::floor(libm::log10(greatest) + 1.0e-9) as i32;
        let digits = (power - exponent).clamp(0, 15) as usize;
        let factor = value / libm::exp10(f64::from(power));
        return format!(
            "{}·10{}",
            minus(format!("{factor:.digits$}")),
            raised(power)
        );
    }
    minus(format!("{value:.*}", (-exponent).max(0) as usize))
}

/// A power of ten.
fn power(exponent: i32) -> String {
    match exponent {
        -2..=3 => multiple(1, exponent),
        _ => format!("10{}", raised(exponent)),
    }
}

fn multiple(digit: i32, exponent: i32) -> String {
    match exponent {
        -3..=-1 => {
            let places = -exponent as usize;
            format!(
                "{:.places$}",
                f64::from(digit) * libm::exp10(f64::from(exponent))
            )
        }
        0..=3 => format!("{}", digit * [1, 10, 100, 1000][exponent as usize]),
        _ => format!("{digit}·10{}", raised(exponent)),
    }
}

/// A true minus sign in place of the hyphen.
pub(super) fn minus(number: String) -> String {
    number.replace('-', "−")
}

fn raised(exponent: i32) -> String {
    exponent
        .to_string()
        .chars()
        .map(|digit| match digit {
            '-' => '⁻',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            '0' => '⁰',
            // The others follow each other.
            other => char::from_u32(0x2070 + (other as u32 - '0' as u32)).unwrap_or(other),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis, ends: [f64; 2]) -> Vec<String> {
        let scale = axis.scale(ends, 0.0).unwrap();
        let ticks = scale.ticks(6).into_iter().map(|tick| tick.label);
        ticks.filter(|label| !label.is_empty()).collect()
    }

    #[test]
    fn ticks_are_round_numbers() {
        let axis = Axis::new("x", "d");
        assert_eq!(
            labels(&axis, [0.0, 1.0]),
            ["0", "0.2", "0.4", "0.6", "0.8", "1.0"]
        );
        assert_eq!(labels(&axis, [-3.0, 9.0]), ["−2", "0", "2", "4", "6", "8"]);
        assert_eq!(
            labels(&axis, [0.62, 0.641]),
            ["0.620", "0.625", "0.630", "0.635", "0.640"]
        );
        assert_eq!(
            labels(&axis, [0.0, 2.4e8]),
            ["0", "0.5·10⁸", "1.0·10⁸", "1.5·10⁸", "2.0·10⁸"]
        );
    }

    #[test]
    fn logarithmic_ticks_are_decades() {
        let axis = Axis::new("x", "").logarithmic();
        assert_eq!(
            labels(&axis, [1.0e-5, 10.0]).join(" "),
            "10⁻⁵ 10⁻⁴ 10⁻³ 0.01 0.1 1 10"
        );
        assert_eq!(labels(&axis, [0.01, 0.1]).join(" "), "0.01 0.02 0.05 0.1");
        assert_eq!(labels(&axis, [10.0, 20.0]).join(" "), "10 12 14 16 18 20");
        let far = labels(&axis, [1.0e-30, 1.0]);
        assert!(
            far.len() <= 8 && far.contains(&"10⁻³⁰".to_owned()),
            "{far:?}"
        );
    }

    #[test]
    fn shares_run_from_0_to_1() {
        let scale = Axis::new("x", "").logarithmic().with_range(0.1, 10.0);
        let scale = scale.scale([], 0.0).unwrap();
        assert_eq!(scale.share(1.0), Some(0.5));
        assert_eq!(scale.share(0.0), None);
        assert_eq!(scale.share(f64::NAN), None);
        let scale = Axis::new("x", "").scale([f64::NAN, 2.0, 4.0], 0.0).unwrap();
        assert_eq!(scale.share(3.0), Some(0.5));
        assert_eq!(scale.share(f64::INFINITY), None);
    }

    #[test]
    fn ranges_without_a_width_are_refused_by_name() {
        let axis = Axis::new("speed", "√(gd)");
        for (low, high) in [
            (1.0, 1.0),
            (2.0, 1.0),
            (f64::NAN, 1.0),
            (0.0, f64::INFINITY),
        ] {
            let error = axis
                .clone()
                .with_range(low, high)
                .scale([], 0.0)
                .unwrap_err();
            assert!(error.to_string().contains("`speed`"), "{error}");
        }
        let logarithmic = axis.logarithmic().with_range(0.0, 1.0);
        assert!(logarithmic.scale([], 0.0).is_err());
    }

    #[test]
    fn single_values_and_none_have_a_scale() {
        for values in [vec![], vec![0.0], vec![-7.0], vec![1.0e-300]] {
            for axis in [Axis::new("x", ""), Axis::new("x", "").logarithmic()] {
                let scale = axis.scale(values.clone(), 0.04).unwrap();
                assert!(scale.width() > 0.0);
            }
        }
    }
}
