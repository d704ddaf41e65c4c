use std::io::{BufRead, Read};

use crate::output::xyz::{Frame, XyzError};
use crate::particle::{Mode, Particle, Vector};
use crate::time::Time;

/// The longest line that is read, in bytes.
const LONGEST_LINE: u64 = 1 << 16;
/// What is quoted of a file in a message, in characters.
const LONGEST_QUOTE: usize = 60;
/// The greatest number of columns.
const MOST_COLUMNS: usize = 1000;
/// The greatest number of grains that is read.
const MOST_GRAINS: usize = 10_000_000;

/// Reads the frames of an extended XYZ file, one by one.
///
/// Only positions have to be there (`pos`, or a plain XYZ file); `velo`,
/// `radius` or `diameter`, `mass`, `id` and, for the modes, `type` (in words) or
/// `mode` are used if they are, other columns are passed over. Grains with an `id`
/// are sorted by it.
#[derive(Debug)]
pub struct XyzReader<R> {
    input: R,
    line: usize,
    buffer: String,
}

/// What a column holds.
#[derive(Clone, Copy, PartialEq)]
enum Column {
    Id,
    Position(usize),
    Velocity(usize),
    Radius,
    Diameter,
    Mass,
    Mode,
    /// A mode, if it names one.
    Type,
    Other,
}

/// What the second line of a frame says.
struct Header {
    columns: Vec<Column>,
    dimension: usize,
    time: Time,
    origin: [f64; 3],
    lengths: [f64; 3],
    periodic: [bool; 3],
}

impl<R: BufRead> XyzReader<R> {
    /// A reader at the start of a file.
    pub fn new(input: R) -> Self {
        XyzReader {
            input,
            line: 0,
            buffer: String::new(),
        }
    }

    /// The last frame.
    ///
    /// # Errors
    ///
    /// When anything in the file is wrong, or nothing is in it.
    pub fn last_frame(self) -> Result<Frame, XyzError> {
        let mut last = None;
        for frame in self {
            last = Some(frame?);
        }
        last.ok_or(XyzError::Empty)
    }

    /// The frame nearest in time to `time`, in √(d/g); the earlier of two.
    ///
    /// # Errors
    ///
    /// When anything in the file is wrong, or nothing is in it.
    pub fn frame_near(self, time: f64) -> Result<Frame, XyzError> {
        let mut nearest: Option<Frame> = None;
        for frame in self {
            let frame = frame?;
            let off = |frame: &Frame| (frame.time.units() - time).abs();
            if nearest.as_ref().is_none_or(|best| off(&frame) < off(best)) {
                nearest = Some(frame);
            }
        }
        nearest.ok_or(XyzError::Empty)
    }

    /// Reads one line into the buffer; false at the end of the file.
    fn next_line(&mut self) -> Result<bool, XyzError> {
        self.buffer.clear();
        let mut bytes = std::mem::take(&mut self.buffer).into_bytes();
        let read = (&mut self.input)
            .take(LONGEST_LINE)
            .read_until(b'\n', &mut bytes)?;
        self.line += 1;
        self.buffer = String::from_utf8(bytes).map_err(|error| {
            let found = String::from_utf8_lossy(error.as_bytes()).into_owned();
            self.wrong("its text", found, "UTF-8 is wanted")
        })?;
        if read as u64 == LONGEST_LINE && !self.buffer.ends_with('\n') {
            let start = self.buffer.clone();
            return Err(self.wrong("its text", start, "a line has at most 65535 bytes"));
        }
        Ok(read > 0)
    }

    fn wrong(&self, field: &'static str, found: String, wanted: &'static str) -> XyzError {
        XyzError::Malformed {
            line: self.line,
            field,
            found: found.chars().take(LONGEST_QUOTE).collect(),
            wanted,
        }
    }

    fn read_frame(&mut self) -> Result<Option<Frame>, XyzError> {
        loop {
            if !self.next_line()? {
                return Ok(None);
            }
            if !self.buffer.trim().is_empty() {
                break;
            }
        }
        let text = self.buffer.trim();
        let count: usize = match text.parse() {
            Ok(count) if count <= MOST_GRAINS => count,
            _ => {
                let found = text.to_owned();
                let wanted = "a number of grains, at most 10000000, is wanted";
                return Err(self.wrong("the first line of a frame", found, wanted));
            }
        };
        if !self.next_line()? {
            return Err(XyzError::Truncated {
                line: self.line - 1,
            });
        }
        let header = self.read_header()?;
        let mut grains = Vec::new();
        for index in 0..count {
            if !self.next_line()? {
                return Err(XyzError::Truncated {
                    line: self.line - 1,
                });
            }
            grains.push(self.read_grain(index as u64, &header)?);
        }
        if header.columns.contains(&Column::Id) {
            grains.sort_by_key(|(id, _)| *id);
            if let Some(twice) = grains.windows(2).find(|pair| pair[0].0 == pair[1].0) {
                let found = twice[0].0.to_string();
                return Err(self.wrong("an id of this frame", found, "each may stand only once"));
            }
        }
        Ok(Some(Frame {
            dimension: header.dimension,
            time: header.time,
            origin: header.origin,
            lengths: header.lengths,
            periodic: header.periodic,
            grains: grains.into_iter().map(|(_, grain)| grain).collect(),
        }))
    }

    fn read_header(&self) -> Result<Header, XyzError> {
        let mut header = Header {
            columns: vec![
                Column::Other,
                Column::Position(0),
                Column::Position(1),
                Column::Position(2),
            ],
            dimension: 3,
            time: Time::ZERO,
            origin: [0.0; 3],
            lengths: [1.0; 3],
            periodic: [false; 3],
        };
        for (key, value) in pairs(&self.buffer) {
            match key.to_ascii_lowercase().as_str() {
                "properties" => header.columns = self.read_columns(value)?,
                "time" => {
                    header.time = match value.parse::<Time>() {
                        Ok(time) => time,
                        Err(_) => Time::from_units(self.number("Time", value)?),
                    };
                }
                "dimension" if value == "2" => header.dimension = 2,
                "origin" => header.origin = self.read_three("Origin", value)?,
                "lattice" => {
                    let corner = self.read_numbers("Lattice", value)?;
                    if corner.len() != 9 {
                        let wanted = "nine numbers are wanted";
                        return Err(self.wrong("Lattice", value.into(), wanted));
                    }
                    header.lengths = [corner[0], corner[4], corner[8]];
                }
                "pbc" => {
                    let flags: Vec<bool> = value
                        .split_whitespace()
                        .map(|flag| matches!(flag, "T" | "1" | "True" | "true"))
                        .collect();
                    header.periodic = flags
                        .try_into()
                        .map_err(|_| self.wrong("pbc", value.into(), "three flags are wanted"))?;
                }
                _ => {}
            }
        }
        Ok(header)
    }

    fn read_numbers(&self, field: &'static str, text: &str) -> Result<Vec<f64>, XyzError> {
        text.split_whitespace()
            .map(|word| self.number(field, word))
            .collect()
    }

    fn read_three(&self, field: &'static str, text: &str) -> Result<[f64; 3], XyzError> {
        self.read_numbers(field, text)?
            .try_into()
            .map_err(|_| self.wrong(field, text.into(), "three numbers are wanted"))
    }

    fn read_columns(&self, text: &str) -> Result<Vec<Column>, XyzError> {
        let wrong = |wanted| self.wrong("Properties", text.into(), wanted);
        let words: Vec<&str> = text.split(':').collect();
        let mut columns = Vec::new();
        for triple in words.chunks(3) {
            let [name, _, width] = triple else {
                return Err(wrong("name:kind:width, again and again, is wanted"));
            };
            let width: usize = match width.parse() {
                Ok(width) if width <= 100 => width,
                _ => return Err(wrong("a width is a number, at most 100")),
            };
            if columns.len() + width > MOST_COLUMNS {
                return Err(wrong("at most 1000 columns are allowed"));
            }
            for place in 0..width {
                columns.push(match (name.to_ascii_lowercase().as_str(), width) {
                    ("id", 1) => Column::Id,
                    ("pos" | "position" | "positions", 3) => Column::Position(place),
                    ("velo" | "vel" | "velocity" | "velocities", 3) => Column::Velocity(place),
                    ("radius", 1) => Column::Radius,
                    ("diameter", 1) => Column::Diameter,
                    ("mass" | "masses", 1) => Column::Mass,
                    ("mode", 1) => Column::Mode,
                    ("type", 1) => Column::Type,
                    _ => Column::Other,
                });
            }
        }
        if !columns.contains(&Column::Position(0)) {
            return Err(wrong("a property pos:R:3 is wanted"));
        }
        Ok(columns)
    }

    fn number(&self, field: &'static str, word: &str) -> Result<f64, XyzError> {
        match word.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => Err(self.wrong(field, word.into(), "a finite number is wanted")),
        }
    }

    fn positive(&self, field: &'static str, word: &str) -> Result<f64, XyzError> {
        match word.parse::<f64>() {
            Ok(number) if number.is_finite() && number > 0.0 => Ok(number),
            _ => Err(self.wrong(field, word.into(), "a number greater than 0 is wanted")),
        }
    }

    fn read_grain(&self, id: u64, header: &Header) -> Result<(u64, Particle<3>), XyzError> {
        let mut id = id;
        let mut grain = Particle::new(Vector::zeros(), Vector::zeros());
        let (mut mass, mut mode) = (None, None);
        let mut words = self.buffer.split_whitespace();
        for column in &header.columns {
            let word = words.next().unwrap_or("");
            match column {
                Column::Other => {}
                Column::Id => {
                    id = word
                        .parse()
                        .map_err(|_| self.wrong("id", word.into(), "a whole number is wanted"))?;
                }
                Column::Position(axis) => grain.position[*axis] = self.number("position", word)?,
                Column::Velocity(axis) => grain.velocity[*axis] = self.number("velocity", word)?,
                Column::Radius => {
                    // What is written has half of it to be read again.
                    let radius = self.positive("radius", word)?;
                    grain.diameter = 2.0 * radius;
                    if grain.diameter.is_infinite() {
                        let wanted = "a smaller number is wanted";
                        return Err(self.wrong("radius", word.into(), wanted));
                    }
                }
                Column::Diameter => {
                    grain.diameter = self.positive("diameter", word)?;
                    if grain.radius() == 0.0 {
                        let wanted = "a larger number is wanted";
                        return Err(self.wrong("diameter", word.into(), wanted));
                    }
                }
                Column::Mass => mass = Some(self.positive("mass", word)?),
                Column::Mode => {
                    let wanted = "normal, falling, frozen or fixed is wanted";
                    let said = mode_named(word);
                    mode = Some(said.ok_or_else(|| self.wrong("mode", word.into(), wanted))?);
                }
                // Others have types of their own there, which say nothing of modes.
                Column::Type => mode = mode.or(mode_named(word)),
            }
        }
        if header.dimension == 2 && (grain.position[2] != 0.0 || grain.velocity[2] != 0.0) {
            let found = format!("{} {}", grain.position[2], grain.velocity[2]);
            return Err(self.wrong("z of a plane frame", found, "0 0 is wanted"));
        }
        grain.mode = mode.unwrap_or(grain.mode);
        grain.mass = mass
            .unwrap_or_else(|| (0..header.dimension).fold(1.0, |mass, _| mass * grain.diameter));
        Ok((id, grain))
    }
}

impl<R: BufRead> Iterator for XyzReader<R> {
    type Item = Result<Frame, XyzError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.read_frame().transpose()
    }
}

/// The mode of this name, if there is one.
fn mode_named(word: &str) -> Option<Mode> {
    [Mode::Normal, Mode::Falling, Mode::Frozen, Mode::Fixed]
        .into_iter()
        .find(|mode| mode.name() == word)
}

/// The `key=value` and `key="some values"` of a comment line.
fn pairs(line: &str) -> impl Iterator<Item = (&str, &str)> {
    let mut rest = line.trim();
    std::iter::from_fn(move || {
        loop {
            rest = rest.trim_start();
            if rest.is_empty() {
                return None;
            }
            let end = rest
                .find(|c: char| c == '=' || c.is_whitespace())
                .unwrap_or(rest.len());
            let (key, after) = rest.split_at(end);
            let Some(after) = after.strip_prefix('=') else {
                // A bare word says nothing.
                rest = after;
                continue;
            };
            let (value, left) = match after.strip_prefix('"') {
                Some(quoted) => quoted.split_once('"').unwrap_or((quoted, "")),
                None => after.split_at(after.find(char::is_whitespace).unwrap_or(after.len())),
            };
            rest = left;
            return Some((key, value));
        }
    })
}
