//! `--set path=value,value,…`, also `--set path,path=value,value,…`.

use std::str::FromStr;

use toml::Value;

use crate::scenario::{Assignment, Path};

/// A value of a scenario, or several that are always the same, and all that it
/// is to be.
#[derive(Clone, Debug)]
pub(in crate::program) struct Variation {
    /// At least one.
    pub(super) paths: Vec<Path>,
    /// At least one; each with an assignment for each path.
    values: Vec<Vec<Assignment>>,
    /// What was typed.
    pub(super) text: String,
}

impl Variation {
    /// One value for all runs.
    pub(super) fn fixed(value: Assignment) -> Self {
        Variation {
            paths: vec![value.path.clone()],
            text: value.text.clone(),
            values: vec![vec![value]],
        }
    }

    /// How many values there are.
    pub(super) fn count(&self) -> usize {
        self.values.len()
    }

    /// Whether there is more than one value.
    pub(super) fn is_varied(&self) -> bool {
        self.values.len() > 1
    }

    /// What a value is written into the scenario by.
    pub(super) fn assignments(&self, value: usize) -> &[Assignment] {
        &self.values[value]
    }

    /// All values.
    pub(super) fn values(&self) -> impl Iterator<Item = &Value> {
        self.values.iter().map(|sets| &sets[0].value)
    }

    /// The paths as they are typed.
    pub(super) fn title(&self) -> String {
        let paths: Vec<String> = self.paths.iter().map(Path::to_string).collect();
        paths.join(",")
    }
}

/// A list of values that can't be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub(in crate::program) enum ParseVariationError {
    #[error("`{0}` has no `=`: write path=value,value, such as parameters.sleep_speed=0.05,0.1")]
    NoValue(String),
    #[error(
        "value {0} of the list is empty: write values between the commas, an empty text as \"\""
    )]
    Empty(usize),
    #[error("the {0} that opens value {1} of the list is never closed")]
    Open(char, usize),
    #[error("{0}")]
    Assignment(String),
}

impl FromStr for Variation {
    type Err = ParseVariationError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (paths, list) = text
            .split_once('=')
            .ok_or_else(|| ParseVariationError::NoValue(text.to_owned()))?;
        let of = |value: &str| {
            let sets = paths
                .split(',')
                .map(|path| format!("{path}={value}").parse());
            sets.collect::<Result<Vec<Assignment>, _>>()
        };
        let values = split(list)?
            .into_iter()
            .map(of)
            .collect::<Result<Vec<_>, _>>()
            .map_err(|error| ParseVariationError::Assignment(error.to_string()))?;
        let paths = values.iter().take(1).flatten().map(|set| set.path.clone());
        Ok(Variation {
            paths: paths.collect(),
            values,
            text: format!("--set {text}"),
        })
    }
}

/// The values of a list, without the blanks around them.
///
/// A comma separates values unless it stands in brackets or in a quoted text. A
/// quoted text is one inside of brackets or one that a value begins with, so
/// that `it's` is nothing special.
fn split(list: &str) -> Result<Vec<&str>, ParseVariationError> {
    let mut values = Vec::new();
    let mut rest = list;
    loop {
        let number = values.len() + 1;
        let length =
            length_of_first(rest).map_err(|open| ParseVariationError::Open(open, number))?;
        let value = rest[..length].trim();
        if value.is_empty() {
            return Err(ParseVariationError::Empty(number));
        }
        values.push(value);
        match rest[length..].strip_prefix(',') {
            Some(after) => rest = after,
            None => return Ok(values),
        }
    }
}

/// How many bytes come before the first comma that separates, or what is never
/// closed.
fn length_of_first(list: &str) -> Result<usize, char> {
    let mut open: Vec<char> = Vec::new();
    let mut begun = false;
    let mut at = 0;
    while let Some(letter) = list[at..].chars().next() {
        match letter {
            ',' if open.is_empty() => return Ok(at),
            '"' | '\'' if !begun || !open.is_empty() => {
                begun = true;
                at += length_of_text(&list[at..], letter).ok_or(letter)?;
                continue;
            }
            '[' | '{' => open.push(letter),
            // What closes nothing is left to whoever reads the value.
            ']' | '}' => drop(open.pop()),
            _ => {}
        }
        begun |= !letter.is_whitespace();
        at += letter.len_utf8();
    }
    open.first().map_or(Ok(at), |&open| Err(open))
}

/// How many bytes a quoted text at the beginning of `text` has, with its quotes:
/// one, or three as TOML has them, too. `None` if it does not end.
fn length_of_text(text: &str, quote: char) -> Option<usize> {
    let quotes = |at: usize| text[at..].chars().take_while(|next| *next == quote).count();
    let mark = if quotes(0) >= 3 { 3 } else { 1 };
    let mut at = mark;
    loop {
        let letter = text[at..].chars().next()?;
        let here = quotes(at);
        if here >= mark {
            // Up to two more, before the last three, belong to the text.
            return Some(at + if mark == 3 { here.min(5) } else { 1 });
        }
        at += letter.len_utf8();
        if letter == '\\' && quote == '"' {
            at += text[at..].chars().next()?.len_utf8();
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn commas_in_brackets_and_quotes_separate_nothing() {
        for (list, wanted) in [
            ("0.05", &["0.05"][..]),
            ("0.05, 0.1 ,never", &["0.05", "0.1", "never"]),
            ("[0, -1],[0.1, -1]", &["[0, -1]", "[0.1, -1]"]),
            (
                "{periodic={length=5}},{walls={low=0,restitution=0.5}},open",
                &[
                    "{periodic={length=5}}",
                    "{walls={low=0,restitution=0.5}}",
                    "open",
                ],
            ),
            ("\"one, two\",three", &["\"one, two\"", "three"]),
            ("'a,\\',b", &["'a,\\'", "b"]),
            ("\"a\\\",b\",c", &["\"a\\\",b\"", "c"]),
            ("\"\"\"a\",b\"\"\",c", &["\"\"\"a\",b\"\"\"", "c"]),
            ("[\"\"\"\n,\"\"\"\"],c", &["[\"\"\"\n,\"\"\"\"]", "c"]),
            ("\"\"\"\"\"\",c", &["\"\"\"\"\"\"", "c"]),
            ("[\"]\",1],2", &["[\"]\",1]", "2"]),
            ("it's,fine", &["it's", "fine"]),
            ("\"\"", &["\"\""]),
            ("α,β", &["α", "β"]),
            ("a],b", &["a]", "b"]),
        ] {
            assert_eq!(split(list).unwrap(), wanted, "{list}");
        }
    }

    #[test]
    fn several_paths_have_the_same_values() {
        let both: Variation = "a.b, c[0]=1,[2, 3]".parse().unwrap();
        assert_eq!((both.title().as_str(), both.count()), ("a.b,c[0]", 2));
        let sets: Vec<String> = (0..2)
            .flat_map(|value| both.assignments(value))
            .map(|set| format!("{}={}", set.path, set.value))
            .collect();
        assert_eq!(sets, ["a.b=1", "c[0]=1", "a.b=[2, 3]", "c[0]=[2, 3]"]);
    }

    #[test]
    fn what_is_no_list_is_refused() {
        for (text, wanted) in [
            ("parameters.sleep_speed", "has no `=`"),
            ("a=", "value 1 of the list is empty"),
            ("a=1,,2", "value 2 of the list is empty"),
            ("a=1,2,", "value 3 of the list is empty"),
            (
                "a=1,[2",
                "the [ that opens value 2 of the list is never closed",
            ),
            ("a={b=[1}", "never closed"),
            ("a=\"b,c", "the \" that opens value 1"),
            ("a..b=1", "no path"),
            ("a,=1", "no path"),
        ] {
            let error = text.parse::<Variation>().unwrap_err();
            assert!(error.to_string().contains(wanted), "{text}: {error}");
        }
    }

    /// Values of TOML with everything in them that could be taken for something
    /// else.
    fn value() -> impl Strategy<Value = Value> {
        let text = "[a,\\[\\]{}'\"\\\\= \\n#α]{0,8}";
        let leaf = prop_oneof![
            any::<i64>().prop_map(Value::Integer),
            (-1.0e3..1.0e3).prop_map(Value::Float),
            any::<bool>().prop_map(Value::Boolean),
            text.prop_map(Value::String),
        ];
        leaf.prop_recursive(3, 12, 4, |inner| {
            prop_oneof![
                prop::collection::vec(inner.clone(), 0..4).prop_map(Value::Array),
                prop::collection::btree_map("[a-z]{1,3}", inner, 0..4)
                    .prop_map(|table| Value::Table(table.into_iter().collect())),
            ]
        })
    }

    proptest! {
        /// Whatever is written as in TOML comes back, in its place.
        #[test]
        fn values_come_back(values in prop::collection::vec(value(), 1..5)) {
            let list: Vec<String> = values.iter().map(Value::to_string).collect();
            let variation: Variation = format!("a.b={}", list.join(",")).parse().unwrap();
            let found: Vec<Value> = variation.values().cloned().collect();
            prop_assert_eq!(found, values);
        }

        /// Whatever is typed, either it is refused, or nothing of it is lost.
        #[test]
        fn nothing_is_lost(list in "[a1,\\[\\]{}'\"\\\\ α]{0,16}") {
            if let Ok(values) = split(&list) {
                let bare = |text: &str| text.replace([' ', ','], "");
                prop_assert_eq!(bare(&values.concat()), bare(&list));
                prop_assert!(values.iter().all(|value| !value.is_empty()));
            }
        }
    }
}
