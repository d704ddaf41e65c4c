//! `grainfall bench`: what events cost, in time and memory.

mod arguments;
mod gas;
mod memory;
mod timing;

pub(super) use arguments::BenchArguments;

use crate::program::bench::arguments::Subject;
use crate::program::error::ProgramError;

pub(super) fn bench(arguments: &BenchArguments) -> Result<u8, ProgramError> {
    match &arguments.subject {
        Subject::Gas(arguments) => gas::measure(arguments),
    }
}
