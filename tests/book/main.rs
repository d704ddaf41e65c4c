//! The book: its links lead somewhere, what it cites is in the bibliography, and
//! its reference says what the program says.

mod pages;

#[cfg(feature = "program")]
mod reference;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use pages::{Page, folder, pages, root};

/// The largest figure that the book may hold, in bytes: a drum of thousands of grains.
const LARGEST_FIGURE: u64 = 640_000;

fn all() -> BTreeMap<String, Page> {
    let all = pages();
    assert!(all.len() > 20, "the book has {} pages", all.len());
    all
}

/// What is wrong with a link, if it is.
fn flaw(from: &str, link: &str, pages: &BTreeMap<String, Page>) -> Option<String> {
    if link.contains("://") || link.starts_with("//") || link.starts_with("mailto:") {
        return Some("leads out of the book".to_owned());
    }
    let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
    let file = if file.is_empty() { from } else { file };
    let Some(page) = pages.get(file) else {
        let there = folder().join(file).exists() && !file.ends_with(".md");
        return (!there).then(|| "there is no such file".to_owned());
    };
    let found = anchor.is_empty() || page.anchors.contains(anchor);
    (!found).then(|| format!("{file} has no heading or anchor `{anchor}`"))
}

#[test]
fn links_lead_somewhere() {
    let pages = all();
    let mut flaws = Vec::new();
    let mut count = 0;
    for (name, page) in &pages {
        for link in &page.links {
            count += 1;
            if let Some(flaw) = flaw(name, link, &pages) {
                flaws.push(format!("{name}: {link}: {flaw}"));
            }
        }
    }
    assert!(flaws.is_empty(), "\n{}", flaws.join("\n"));
    assert!(count > 150, "{count} links are looked at");
}

/// A test of the test: what is wrong is found.
#[test]
fn links_that_lead_nowhere_are_found() {
    let pages = all();
    for (link, wrong) in [
        ("model.md", false),
        ("model.md#guards", false),
        ("#waking", false),
        ("figures/deposition.svg", false),
        ("modell.md", true),
        ("model.md#gards", true),
        ("#wakening", true),
        ("figures/nothing.svg", true),
        ("https://example.org", true),
    ] {
        assert_eq!(flaw("model.md", link, &pages).is_some(), wrong, "{link}");
    }
}

/// The README is read outside of the book: its links count from the repository.
#[test]
fn links_of_the_readme_lead_somewhere() {
    let pages = all();
    let readme = Page::read(&root().join("README.md"));
    for link in &readme.links {
        let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
        assert!(root().join(file).exists(), "{link}");
        if let Some(page) = file
            .strip_prefix("book/src/")
            .and_then(|name| pages.get(name))
        {
            assert!(anchor.is_empty() || page.anchors.contains(anchor), "{link}");
        }
    }
}

#[test]
fn every_page_is_in_the_table_of_contents() {
    let pages = all();
    let told: BTreeSet<&str> = pages["SUMMARY.md"]
        .links
        .iter()
        .map(String::as_str)
        .collect();
    for name in pages.keys().filter(|name| *name != "SUMMARY.md") {
        assert!(told.contains(name.as_str()), "{name} is not in SUMMARY.md");
    }
}

#[test]
fn every_figure_is_shown_and_small() {
    let pages = all();
    let shown: BTreeSet<&str> = pages
        .values()
        .flat_map(|page| &page.links)
        .map(String::as_str)
        .collect();
    for figure in fs::read_dir(folder().join("figures")).unwrap() {
        let figure = figure.unwrap();
        let name = format!("figures/{}", figure.file_name().to_string_lossy());
        assert!(shown.contains(name.as_str()), "no page shows {name}");
        let size = figure.metadata().unwrap().len();
        assert!(size <= LARGEST_FIGURE, "{name} has {size} bytes");
    }
}

/// DOIs in a text, without what ends the sentence.
fn dois(text: &str) -> BTreeSet<String> {
    text.match_indices("doi:10.")
        .map(|(at, _)| {
            let rest = &text[at + 4..];
            let end = rest.find(|c: char| c.is_whitespace() || ",;)\"`<|".contains(c));
            rest[..end.unwrap_or(rest.len())]
                .trim_end_matches(['.', ':'])
                .to_owned()
        })
        .collect()
}

#[test]
fn dois_end_where_they_end() {
    let found = dois("(A 1, doi:10.1/a-b_c). B, doi:10.2/X.Y: C doi:10.3/z; doi:10.4/w.\n");
    assert_eq!(
        found,
        ["10.1/a-b_c", "10.2/X.Y", "10.3/z", "10.4/w"]
            .map(String::from)
            .into()
    );
}

/// Rust files below a folder.
fn sources(folder: &Path, found: &mut Vec<String>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(fs::read_to_string(&path).unwrap());
        }
    }
}

#[test]
fn whatever_is_cited_is_in_the_bibliography() {
    let pages = all();
    let known = dois(&pages["bibliography.md"].text);
    let mut texts: Vec<String> = pages.values().map(|page| page.text.clone()).collect();
    sources(&root().join("src"), &mut texts);
    for doi in texts.iter().flat_map(|text| dois(text)) {
        assert!(known.contains(&doi), "doi:{doi} is not in bibliography.md");
    }
}

#[test]
fn whatever_is_in_the_bibliography_is_cited_and_has_a_doi_or_is_a_book() {
    let pages = all();
    let bibliography = &pages["bibliography.md"];
    let mut keys = 0;
    for entry in bibliography.text.split("\n- <a id=\"").skip(1) {
        let (key, entry) = entry.split_once('"').unwrap();
        keys += 1;
        let entry = entry.split("\n\n").next().unwrap();
        let without = entry.contains("no DOI is known here");
        assert!(without != entry.contains("doi:10."), "{key}: {entry}");
        let link = format!("bibliography.md#{key}");
        let cited = pages.values().any(|page| page.links.contains(&link));
        assert!(cited, "no page cites {key}: [Names Year]({link})");
    }
    assert!(keys > 30, "{keys} entries");
}
