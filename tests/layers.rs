//! Imports point one way: the room for each thing stays where the architecture
//! page says it is.

use std::fs;
use std::path::{Path, PathBuf};

/// For each folder of `src` the crate's modules that its files may import.
const ALLOWED: &[(&str, &[&str])] = &[
    ("particle", &[]),
    ("time", &[]),
    ("error", &["particle"]),
    ("model", BASE),
    ("dynamics", BASE),
    ("predict", BASE),
    ("collide", BASE),
    ("policy", BASE),
    ("boundary", BASE),
    ("observe", BASE),
    ("engine", BASE),
    ("analysis", BASE),
];

/// The first rank: what everybody may know.
const BASE: &[&str] = &["particle", "time", "error", "model"];

fn sources(path: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(path).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// The part of a file in front of its tests.
fn code(path: &Path) -> String {
    let text = fs::read_to_string(path).unwrap();
    text.split("#[cfg(test)]").next().unwrap().to_owned()
}

#[test]
fn imports_point_one_way() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&root, &mut files);
    assert!(files.len() > 50, "the sources are not where they were");
    let mut wrong = Vec::new();
    for file in files {
        let inside = file.strip_prefix(&root).unwrap();
        // The audit is a test: it puts whole models together.
        // So do tests with a file of their own.
        if inside.starts_with("engine/audit")
            || inside.ends_with("engine/audit.rs")
            || inside.ends_with("tests.rs")
        {
            continue;
        }
        let first = inside.components().next().unwrap();
        let room = Path::new(first.as_os_str())
            .file_stem()
            .unwrap()
            .to_string_lossy()
            .into_owned();
        let Some((_, allowed)) = ALLOWED.iter().find(|(name, _)| *name == room) else {
            continue;
        };
        for line in code(&file)
            .lines()
            .filter(|line| !line.trim().starts_with("//"))
        {
            for import in line.split("crate::").skip(1) {
                let name: String = import
                    .chars()
                    .take_while(|c| c.is_alphanumeric() || *c == '_')
                    .collect();
                let is_module = name.starts_with(|c: char| c.is_lowercase());
                if is_module && name != room && !allowed.contains(&name.as_str()) {
                    wrong.push(format!("{}: {}", inside.display(), line.trim()));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
