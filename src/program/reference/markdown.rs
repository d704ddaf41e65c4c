//! Pieces of Markdown.

/// Text in one line, as Markdown takes it literally; what stands between
/// backticks stays, and options become code.
pub(super) fn line(text: &str) -> String {
    let mut out = String::new();
    for (index, part) in text.split('`').enumerate() {
        let words = part.split_whitespace().collect::<Vec<_>>().join(" ");
        // The blanks at the ends of a part separate it from its neighbours.
        let lead = if part.starts_with(char::is_whitespace) {
            " "
        } else {
            ""
        };
        let trail = if part.ends_with(char::is_whitespace) && !words.is_empty() {
            " "
        } else {
            ""
        };
        if index % 2 == 1 {
            out.push_str(&format!("`{words}`"));
        } else {
            out.push_str(&format!("{lead}{}{trail}", prose(&words)));
        }
    }
    out.trim().replace('|', "\\|")
}

/// Words outside of code.
fn prose(words: &str) -> String {
    let word = |word: &str| {
        if let Some(option) = word.strip_prefix("--").filter(|rest| !rest.is_empty()) {
            let end = option.find(|c: char| !(c.is_alphanumeric() || c == '-'));
            let (name, rest) = option.split_at(end.unwrap_or(option.len()));
            return format!("`--{name}`{}", literal(rest));
        }
        literal(word)
    };
    words.split(' ').map(word).collect::<Vec<_>>().join(" ")
}

/// Signs that Markdown would take for something else.
fn literal(word: &str) -> String {
    let mut out = String::new();
    for sign in word.chars() {
        match sign {
            '<' => out.push_str("&lt;"),
            '*' | '[' | ']' => {
                out.push('\\');
                out.push(sign);
            }
            _ => out.push(sign),
        }
    }
    out
}

/// The paragraphs of a text, each in one line.
pub(super) fn paragraphs(text: &str) -> String {
    let blocks: Vec<String> = text.split("\n\n").map(line).collect();
    blocks.join("\n\n")
}

/// Code in a cell.
pub(super) fn code(text: &str) -> String {
    format!("`{}`", text.replace('|', "\\|"))
}

/// A table; columns without any content are left out.
pub(super) fn table(head: &[&str], rows: &[Vec<String>]) -> String {
    let shown: Vec<usize> = (0..head.len())
        .filter(|&column| rows.iter().any(|row| !row[column].is_empty()))
        .collect();
    let join = |cells: Vec<&str>| format!("| {} |\n", cells.join(" | "));
    let mut out = join(shown.iter().map(|&column| head[column]).collect());
    out.push_str(&join(vec!["---"; shown.len()]));
    for row in rows {
        let cell = |&column: &usize| match row[column].as_str() {
            "" => "–",
            text => text,
        };
        out.push_str(&join(shown.iter().map(cell).collect()));
    }
    out
}

/// What a heading is called in links.
pub(super) fn anchor(heading: &str) -> String {
    heading
        .trim()
        .chars()
        .filter_map(|sign| match sign {
            ' ' => Some('-'),
            '-' | '_' => Some(sign),
            _ if sign.is_alphanumeric() => Some(sign.to_ascii_lowercase()),
            _ => None,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_become_code_and_signs_stay_signs() {
        assert_eq!(
            line("as --set stop.time=T,\n  or `a|b`"),
            "as `--set` stop.time=T, or `a\\|b`"
        );
        assert_eq!(line("a <b> [c] -- `d` (e)"), "a &lt;b> \\[c\\] -- `d` (e)");
    }

    #[test]
    fn empty_columns_are_left_out() {
        let rows = [vec!["x".to_owned(), String::new(), String::new()]];
        assert_eq!(table(&["a", "b", "c"], &rows), "| a |\n| --- |\n| x |\n");
    }
}
