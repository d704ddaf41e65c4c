//! From a path to the line and column of a TOML file.

use std::ops::Range;

use toml_edit::{Document, Item, TableLike, Value};

use crate::scenario::path::{Path, Segment};

/// A line of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// Counted from 1.
    pub number: usize,
    /// Where in the line, in characters counted from 1.
    pub column: usize,
    /// The line itself.
    pub text: String,
}

impl Line {
    /// The line around a byte of `text`.
    #[must_use]
    pub fn at(text: &str, byte: usize) -> Self {
        let mut byte = byte.min(text.len());
        while !text.is_char_boundary(byte) {
            byte -= 1;
        }
        let start = text[..byte].rfind('\n').map_or(0, |at| at + 1);
        let end = text[byte..].find('\n').map_or(text.len(), |at| byte + at);
        Line {
            number: text[..start].matches('\n').count() + 1,
            column: text[start..byte].chars().count() + 1,
            text: text[start..end].trim_end().to_owned(),
        }
    }
}

/// Where something wrong stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file, the preset, or the `--set` it came by.
    pub source: String,
    /// The path of the value.
    pub path: Path,
    /// Its line, if that is known.
    pub line: Option<Line>,
}

/// The bytes of a TOML text at which `path` stands, or else what it would
/// stand in. Points at the value, or at the key if `want_key`.
pub(super) fn locate(text: &str, path: &Path, want_key: bool) -> Option<Range<usize>> {
    let document = Document::parse(text).ok()?;
    let mut node = Node::Table(document.as_table());
    let mut found = None;
    let last = path.segments().len().checked_sub(1);
    for (depth, segment) in path.segments().iter().enumerate() {
        let key_wanted = want_key && Some(depth) == last;
        match node.step(segment, key_wanted) {
            Some((span, next)) => {
                found = span.or(found);
                node = next;
            }
            None => break,
        }
    }
    found
}

/// What a path has led to so far.
enum Node<'a> {
    Table(&'a dyn TableLike),
    Tables(&'a toml_edit::ArrayOfTables),
    Array(&'a toml_edit::Array),
    Leaf,
}

impl<'a> Node<'a> {
    fn of_item(item: &'a Item) -> Self {
        match item {
            Item::ArrayOfTables(tables) => Node::Tables(tables),
            Item::Table(table) => Node::Table(table),
            Item::Value(value) => Node::of_value(value),
            Item::None => Node::Leaf,
        }
    }

    fn of_value(value: &'a Value) -> Self {
        match value {
            Value::Array(array) => Node::Array(array),
            Value::InlineTable(table) => Node::Table(table),
            _ => Node::Leaf,
        }
    }

    fn step(&self, segment: &Segment, want_key: bool) -> Option<(Option<Range<usize>>, Node<'a>)> {
        match (self, segment) {
            (Node::Table(table), Segment::Key(name)) => {
                let (key, item) = table.get_key_value(name)?;
                // A table made by dotted keys has no place of its own.
                let span = if want_key { None } else { item.span() };
                Some((span.or_else(|| key.span()), Node::of_item(item)))
            }
            (Node::Tables(tables), Segment::Index(index)) => {
                let table = tables.get(*index)?;
                Some((table.span(), Node::Table(table)))
            }
            (Node::Array(array), Segment::Index(index)) => {
                let value = array.get(*index)?;
                Some((value.span(), Node::of_value(value)))
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "seed = 1\n[parameters]\nrestitution = 0.7\n\n[[grains]]\nposition = [1,\n 2]\n[[grains]]\nrain.count = 3\n";

    fn line(path: &str) -> (usize, usize) {
        let span = locate(TEXT, &path.parse().unwrap(), false).unwrap();
        let line = Line::at(TEXT, span.start);
        (line.number, line.column)
    }

    #[test]
    fn values_are_found() {
        assert_eq!(line("seed"), (1, 8));
        assert_eq!(line("parameters.restitution"), (3, 15));
        assert_eq!(line("grains[0].position[1]"), (7, 2));
        assert_eq!(line("grains[1].rain.count"), (9, 14));
    }

    #[test]
    fn what_is_missing_is_sought_where_it_would_stand() {
        assert_eq!(line("parameters.elastic_speed").0, 2);
        assert_eq!(line("grains[1].rain.sizes").0, 9);
        assert_eq!(locate(TEXT, &Path::root().key("title"), false), None);
    }

    #[test]
    fn columns_count_characters() {
        let text = "α = 1\nβγ = 2";
        let found = Line::at(text, text.find('2').unwrap());
        assert_eq!((found.number, found.column), (2, 6));
        assert_eq!(Line::at(text, 1_000).number, 2);
    }
}
