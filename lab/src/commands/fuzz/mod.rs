//! `fuzz`: searches for inputs on which the package fails.

mod arguments;
mod child;
mod parent;
mod replay;

use super::{Failure, parsed};
use arguments::{Arguments, Mode, USAGE, parse};

/// Runs the command.
pub fn main(arguments: lexopt::Parser) -> Result<(), Failure> {
    let arguments: Arguments = parsed(arguments, parse, USAGE)?;
    match &arguments.mode {
        Mode::Search => parent::search(&arguments),
        Mode::Range(target, range) => child::run(*target, range.clone(), &arguments),
        Mode::Replay(path) => replay::run(path, &arguments),
    }
}
