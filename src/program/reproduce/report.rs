//! `reproduce.md` and `reproduce.json`.

use std::fmt::Write;
use std::path::Path;

use serde::Serialize;

use crate::output::write_atomically;
use crate::program::error::ProgramError;
use crate::program::reproduce::effort::Effort;
use crate::program::reproduce::row::{Row, Verdict};
use crate::program::table::table;

/// What a figure has given.
#[derive(Debug, Serialize)]
pub(super) struct Part {
    pub(super) title: &'static str,
    pub(super) files: Vec<String>,
    pub(super) rows: Vec<Row>,
}

#[derive(Serialize)]
struct Whole<'a> {
    version: &'static str,
    quick: bool,
    parts: &'a [Part],
}

/// A figure's table, and what it means.
pub(super) fn text(part: &Part) -> String {
    let mut text = format!("## {}\n\n", part.title);
    if !part.rows.is_empty() {
        let headings = ["quantity", "paper", "found", "runs", "verdict"];
        let mut rows = vec![headings.map(str::to_owned).to_vec()];
        for row in &part.rows {
            rows.push(vec![
                row.quantity.clone(),
                row.paper(),
                row.found(),
                row.seeds.to_string(),
                row.verdict.name().to_owned(),
            ]);
        }
        text += &table(&rows);
        text += "\n";
    }
    let mut said: Vec<&str> = Vec::new();
    for row in &part.rows {
        if !row.words.is_empty() && !said.contains(&row.words.as_str()) {
            said.push(&row.words);
        }
    }
    for words in said {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "- {words}");
    }
    text
}

/// How many agree.
pub(super) fn verdicts(folder: &Path, parts: &[Part]) -> String {
    let count = |verdict| {
        let rows = parts.iter().flat_map(|part| &part.rows);
        rows.filter(|row| row.verdict == verdict).count()
    };
    format!(
        "{}: {} numbers agree with the paper's, {} differ",
        folder.join("reproduce.md").display(),
        count(Verdict::Agrees),
        count(Verdict::Differs)
    )
}

pub(super) fn write(folder: &Path, effort: &Effort, parts: &[Part]) -> Result<(), ProgramError> {
    let mut markdown = "# The paper, figure by figure\n\n".to_owned();
    if effort.quick {
        markdown += "Made with `--quick`: small systems, which show that everything works, but \
                     whose numbers are not the paper's.\n\n";
    }
    markdown += "A number agrees if it is within twice both standard errors, and an allowance that \
                 `reproduce.json` states.\n\n";
    for part in parts {
        markdown += &text(part);
        for file in part.files.iter().filter(|file| file.ends_with(".svg")) {
            let _ = write!(markdown, "\n![{}]({file})\n", part.title);
        }
        markdown += "\n";
    }
    let whole = Whole {
        version: env!("CARGO_PKG_VERSION"),
        quick: effort.quick,
        parts,
    };
    let json = serde_json::to_string_pretty(&whole)
        .map_err(|error| ProgramError::io("reproduce.json")(error.into()))?;
    for (name, text) in [("reproduce.md", markdown), ("reproduce.json", json + "\n")] {
        let path = folder.join(name);
        let shown = path.display().to_string();
        write_atomically(&path, text.as_bytes()).map_err(ProgramError::io(shown))?;
    }
    Ok(())
}
