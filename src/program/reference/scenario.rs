//! Every key of a scenario, from the JSON Schema.

use serde_json::{Map, Number, Value};

use crate::program::reference::markdown::{anchor, code, line, paragraphs, table};
use crate::scenario::json_schema;

const HEAD: &str = "\
# Scenario reference

<!-- Made by `grainfall reference --out book/src` from the program: change the
descriptions there, not this page. -->

A scenario is a file in TOML or JSON; both have the same keys, and these are all of
them. `grainfall preset NAME` prints one to begin with, `grainfall check FILE` says
whether one can be run, and `grainfall schema` prints what this page is made of, for
editors that complete and check keys.

- The columns say of each key its **type**, its **unit** (see
  [Notation and units](notation.md)), its **default** and which values are
  **allowed**. *Required* keys have none; of one that may be *left out* without a
  value to take its place, the text says what is then.
- Numbers have to be finite. σ₁₂ is the distance of two centres at contact.
- A dot leads into a table and `[]` into an entry of a list. The key
  `grains[].rain.count` is, in TOML, `rain.count` below a line `[[grains]]`, and on the
  command line, counting from 0, `--set grains.1.rain.count=1500`.
- What contradicts itself is refused, too, with the reason: see
  [What is refused](refusals.md).
";

pub(super) fn page() -> String {
    let schema = json_schema();
    let mut writer = Writer {
        definitions: schema["$defs"].clone(),
        page: HEAD.to_owned(),
        kinds: Vec::new(),
    };
    writer.table("", &schema);
    // Those that are the same in several places, once each.
    for name in std::mem::take(&mut writer.kinds) {
        writer.kind(&name);
    }
    writer.page
}

struct Writer {
    definitions: Value,
    page: String,
    /// Definitions that are told at the end, by name.
    kinds: Vec<String>,
}

/// What a schema is, for a reader.
enum Shape {
    /// A value: what kind of one.
    Value(String),
    /// One of some words, with their descriptions.
    Words(Vec<(String, String)>),
    /// A table with keys of its own.
    Table(Value),
    /// A table whose keys follow from one of them, told at the end.
    Kind(String),
    /// A list.
    List(Value),
    /// A word, or a table with one key.
    Choice(Value),
}

impl Writer {
    /// Without references, and without `null`, which stands for a key left out.
    fn resolve(&self, schema: &Value) -> (Value, Option<String>) {
        if let Some(options) = schema["anyOf"].as_array() {
            let some = options.iter().find(|option| option["type"] != "null");
            return self.resolve(some.unwrap_or(&Value::Null));
        }
        match schema["$ref"]
            .as_str()
            .and_then(|path| path.rsplit('/').next())
        {
            Some(name) => (self.definitions[name].clone(), Some(name.to_owned())),
            None => (schema.clone(), None),
        }
    }

    fn shape(&self, schema: &Value) -> Shape {
        let (resolved, name) = self.resolve(schema);
        if let Some(options) = resolved["oneOf"].as_array()
            && resolved["properties"].is_null()
        {
            if options.iter().all(|option| option["const"].is_string()) {
                return Shape::Words(options.iter().map(word).collect());
            }
            if options
                .iter()
                .all(|option| option["properties"]["kind"]["const"].is_string())
            {
                return Shape::Kind(name.unwrap_or_default());
            }
            if options
                .iter()
                .any(|option| option["properties"].is_object())
            {
                return Shape::Choice(resolved);
            }
            let kinds: Vec<String> = options.iter().map(simple).collect();
            return Shape::Value(kinds.join(" or "));
        }
        if resolved["properties"].is_object() {
            return Shape::Table(resolved);
        }
        if is_a(&resolved, "array") && !matches!(self.shape(&resolved["items"]), Shape::Value(_)) {
            return Shape::List(resolved["items"].clone());
        }
        Shape::Value(simple(&resolved))
    }

    /// The keys of a table, and then those of the tables in it.
    fn table(&mut self, path: &str, schema: &Value) {
        let mut rows = Vec::new();
        let mut below = Vec::new();
        let required: Vec<&str> = schema["required"].as_array().map_or(Vec::new(), |keys| {
            keys.iter().filter_map(Value::as_str).collect()
        });
        let Some(properties) = schema["properties"].as_object() else {
            return;
        };
        for (key, property) in properties {
            let full = if path.is_empty() {
                key.clone()
            } else {
                format!("{path}.{key}")
            };
            let shape = self.shape(property);
            let mut what = line(property["description"].as_str().unwrap_or(""));
            let (mut kind, mut unit) = (String::new(), unit(property));
            let mut default = default(property, required.contains(&key.as_str()));
            match &shape {
                Shape::Value(simple) => kind.clone_from(simple),
                Shape::Words(words) => {
                    kind = words
                        .iter()
                        .map(|(word, _)| word.as_str())
                        .collect::<Vec<_>>()
                        .join(", ");
                }
                Shape::Table(_) => kind = section_link("table", &full),
                Shape::List(_) | Shape::Choice(_) => {
                    kind = section_link("list", &format!("{full}[]"));
                }
                Shape::Kind(name) => {
                    kind = section_link("sizes", &name.to_lowercase());
                    if !self.kinds.contains(name) {
                        self.kinds.push(name.clone());
                    }
                }
            }
            if matches!(shape, Shape::Table(_) | Shape::List(_)) {
                unit.clear();
                // Its own keys say theirs.
                if default != "required" {
                    default.clear();
                }
                if what.is_empty() {
                    // The rest stands where its keys do.
                    let resolved = self.resolve(property).0;
                    let about = resolved["description"].as_str().unwrap_or("");
                    what = line(about.split("\n\n").next().unwrap_or(""));
                }
            }
            rows.push(vec![
                code(key),
                kind,
                unit,
                default,
                allowed(property),
                what,
            ]);
            below.push((full, shape));
        }
        let head = ["key", "type", "unit", "default", "allowed", "what it is"];
        self.page.push_str(&format!("\n{}", table(&head, &rows)));
        for (full, shape) in &below {
            if let Shape::Words(words) = shape {
                let of: Vec<String> = words
                    .iter()
                    .map(|(word, what)| format!("- {word}: {what}\n"))
                    .collect();
                self.page
                    .push_str(&format!("\n{} is one of\n\n{}", code(full), of.concat()));
            }
        }
        for (full, shape) in below {
            match shape {
                Shape::Table(inner) => self.section(&full, &inner),
                Shape::List(items) => self.list(&format!("{full}[]"), &items),
                _ => {}
            }
        }
    }

    fn section(&mut self, path: &str, schema: &Value) {
        let about = paragraphs(schema["description"].as_str().unwrap_or(""));
        self.heading(path);
        if !about.is_empty() {
            self.page.push_str(&format!("\n{about}\n"));
        }
        self.table(path, schema);
    }

    fn heading(&mut self, path: &str) {
        let level = 2 + usize::from(path.contains('.'));
        self.page
            .push_str(&format!("\n{} `{path}`\n", "#".repeat(level)));
    }

    /// The entries of a list.
    fn list(&mut self, path: &str, items: &Value) {
        let choice = match self.shape(items) {
            Shape::Table(inner) => return self.section(path, &inner),
            Shape::Choice(choice) => choice,
            _ => return,
        };
        self.heading(path);
        let about = line(choice["description"].as_str().unwrap_or(""));
        self.page.push_str(&format!("\n{about} One of\n\n"));
        let mut below = Vec::new();
        for option in choice["oneOf"].as_array().into_iter().flatten() {
            let what = line(option["description"].as_str().unwrap_or(""));
            let inner = option["properties"]
                .as_object()
                .and_then(|keys| keys.iter().next());
            let name = match inner {
                Some((key, inner)) => {
                    let full = format!("{path}.{key}");
                    let link = section_link(&code(key), &full);
                    below.push((full, inner.clone()));
                    format!("a table {link}")
                }
                None => word(option).0,
            };
            self.page.push_str(&format!("- {name}: {what}\n"));
        }
        for (full, inner) in below {
            self.section(&full, &inner);
        }
    }

    /// A table whose keys follow from its `kind`.
    fn kind(&mut self, name: &str) {
        let schema = self.definitions[name].clone();
        let about = paragraphs(schema["description"].as_str().unwrap_or(""));
        self.page.push_str(&format!("\n## {name}\n\n{about}\n"));
        for option in schema["oneOf"].as_array().into_iter().flatten() {
            let what = line(option["description"].as_str().unwrap_or(""));
            let kind = option["properties"]["kind"]["const"].as_str().unwrap_or("");
            let mut keys = option.clone();
            if let Some(properties) = keys["properties"].as_object_mut() {
                properties.remove("kind");
            }
            self.page
                .push_str(&format!("\n`kind = \"{kind}\"`: {what}\n"));
            self.table("", &keys);
        }
    }
}

fn section_link(text: &str, heading: &str) -> String {
    format!("[{text}](#{})", anchor(heading))
}

fn word(option: &Value) -> (String, String) {
    let what = line(option["description"].as_str().unwrap_or(""));
    (
        format!("`\"{}\"`", option["const"].as_str().unwrap_or("")),
        what,
    )
}

fn is_a(schema: &Value, kind: &str) -> bool {
    match &schema["type"] {
        Value::Array(kinds) => kinds.iter().any(|one| one == kind),
        one => one == kind,
    }
}

/// A value without parts, in words.
fn simple(schema: &Value) -> String {
    if let Some(constant) = schema["const"].as_str() {
        return format!("`\"{constant}\"`");
    }
    if let Some(values) = schema["enum"].as_array() {
        let values: Vec<String> = values.iter().map(ToString::to_string).collect();
        return values.join(" or ");
    }
    for (kind, name) in [
        ("number", "number"),
        ("integer", "whole number"),
        ("boolean", "true or false"),
        ("string", "text"),
        ("array", "list of numbers"),
        ("object", "table"),
    ] {
        if is_a(schema, kind) {
            return name.to_owned();
        }
    }
    "anything".to_owned()
}

fn unit(schema: &Value) -> String {
    schema["x-unit"].as_str().unwrap_or("").to_owned()
}

fn default(schema: &Value, required: bool) -> String {
    if required {
        return "required".to_owned();
    }
    match &schema["default"] {
        Value::Null => "left out".to_owned(),
        Value::Number(number) => tell(number),
        Value::Object(keys) => code(&inline_table(keys)),
        other => code(&other.to_string()),
    }
}

/// A table as TOML has it in one line.
fn inline_table(keys: &Map<String, Value>) -> String {
    let keys: Vec<String> = keys
        .iter()
        .map(|(key, value)| format!("{key} = {value}"))
        .collect();
    format!("{{ {} }}", keys.join(", "))
}

/// Which numbers are allowed.
fn allowed(schema: &Value) -> String {
    let bound = |key: &str| schema[key].as_number().map(tell);
    let least = bound("minimum").map(|least| format!("≥ {least}"));
    let above = bound("exclusiveMinimum").map(|above| format!("> {above}"));
    let most = bound("maximum").map(|most| format!("≤ {most}"));
    let below = bound("exclusiveMaximum").map(|below| format!("< {below}"));
    if let (Some(least), Some(most)) = (bound("minimum"), bound("maximum")) {
        return format!("{least} … {most}");
    }
    let bounds: Vec<String> = [above, least, below, most].into_iter().flatten().collect();
    bounds.join(", ")
}

/// A number, as short as it can be written.
fn tell(number: &Number) -> String {
    match (number.as_i64(), number.as_f64()) {
        (Some(whole), _) => whole.to_string(),
        (None, Some(0.0)) => "0".to_owned(),
        (None, Some(value)) if !(1.0e-3..1.0e6).contains(&value.abs()) => format!("{value:e}"),
        (None, Some(value)) => value.to_string(),
        (None, None) => number.to_string(),
    }
}
