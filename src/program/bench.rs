//! `grainfall bench`: what events cost, in time and memory.

mod arguments;
mod deposition;
mod gas;
mod growth;
mod memory;
mod scaling;
mod table;

pub(super) use arguments::BenchArguments;

use crate::program::bench::arguments::Subject;
use crate::program::error::ProgramError;

pub(super) fn bench(arguments: &BenchArguments) -> Result<u8, ProgramError> {
    match &arguments.subject {
        Subject::Gas(arguments) => gas::measure(arguments),
        Subject::Deposition(arguments) => deposition::measure(arguments),
        Subject::Growth(arguments) => growth::measure(arguments),
        Subject::Scaling(arguments) => scaling::measure(arguments),
    }
}
