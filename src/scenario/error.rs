use std::fmt;
use std::io;

use crate::error::SetupError;
use crate::output::XyzError;
use crate::scenario::place::Place;

/// What is wrong with a value of a scenario.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// The text is no TOML or no JSON.
    #[error("{message}")]
    Syntax {
        /// What the parser says.
        message: String,
    },
    /// A value of the wrong kind, a key that does not exist, or one that is
    /// missing.
    #[error("{message}")]
    Schema {
        /// What does not fit.
        message: String,
    },
    /// A value out of its range.
    #[error("is {found}; {allowed}")]
    Value {
        /// What was found.
        found: String,
        /// What is allowed.
        allowed: String,
    },
    /// The grains of the scenario can't be simulated, or can't be made.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// A file of grains that says something wrong.
    #[error(transparent)]
    Xyz(#[from] XyzError),
    /// A `--set` that leads nowhere.
    #[error("{message}")]
    Assignment {
        /// Why.
        message: String,
    },
}

/// A scenario that is refused: where, what was found, and what is allowed.
#[derive(Debug)]
pub struct Refusal {
    /// Where.
    pub place: Box<Place>,
    /// What is wrong.
    pub problem: Box<Problem>,
    /// What may have been meant.
    pub hint: Option<String>,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.place.source)?;
        if let Some(line) = &self.place.line {
            write!(f, ":{}:{}", line.number, line.column)?;
        }
        f.write_str(": ")?;
        match *self.problem {
            Problem::Syntax { .. } => {}
            Problem::Value { .. } => write!(f, "{} ", self.place.path)?,
            _ => write!(f, "{}: ", self.place.path)?,
        }
        write!(f, "{}", self.problem)?;
        if let Some(hint) = &self.hint {
            write!(f, "; {hint}")?;
        }
        if let Some(line) = &self.place.line {
            let number = line.number.to_string();
            let margin = " ".repeat(number.len());
            let text: String = line.text.chars().take(100).collect();
            write!(f, "\n {number} | {text}")?;
            if line.column <= 100 {
                let indent = " ".repeat(line.column - 1);
                write!(f, "\n {margin} | {indent}^")?;
            }
        }
        Ok(())
    }
}

impl std::error::Error for Refusal {}

/// Why there is no scenario.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ScenarioError {
    /// A file could not be read.
    #[error("cannot read {file}: {source}")]
    Unreadable {
        /// Which.
        file: String,
        /// Why.
        source: io::Error,
    },
    /// The scenario is refused.
    #[error(transparent)]
    Refused(#[from] Refusal),
}
