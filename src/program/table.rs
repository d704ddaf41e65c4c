//! Tables for people, in Markdown.

/// A table whose first row holds the headings; all rows are of the same length.
pub(super) fn table(rows: &[Vec<String>]) -> String {
    let columns = rows.first().map_or(0, Vec::len);
    let widths: Vec<usize> = (0..columns)
        .map(|column| {
            rows.iter()
                .map(|row| width(&row[column]))
                .max()
                .unwrap_or(0)
        })
        .collect();
    let rule: Vec<String> = widths.iter().map(|&wide| "-".repeat(wide + 2)).collect();
    let mut text = String::new();
    for (number, row) in rows.iter().enumerate() {
        let cells: Vec<String> = row
            .iter()
            .zip(&widths)
            .map(|(cell, &wide)| format!("{cell}{}", " ".repeat(wide - width(cell))))
            .collect();
        text += &format!("| {} |\n", cells.join(" | "));
        if number == 0 {
            text += &format!("|{}|\n", rule.join("|"));
        }
    }
    text
}

/// As many columns as a terminal gives it; there are no wide characters here.
fn width(text: &str) -> usize {
    text.chars().count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_as_wide_as_their_widest_cell() {
        let rows = [["a", "±"], ["1", "long"]].map(|row| row.map(str::to_owned).to_vec());
        assert_eq!(table(&rows), "| a | ±    |\n|---|------|\n| 1 | long |\n");
    }
}
