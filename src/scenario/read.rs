use std::fs::File;
use std::io::{self, Read};
use std::path::{Path as FilePath, PathBuf};

use toml::{Table, Value};

use crate::error::SetupError;
use crate::scenario::criteria::{KnownCriterion, built_in_criteria, resolve};
use crate::scenario::error::{Problem, Refusal, ScenarioError};
use crate::scenario::parts::{KnownParts, resolve_parts};
use crate::scenario::path::Path;
use crate::scenario::place::{Line, Place, locate};
use crate::scenario::schema::Scenario;
use crate::scenario::set::Assignment;
use crate::scenario::suggest::nearest;
use crate::scenario::tree::{Tree, not_finite};
use crate::scenario::validate::validate;

/// The largest scenario file that is read, in bytes.
const LARGEST: u64 = 1 << 24;

/// How a scenario is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// TOML.
    Toml,
    /// JSON.
    Json,
}

/// A scenario as text, and where the text came from.
#[derive(Clone, Debug)]
pub struct Origin {
    /// What messages call it.
    pub name: String,
    /// The text.
    pub text: String,
    /// How it is written.
    pub format: Format,
    /// The folder from which the files it names are sought.
    pub folder: PathBuf,
    /// Values that replace those of the text.
    pub assignments: Vec<Assignment>,
    /// The sleep criteria that it may name.
    pub criteria: Vec<KnownCriterion>,
    /// The parts of one's own that it may have parameters of.
    pub parts: Option<KnownParts>,
}

impl Origin {
    /// A text in TOML that names no files.
    #[must_use]
    pub fn toml(name: &str, text: &str) -> Self {
        Origin {
            name: name.to_owned(),
            text: text.to_owned(),
            format: Format::Toml,
            folder: PathBuf::new(),
            assignments: Vec::new(),
            criteria: built_in_criteria().to_vec(),
            parts: None,
        }
    }

    /// The text of a file: JSON if its name ends in `.json`, else TOML.
    ///
    /// # Errors
    ///
    /// When the file cannot be read, is larger than 16 MB, or is not UTF-8.
    pub fn open(file: &FilePath) -> Result<Self, ScenarioError> {
        let unreadable = |source| ScenarioError::Unreadable {
            file: file.display().to_string(),
            source,
        };
        let mut bytes = Vec::new();
        File::open(file)
            .and_then(|opened| opened.take(LARGEST + 1).read_to_end(&mut bytes))
            .map_err(unreadable)?;
        if bytes.len() as u64 > LARGEST {
            return Err(unreadable(io::Error::other("more than 16 MB")));
        }
        let text = String::from_utf8(bytes).map_err(|error| {
            let good = error.utf8_error().valid_up_to();
            let before = String::from_utf8_lossy(&error.as_bytes()[..good]).into_owned();
            let line = Line::at(&before, good);
            let message =
                format!("not text: byte {good} is not UTF-8, which is the only encoding allowed");
            Origin::toml(&file.display().to_string(), "").refuse_text(message, Some(line))
        })?;
        let is_json = file.extension().is_some_and(|end| end == "json");
        Ok(Origin {
            name: file.display().to_string(),
            text,
            format: if is_json { Format::Json } else { Format::Toml },
            folder: file.parent().map(FilePath::to_path_buf).unwrap_or_default(),
            assignments: Vec::new(),
            criteria: built_in_criteria().to_vec(),
            parts: None,
        })
    }

    /// A refusal of what stands at `path`.
    #[must_use]
    pub fn refuse(&self, path: Path, problem: impl Into<Problem>) -> Refusal {
        self.refuse_at(path, problem.into(), false)
    }

    /// A refusal of what stands at `path` for what its own check says: at the parameter
    /// that is out of its range, where it is one.
    pub(super) fn refuse_part(&self, path: Path, error: SetupError) -> Refusal {
        match error {
            SetupError::Parameter {
                field,
                value,
                allowed,
            } => {
                let problem = Problem::Value {
                    found: value.to_string(),
                    allowed: allowed.to_owned(),
                };
                self.refuse(path.key(field), problem)
            }
            other => self.refuse(path, other),
        }
    }

    fn refuse_at(&self, path: Path, problem: Problem, at_key: bool) -> Refusal {
        let set = self
            .assignments
            .iter()
            .rev()
            // A key that does not exist may have been made on the way.
            .find(|set| path.is_within(&set.path) || at_key && set.path.is_within(&path));
        let (source, line) = match set {
            Some(set) => (set.text.clone(), None),
            None => {
                let span = match self.format {
                    Format::Toml => locate(&self.text, &path, at_key),
                    Format::Json => None,
                };
                let line = span.map(|span| Line::at(&self.text, span.start));
                (self.name.clone(), line)
            }
        };
        Refusal {
            place: Box::new(Place { source, path, line }),
            problem: Box::new(problem),
            hint: None,
        }
    }

    /// A refusal of the text itself.
    fn refuse_text(&self, message: String, line: Option<Line>) -> Refusal {
        Refusal {
            place: Box::new(Place {
                source: self.name.clone(),
                path: Path::root(),
                line,
            }),
            problem: Box::new(Problem::Syntax { message }),
            hint: None,
        }
    }

    /// The text as a tree, with the assignments in it.
    pub(crate) fn tree(&self) -> Result<Table, Refusal> {
        let mut table = match self.format {
            Format::Toml => toml::from_str::<Table>(&self.text).map_err(|error| {
                let line = error.span().map(|span| Line::at(&self.text, span.start));
                self.refuse_text(format!("not TOML: {}", error.message()), line)
            })?,
            Format::Json => {
                let tree: Tree = serde_json::from_str(&self.text).map_err(|error| {
                    // At the end of the text the line may be one that is not there.
                    let mut lines = self.text.lines();
                    let line = lines.nth(error.line().saturating_sub(1)).or(Some(""));
                    let line = line.map(|text| Line {
                        number: error.line(),
                        column: error.column().max(1),
                        text: text.to_owned(),
                    });
                    let message = error.to_string();
                    let message = message
                        .rsplit_once(" at line ")
                        .map_or(message.as_str(), |(said, _)| said);
                    self.refuse_text(format!("not JSON for a scenario: {message}"), line)
                })?;
                match tree.0 {
                    Some(Value::Table(table)) => table,
                    _ => {
                        let message = "not a JSON object; only one is allowed: { … }".to_owned();
                        return Err(self.refuse_text(message, Some(Line::at(&self.text, 0))));
                    }
                }
            }
        };
        for set in &self.assignments {
            set.apply(&mut table).map_err(|message| {
                self.refuse(set.path.clone(), Problem::Assignment { message })
            })?;
        }
        Ok(table)
    }
}

/// Reads a scenario file, with `assignments` in place of what it says.
///
/// # Errors
///
/// When the file cannot be read, or the scenario is refused.
pub fn read(
    file: &FilePath,
    assignments: Vec<Assignment>,
) -> Result<(Origin, Scenario), ScenarioError> {
    let mut origin = Origin::open(file)?;
    origin.assignments = assignments;
    let scenario = read_text(&origin)?;
    Ok((origin, scenario))
}

/// Reads a scenario from a text, checks every number in it, and resolves what
/// was left out. The grains themselves are checked by
/// [`Start::new`](crate::scenario::Start::new).
///
/// # Errors
///
/// Says where and what when the scenario is refused.
pub fn read_text(origin: &Origin) -> Result<Scenario, Refusal> {
    let tree = Value::Table(origin.tree()?);
    if let Some((path, number)) = not_finite(&tree, &Path::root()) {
        let hint = path
            .to_string()
            .ends_with("wake_speed")
            .then(|| "write \"never\" to switch waking off".to_owned());
        let problem = Problem::Value {
            found: number.to_string(),
            allowed: "a finite number is allowed".to_owned(),
        };
        return Err(Refusal {
            hint,
            ..origin.refuse(path, problem)
        });
    }
    let mut scenario: Scenario = serde_path_to_error::deserialize(tree).map_err(|error| {
        let path = Path::from(error.path());
        misfit(origin, path, error.into_inner().message())
    })?;
    validate(origin, &scenario)?;
    resolve(origin, &mut scenario)?;
    resolve_parts(origin, &mut scenario)?;
    scenario.resolve();
    Ok(scenario)
}

/// The longest message that is passed on, in characters.
const LONGEST_MESSAGE: usize = 600;

/// A message without its middle if it is long: what was found stands at its
/// beginning, what is allowed at its end.
fn shortened(message: &str) -> String {
    let letters: Vec<char> = message.chars().collect();
    if letters.len() <= LONGEST_MESSAGE {
        return message.to_owned();
    }
    let (head, tail) = (LONGEST_MESSAGE / 3, 2 * LONGEST_MESSAGE / 3);
    let head: String = letters[..head].iter().collect();
    let tail: String = letters[letters.len() - tail..].iter().collect();
    format!("{head} … {tail}")
}

/// Turns what serde says into a refusal that says what to write instead.
pub(super) fn misfit(origin: &Origin, path: Path, message: &str) -> Refusal {
    let quoted: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    let unknown = message.starts_with("unknown field") || message.starts_with("unknown variant");
    let hint = quoted
        .split_first()
        .filter(|_| unknown)
        .and_then(|(wrong, names)| nearest(wrong, names.iter().copied()))
        .map(|name| format!("did you mean `{name}`?"));
    let message = message
        .replace("expected f64", "expected a number")
        .replace("expected floating point number", "expected a number")
        .replace("expected u64", "expected a whole number, 0 or more")
        .replace("expected usize", "expected a whole number, 0 or more")
        .replace("expected u32", "expected a whole number, 0 or more")
        .replace("expected i64", "expected a whole number")
        .replace("unknown field", "unknown key")
        .replace("missing field", "missing key")
        .replace("unknown variant", "unknown choice")
        .replace(
            "unit variant, expected struct variant",
            "a bare name, expected a table: { name = { … } }",
        );
    let at_key = message.starts_with("unknown key");
    let message = shortened(&message);
    Refusal {
        hint,
        ..origin.refuse_at(path, Problem::Schema { message }, at_key)
    }
}
