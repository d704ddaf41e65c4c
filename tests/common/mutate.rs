//! Mutations of trees, lines and bytes: what a reader has to withstand.
//!
//! Deterministic: everything follows from the generator.

// Not every test program uses all of it.
#![allow(dead_code)]

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use toml::Value;

/// Numbers at the edges of what is allowed, or far beyond.
const NUMBERS: [f64; 24] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    2.0,
    3.0,
    1.0e-9,
    1.0e-300,
    5.0e-324,
    -5.0e-324,
    1.0e9,
    1.0e12,
    1.0e18,
    1.0e19,
    1.0e300,
    f64::MAX,
    f64::MIN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::NAN,
    0.999_999_999_999_999_9,
    1.000_000_000_000_000_2,
    1.0e7,
];
const WHOLE: [i64; 12] = [
    0,
    1,
    2,
    3,
    4,
    -1,
    200,
    10_000_000,
    10_000_001,
    1_000_000_000_000,
    i64::MAX,
    i64::MIN,
];
const WORDS: [&str; 14] = [
    "",
    "never",
    "none",
    "open",
    "off",
    "normal",
    "frozen",
    "falling",
    "fixed",
    "\u{0}",
    "🪨🪨",
    "\u{202e}naïve",
    "..",
    "1e3",
];

fn pick<T: Copy>(rng: &mut ChaCha8Rng, from: &[T]) -> T {
    from[rng.random_range(0..from.len())]
}

/// A word that is longer than anybody expects, or of the list.
fn word(rng: &mut ChaCha8Rng) -> String {
    if rng.random_range(0..12) == 0 {
        pick(rng, &["x", "é", "[", "\\", "9"]).repeat(rng.random_range(1..5000))
    } else {
        pick(rng, &WORDS).to_owned()
    }
}

/// A value of any kind.
fn value(rng: &mut ChaCha8Rng) -> Value {
    match rng.random_range(0..10) {
        0..=2 => Value::Float(pick(rng, &NUMBERS)),
        3..=5 => Value::Integer(pick(rng, &WHOLE)),
        6 => Value::String(word(rng)),
        7 => Value::Boolean(rng.random()),
        8 => {
            let depth = if rng.random_range(0..20) == 0 { 300 } else { 2 };
            (0..rng.random_range(0..depth)).fold(Value::Array(Vec::new()), |inner, _| {
                Value::Array(vec![inner])
            })
        }
        _ => Value::Table([(word(rng), Value::Boolean(true))].into_iter().collect()),
    }
}

/// Another number of the same kind, mostly not far away.
fn nudged(rng: &mut ChaCha8Rng, old: &Value) -> Value {
    match old {
        Value::Float(x) => Value::Float(match rng.random_range(0..8) {
            0 => -x,
            1 => x * 1.0e3,
            2 => x * 1.0e-3,
            3 => pick(rng, &NUMBERS),
            _ => x * (0.25 + 2.0 * rng.random::<f64>()),
        }),
        Value::Integer(n) => match rng.random_range(0..6) {
            0 => Value::Integer(pick(rng, &WHOLE)),
            1 => Value::Float(*n as f64),
            2 => Value::Integer(n.wrapping_neg()),
            _ => Value::Integer(n.wrapping_add(rng.random_range(-3..4))),
        },
        Value::Boolean(yes) => Value::Boolean(!yes),
        other => {
            if rng.random_range(0..3) == 0 {
                value(rng)
            } else {
                other.clone()
            }
        }
    }
}

/// How many places there are in a tree, this one included.
fn places(tree: &Value) -> usize {
    1 + match tree {
        Value::Array(list) => list.iter().map(places).sum(),
        Value::Table(table) => table.iter().map(|(_, inner)| places(inner)).sum(),
        _ => 0,
    }
}

/// Changes a tree at one place.
pub(crate) fn mutate_tree(tree: &mut Value, rng: &mut ChaCha8Rng) {
    let mut at = rng.random_range(0..places(tree));
    change(tree, &mut at, rng);
}

/// Counts down to the place and changes what stands there; true when done.
fn change(tree: &mut Value, at: &mut usize, rng: &mut ChaCha8Rng) -> bool {
    if *at == 0 {
        change_here(tree, rng);
        return true;
    }
    *at -= 1;
    match tree {
        Value::Array(list) => list.iter_mut().any(|inner| change(inner, at, rng)),
        Value::Table(table) => table.iter_mut().any(|(_, inner)| change(inner, at, rng)),
        _ => false,
    }
}

fn change_here(tree: &mut Value, rng: &mut ChaCha8Rng) {
    match tree {
        Value::Table(table) if rng.random_range(0..5) > 0 && !table.is_empty() => {
            let names: Vec<String> = table.keys().cloned().collect();
            let name = names[rng.random_range(0..names.len())].clone();
            match rng.random_range(0..5) {
                0 => {
                    table.remove(&name);
                }
                1 => {
                    let inner = table.remove(&name).expect("a key of it");
                    table.insert(format!("{name}{}", pick(rng, &["s", "_", " ", "é"])), inner);
                }
                2 => {
                    table.insert(word(rng), value(rng));
                }
                3 => {
                    // Another key's value.
                    let from = names[rng.random_range(0..names.len())].clone();
                    let inner = table[&from].clone();
                    table.insert(name, inner);
                }
                _ => {
                    table.insert(name, value(rng));
                }
            }
        }
        Value::Array(list) if rng.random_range(0..5) > 0 && !list.is_empty() => {
            let index = rng.random_range(0..list.len());
            match rng.random_range(0..4) {
                0 => {
                    list.remove(index);
                }
                1 => {
                    let again = list[index].clone();
                    list.push(again);
                }
                2 => list.reverse(),
                _ => list[index] = value(rng),
            }
        }
        Value::Table(_) | Value::Array(_) => *tree = value(rng),
        leaf if rng.random_range(0..4) > 0 => *leaf = nudged(rng, leaf),
        leaf => *leaf = value(rng),
    }
}

/// Changes words and lines of a text that is made of them.
pub(crate) fn mutate_lines(text: &str, rng: &mut ChaCha8Rng) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    for _ in 0..rng.random_range(1..3) {
        if lines.is_empty() {
            break;
        }
        let index = rng.random_range(0..lines.len());
        match rng.random_range(0..30) {
            0 => {
                lines.remove(index);
            }
            1 => lines.insert(index, lines[index].clone()),
            2 => lines.truncate(index),
            _ => {
                let mut words: Vec<String> = lines[index].split(' ').map(str::to_owned).collect();
                let place = rng.random_range(0..words.len());
                match rng.random_range(0..16) {
                    0 => {
                        words.remove(place);
                    }
                    1 => words.insert(place, word(rng)),
                    2 => words[place] = word(rng),
                    3 => words[place] = pick(rng, &WHOLE).to_string(),
                    4 => {
                        let key = words[place].split_once('=').map(|(key, _)| key.to_owned());
                        let new = format!("{:?}", pick(rng, &NUMBERS));
                        words[place] = key.map_or(new.clone(), |key| format!("{key}={new}"));
                    }
                    5 => words[place] = words[place].replace(['3', '1'], "7"),
                    6 => words[place] = format!("{:?}", pick(rng, &NUMBERS)),
                    // A number like it.
                    _ => {
                        if let Ok(x) = words[place].parse::<f64>() {
                            let near = (x + 0.1) * (0.5 + rng.random::<f64>());
                            if x.fract() != 0.0 || rng.random_range(0..4) == 0 {
                                words[place] = format!("{near:?}");
                            }
                        }
                    }
                }
                lines[index] = words.join(" ");
            }
        }
    }
    lines.join("\n") + "\n"
}

/// Flips, cuts, repeats and inserts bytes; what any reader of bytes may be
/// pointed at, whatever they mean.
pub(crate) fn mutate_bytes(bytes: &mut Vec<u8>, rng: &mut ChaCha8Rng) {
    for _ in 0..rng.random_range(1..5) {
        let length = bytes.len();
        if length == 0 {
            bytes.push(rng.random());
            continue;
        }
        let at = rng.random_range(0..length);
        let end = (at + rng.random_range(1..64)).min(length);
        match rng.random_range(0..7) {
            0 => bytes[at] ^= 1 << rng.random_range(0..8),
            1 => bytes[at] = pick(rng, &[0, 0xff, 0x80, b'\n', b'"', b'=', b'[', b'}']),
            2 => bytes.truncate(at),
            3 => {
                bytes.drain(at..end);
            }
            4 => {
                let piece = bytes[at..end].to_vec();
                let to = rng.random_range(0..length);
                bytes.splice(to..to, piece);
            }
            5 => bytes[at..end].fill(0),
            _ => {
                let number: u64 = pick(rng, &[0, 1, u64::MAX, 1 << 32, 1 << 62]);
                for (byte, new) in bytes[at..].iter_mut().zip(number.to_le_bytes()) {
                    *byte = new;
                }
            }
        }
    }
}
