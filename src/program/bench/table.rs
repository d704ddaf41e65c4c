//! Rows for a reader and for a file.

use std::fs::File;
use std::path::Path;

use crate::program::error::ProgramError;
use crate::program::show::say;

/// A table that is printed, and written as CSV, row by row, so that what is
/// there is not lost if the rest is not waited for.
pub(super) struct Table {
    widths: Vec<usize>,
    file: Option<(String, csv::Writer<File>)>,
}

impl Table {
    /// Prints the heads of the columns. A file that is there already is
    /// replaced.
    pub(super) fn new(columns: &[&str], out: Option<&Path>) -> Result<Self, ProgramError> {
        let mut table = Table {
            // Room for the numbers under short heads.
            widths: columns.iter().map(|head| head.len().max(9)).collect(),
            file: None,
        };
        if let Some(path) = out {
            let name = path.display().to_string();
            let file = File::create(path).map_err(ProgramError::io(name.clone()))?;
            table.file = Some((name, csv::Writer::from_writer(file)));
        }
        let heads: Vec<String> = columns.iter().map(|&head| head.to_owned()).collect();
        table.row(&heads)?;
        Ok(table)
    }

    /// Adds a row; an empty text is an unknown value.
    pub(super) fn row(&mut self, values: &[String]) -> Result<(), ProgramError> {
        if let Some((name, writer)) = &mut self.file {
            writer
                .write_record(values)
                .map_err(std::io::Error::from)
                .and_then(|()| writer.flush())
                .map_err(ProgramError::io(name.clone()))?;
        }
        let cells: Vec<String> = values
            .iter()
            .zip(&self.widths)
            .map(|(value, &width)| format!("{value:>width$}"))
            .collect();
        say(&cells.join("  "))
    }
}
