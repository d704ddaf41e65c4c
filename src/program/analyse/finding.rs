//! What a measurement gives: tables, plots, and words.

use std::path::Path;

use crate::analysis::{Mean, Profile};
use crate::output::write_atomically;
use crate::program::error::ProgramError;

/// A table for machines.
#[derive(Clone, Debug)]
pub(super) struct Columns {
    names: Vec<&'static str>,
    rows: Vec<Vec<String>>,
}

impl Columns {
    pub(super) fn new(names: impl IntoIterator<Item = &'static str>) -> Self {
        Columns {
            names: names.into_iter().collect(),
            rows: Vec::new(),
        }
    }

    /// A row of numbers, with as many digits as it takes to read the same bits.
    /// What is not a number is left empty.
    pub(super) fn numbers(&mut self, row: impl IntoIterator<Item = f64>) {
        self.rows.push(row.into_iter().map(number).collect());
    }

    /// A row of a word and numbers.
    pub(super) fn named(&mut self, name: String, row: impl IntoIterator<Item = f64>) {
        let mut cells = vec![name];
        cells.extend(row.into_iter().map(number));
        self.rows.push(cells);
    }

    /// The rows of a profile: middle, mean, error and number of frames.
    pub(super) fn profile(&mut self, profile: &Profile) {
        for (centre, mean) in profile.bins.centres().into_iter().zip(&profile.means) {
            self.numbers([centre, mean.value, mean.error, mean.count as f64]);
        }
    }

    fn text(&self) -> Result<Vec<u8>, csv::Error> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(&self.names)?;
        for row in &self.rows {
            writer.write_record(row)?;
        }
        writer
            .into_inner()
            .map_err(|error| csv::Error::from(error.into_error()))
    }
}

fn number(value: f64) -> String {
    if value.is_nan() {
        String::new()
    } else if value == value.trunc() && value.abs() < 1.0e15 {
        format!("{value}")
    } else {
        format!("{value:?}")
    }
}

/// The result of one measurement.
#[derive(Clone, Debug)]
pub(super) struct Finding {
    /// What the files are called.
    pub(super) name: &'static str,
    /// What to tell people, in lines.
    pub(super) words: Vec<String>,
    pub(super) table: Columns,
    pub(super) picture: String,
}

impl Finding {
    /// Writes both files.
    pub(super) fn write(&self, folder: &Path) -> Result<(), ProgramError> {
        let write = |ending: &str, bytes: &[u8]| {
            let file = folder.join(format!("{}.{ending}", self.name));
            let shown = file.display().to_string();
            write_atomically(&file, bytes).map_err(ProgramError::io(shown))
        };
        let table = self
            .table
            .text()
            .map_err(|error| ProgramError::io(format!("{}.csv", self.name))(error.into()))?;
        write("csv", &table)?;
        write("svg", self.picture.as_bytes())
    }
}

/// A mean with its error for people: two digits of the error, but no more than
/// seven of the mean.
pub(super) fn with_error(mean: &Mean) -> String {
    let Mean { value, error, .. } = *mean;
    if !(error > 0.0 && error.is_finite()) {
        return format!("{value:.4}");
    }
    let power = |number: f64| libm::floor(libm::log10(number.abs())) as i32;
    if error < 1.0e-6 * value.abs() {
        let digits = (6 - power(value)).clamp(0, 12) as usize;
        return format!("{value:.digits$} ± {error:.0e}");
    }
    let digits = (1 - power(error)).clamp(0, 12) as usize;
    format!("{value:.digits$} ± {error:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_have_as_many_digits_as_they_are_sure_of() {
        let shown = |value, error| {
            with_error(&Mean {
                value,
                error,
                count: 9,
            })
        };
        assert_eq!(shown(0.632_17, 0.001_23), "0.6322 ± 0.0012");
        assert_eq!(shown(-1234.56, 78.9), "-1235 ± 79");
        assert_eq!(shown(0.687_397_447_948, 5.1e-11), "0.6873974 ± 5e-11");
        assert_eq!(shown(2.5, f64::NAN), "2.5000");
    }
}
