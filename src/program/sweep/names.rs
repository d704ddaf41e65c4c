//! What the folders of runs are called.

use std::collections::{BTreeMap, BTreeSet};

use toml::Value;
use xxhash_rust::xxh3::xxh3_64;

use crate::program::sweep::values::Variation;
use crate::scenario::{Path, Segment};

/// The longest name of a value that is shown as it is.
const LONGEST_VALUE: usize = 40;
/// The longest name of a combination.
const LONGEST: usize = 180;

/// A value as people write it.
pub(super) fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Float(number) => format!("{number:?}"),
        _ => value.to_string(),
    }
}

/// At most so many characters of a text.
pub(super) fn shortened(text: &str, most: usize) -> String {
    match text.char_indices().nth(most) {
        Some((at, _)) => format!("{}…", &text[..at]),
        None => text.to_owned(),
    }
}

/// For each variation the names of its values, such as `sleep_speed=0.05`;
/// `None` if it has only one value. Of several paths the first counts. They depend on nothing but the values.
pub(super) fn names_of(variations: &[Variation]) -> Vec<Option<Vec<String>>> {
    let varied = |variation: &&Variation| variation.is_varied();
    let mut short = BTreeMap::new();
    for variation in variations.iter().filter(varied) {
        *short
            .entry(key(&variation.paths[0], true).to_lowercase())
            .or_insert(0) += 1;
    }
    let of = |variation: &Variation| {
        let name = key(&variation.paths[0], true);
        // The seed has this name.
        let alone = short.get(&name.to_lowercase()) == Some(&1) && name != "seed";
        let name = if alone {
            name
        } else {
            key(&variation.paths[0], false)
        };
        let values: Vec<&Value> = variation.values().collect();
        let words = words(&values).into_iter();
        words.map(|word| format!("{name}={word}")).collect()
    };
    variations
        .iter()
        .map(|variation| Some(variation).filter(varied).map(of))
        .collect()
}

/// The names of combinations, all different even where capitals are the same
/// as small letters.
pub(super) fn unique(names: Vec<String>) -> Vec<String> {
    let names: Vec<String> = names
        .into_iter()
        .map(|name| match name.len() {
            0..=LONGEST => name,
            _ => format!(
                "{}~{:016x}",
                &name[..LONGEST - 20],
                xxh3_64(name.as_bytes())
            ),
        })
        .collect();
    if all_different(&names) {
        return names;
    }
    let numbered = names.iter().enumerate();
    numbered
        .map(|(number, name)| format!("{name}~{number}"))
        .collect()
}

fn all_different(names: &[String]) -> bool {
    let mut seen = BTreeSet::new();
    names.iter().all(|name| seen.insert(name.to_lowercase()))
}

/// The last key of a path with the indices that follow it, or all of it.
fn key(path: &Path, short: bool) -> String {
    let segments = path.segments();
    let is_key = |segment: &Segment| matches!(segment, Segment::Key(_));
    let from = match segments.iter().rposition(is_key) {
        Some(last) if short => last,
        _ => 0,
    };
    let words: Vec<String> = segments[from..].iter().map(Segment::to_string).collect();
    words.join(".")
}

/// A name for each value: what it is if that can stand in the name of a file,
/// or else what is left of it, with a fingerprint.
fn words(values: &[&Value]) -> Vec<String> {
    let plain: Vec<String> = values.iter().map(|value| plain(value)).collect();
    let mut times = BTreeMap::new();
    for text in &plain {
        *times.entry(text.to_lowercase()).or_insert(0) += 1;
    }
    let fits = |text: &str| {
        (1..=LONGEST_VALUE).contains(&text.len())
            && text.bytes().all(is_safe)
            && times.get(&text.to_lowercase()) == Some(&1)
    };
    let word = |(text, value): (&String, &&Value)| {
        if fits(text) {
            return text.clone();
        }
        let parts = text.split(|letter: char| !letter.is_ascii() || !is_safe(letter as u8));
        let parts: Vec<&str> = parts.filter(|part| !part.is_empty()).collect();
        let mut left = parts.join("_");
        left.truncate(LONGEST_VALUE - 16);
        format!(
            "{left}~{:08x}",
            xxh3_64(value.to_string().as_bytes()) as u32
        )
    };
    plain.iter().zip(values).map(word).collect()
}

/// What no shell and no file system takes for something else.
fn is_safe(letter: u8) -> bool {
    letter.is_ascii_alphanumeric() || b".+-".contains(&letter)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(sets: &[&str]) -> Vec<Vec<String>> {
        let variations: Vec<Variation> = sets.iter().map(|set| set.parse().unwrap()).collect();
        names_of(&variations).into_iter().flatten().collect()
    }

    #[test]
    fn names_are_the_last_key_and_the_value() {
        assert_eq!(
            named(&[
                "parameters.sleep_speed=5e-2,1e-7,never",
                "grains.1.rain.count=3"
            ]),
            [["sleep_speed=0.05", "sleep_speed=1e-7", "sleep_speed=never"]]
        );
        assert_eq!(
            named(&["gravity,title=none,1", "grains[0].position[1]=2,3"]),
            [
                ["gravity=none", "gravity=1"],
                ["position.1=2", "position.1=3"]
            ]
        );
    }

    #[test]
    fn keys_that_are_the_same_are_written_out() {
        assert_eq!(
            named(&["grains.0.rain.count=1,2", "grains[1].rain.count=1,2"]).concat(),
            [
                "grains.0.rain.count=1",
                "grains.0.rain.count=2",
                "grains.1.rain.count=1",
                "grains.1.rain.count=2"
            ]
        );
        assert_eq!(named(&["self_check.seed=1,2"])[0][0], "self_check.seed=1");
    }

    #[test]
    fn what_is_no_name_of_a_file_is_told_apart_by_fingerprints() {
        let names = named(&["grains.0.file=a/b.xyz,a-b.xyz,A-b.xyz,../a,'',\"1\",1"]).concat();
        assert!(all_different(&names), "{names:?}");
        assert!(names[0].starts_with("file=a_b.xyz~"), "{names:?}");
        for name in &names {
            let word = name.strip_prefix("file=").unwrap();
            assert!(
                word.bytes()
                    .all(|letter| is_safe(letter) || b"_~".contains(&letter)),
                "{word}"
            );
        }
        // A name depends on no other value but those it could be taken for.
        assert_eq!(names[3], named(&["grains.0.file=x,../a"])[0][1]);
    }

    #[test]
    fn long_names_are_cut_and_stay_different() {
        let long = |end: &str| format!("{}{end}", "a=1_".repeat(100));
        let names = unique(vec![long("x"), long("y")]);
        assert!(names.iter().all(|name| name.len() <= LONGEST));
        assert!(all_different(&names));
        let same = unique(vec!["a".to_owned(), "A".to_owned()]);
        assert_eq!(same, ["a~0", "A~1"]);
    }
}
