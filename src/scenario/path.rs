use std::fmt;
use std::str::FromStr;

/// One step of a [`Path`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Segment {
    /// Into a table, by name.
    Key(String),
    /// Into a list, counted from 0.
    Index(usize),
}

/// Where a value stands in a scenario, such as `grains[1].rain.count`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Path(Vec<Segment>);

impl Path {
    /// The whole scenario.
    #[must_use]
    pub fn root() -> Self {
        Path::default()
    }

    /// One step into a table.
    #[must_use]
    pub fn key(mut self, name: &str) -> Self {
        self.0.push(Segment::Key(name.to_owned()));
        self
    }

    /// One step into a list.
    #[must_use]
    pub fn index(mut self, index: usize) -> Self {
        self.0.push(Segment::Index(index));
        self
    }

    /// One step further.
    #[must_use]
    pub fn join(mut self, segment: &Segment) -> Self {
        self.0.push(segment.clone());
        self
    }

    /// The steps, from the outside in.
    #[must_use]
    pub fn segments(&self) -> &[Segment] {
        &self.0
    }

    /// The same without the last step.
    #[must_use]
    pub fn parent(&self) -> Self {
        Path(self.0[..self.0.len().saturating_sub(1)].to_vec())
    }

    /// True if this is `other` or something inside it.
    #[must_use]
    pub fn is_within(&self, other: &Path) -> bool {
        self.0.len() >= other.0.len() && self.0.iter().zip(&other.0).all(|(a, b)| a == b)
    }
}

impl From<&serde_path_to_error::Path> for Path {
    fn from(path: &serde_path_to_error::Path) -> Self {
        use serde_path_to_error::Segment as Step;
        Path(
            path.iter()
                .filter_map(|step| match step {
                    Step::Seq { index } => Some(Segment::Index(*index)),
                    Step::Map { key } => Some(Segment::Key(key.clone())),
                    Step::Enum { variant } => Some(Segment::Key(variant.clone())),
                    Step::Unknown => None,
                })
                .collect(),
        )
    }
}

impl fmt::Display for Segment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Segment::Key(key) => f.write_str(key),
            Segment::Index(index) => write!(f, "{index}"),
        }
    }
}

impl fmt::Display for Path {
    /// Keys are cut after 60 letters.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() {
            return f.write_str("the scenario");
        }
        for (place, segment) in self.0.iter().enumerate() {
            match segment {
                Segment::Index(index) => write!(f, "[{index}]")?,
                Segment::Key(key) if place == 0 => write!(f, "{key:.60}")?,
                Segment::Key(key) => write!(f, ".{key:.60}")?,
            }
        }
        Ok(())
    }
}

/// A text that is no path.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no path: one such as `parameters.sleep_speed` or `grains[1].rain.count` is")]
pub struct ParsePathError(String);

impl FromStr for Path {
    type Err = ParsePathError;

    /// Reads `a.b[1].c`; indices may also be written `a.b.1.c`.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let wrong = || ParsePathError(text.to_owned());
        let mut path = Path::root();
        for part in text.split('.') {
            let (name, mut rest) = match part.find('[') {
                Some(at) => part.split_at(at),
                None => (part, ""),
            };
            let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
            if name.is_empty() || !name.chars().all(plain) {
                return Err(wrong());
            }
            path = match name.parse() {
                Ok(index) if !path.0.is_empty() => path.index(index),
                _ => path.key(name),
            };
            while let Some(inside) = rest.strip_prefix('[') {
                let (digits, after) = inside.split_once(']').ok_or_else(wrong)?;
                path = path.index(digits.parse().map_err(|_| wrong())?);
                rest = after;
            }
            if !rest.is_empty() {
                return Err(wrong());
            }
        }
        Ok(path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_come_back() {
        for text in ["seed", "parameters.sleep_speed", "grains[1].rain.count"] {
            assert_eq!(text.parse::<Path>().unwrap().to_string(), text);
        }
        let dotted: Path = "grains.1.rain.count".parse().unwrap();
        assert_eq!(dotted.to_string(), "grains[1].rain.count");
    }

    #[test]
    fn what_is_no_path_is_refused() {
        for text in ["", ".", "a..b", "a[", "a[x]", "a[1]b", "a b"] {
            assert!(text.parse::<Path>().is_err(), "{text}");
        }
    }

    #[test]
    fn inside_is_inside() {
        let outer: Path = "grains[1]".parse().unwrap();
        let inner: Path = "grains[1].rain.count".parse().unwrap();
        assert!(inner.is_within(&outer) && !outer.is_within(&inner));
        assert!(!inner.is_within(&"grains[0]".parse().unwrap()));
    }
}
