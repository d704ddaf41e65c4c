//! Pages as mdBook reads them.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use pulldown_cmark::{Event, Options, Parser, Tag, TagEnd};

/// A page: its text, what it links to, what can be linked to in it.
pub(crate) struct Page {
    pub(crate) text: String,
    pub(crate) links: BTreeSet<String>,
    pub(crate) anchors: BTreeSet<String>,
}

pub(crate) fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

pub(crate) fn folder() -> PathBuf {
    root().join("book/src")
}

/// All pages of the book, by the names of their files.
pub(crate) fn pages() -> BTreeMap<String, Page> {
    fs::read_dir(folder())
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "md"))
        .map(|path| {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            (name, Page::read(&path))
        })
        .collect()
}

impl Page {
    pub(crate) fn read(path: &Path) -> Page {
        let text = fs::read_to_string(path).unwrap();
        let mut page = Page {
            links: BTreeSet::new(),
            anchors: BTreeSet::new(),
            text,
        };
        let options = Options::ENABLE_TABLES | Options::ENABLE_FOOTNOTES;
        let mut heading: Option<String> = None;
        let mut seen: BTreeMap<String, u32> = BTreeMap::new();
        for event in Parser::new_ext(&page.text, options) {
            match event {
                Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) => {
                    page.links.insert(dest_url.into_string());
                }
                Event::Html(html) | Event::InlineHtml(html) => {
                    page.links.extend(attributes(&html, "src"));
                    page.links.extend(attributes(&html, "href"));
                    page.anchors.extend(attributes(&html, "id"));
                }
                Event::Start(Tag::Heading { .. }) => heading = Some(String::new()),
                Event::Text(words) | Event::Code(words) => {
                    if let Some(heading) = &mut heading {
                        heading.push_str(&words);
                    }
                }
                Event::End(TagEnd::Heading(_)) => {
                    let name = identifier(&heading.take().unwrap_or_default());
                    // The second heading of a name is told from the first by a number.
                    let count = seen.entry(name.clone()).or_default();
                    let unique = if *count == 0 {
                        name
                    } else {
                        format!("{name}-{count}")
                    };
                    *count += 1;
                    page.anchors.insert(unique);
                }
                _ => {}
            }
        }
        page
    }
}

/// The values of an attribute in a piece of HTML.
fn attributes(html: &str, name: &str) -> Vec<String> {
    html.split(&format!(" {name}=\""))
        .skip(1)
        .filter_map(|rest| rest.split_once('"'))
        .map(|(value, _)| value.to_owned())
        .collect()
}

/// What mdBook calls a heading in links.
fn identifier(heading: &str) -> String {
    heading
        .trim()
        .chars()
        .filter_map(|sign| {
            if sign.is_alphanumeric() || sign == '_' || sign == '-' {
                Some(sign.to_lowercase().to_string())
            } else {
                sign.is_whitespace().then(|| "-".to_owned())
            }
        })
        .collect()
}
