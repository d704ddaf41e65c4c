//! The command `draw`.

use std::fs::File;
use std::io::BufReader;
use std::path::PathBuf;

use crate::draw::svg;
use crate::output::{XyzError, XyzReader, write_atomically};
use crate::program::cli::DrawArguments;
use crate::program::error::ProgramError;
use crate::program::show::say;

pub(super) fn draw(arguments: &DrawArguments) -> Result<u8, ProgramError> {
    let frames = if arguments.run.is_dir() {
        arguments.run.join("frames.xyz")
    } else {
        arguments.run.clone()
    };
    let name = frames.display().to_string();
    let opened = File::open(&frames).map_err(ProgramError::io(name.clone()))?;
    let reader = XyzReader::new(BufReader::new(opened));
    let found = match arguments.time {
        Some(time) => reader.frame_near(time),
        None => reader.last_frame(),
    };
    let frame = found.map_err(|source| match source {
        XyzError::Io(source) => ProgramError::Io { file: name, source },
        source => ProgramError::Frames { file: name, source },
    })?;
    let out: PathBuf = match &arguments.out {
        Some(out) => out.clone(),
        None => frames.with_file_name("picture.svg"),
    };
    let shown = out.display().to_string();
    write_atomically(&out, svg(&frame).as_bytes()).map_err(ProgramError::io(shown.clone()))?;
    say(&format!("{shown}: t = {:.6}", frame.time)).map(|()| 0)
}
