//! `fuzz`: searches for inputs on which the package fails.

mod arguments;
mod child;
mod parent;
mod replay;

use super::Failure;
use arguments::{Arguments, Mode, USAGE, parse};

/// Runs the command.
pub fn main(arguments: lexopt::Parser) -> Result<(), Failure> {
    let arguments: Arguments = match parse(arguments) {
        Ok(Some(arguments)) => arguments,
        Ok(None) => return Err(Failure::Help(USAGE)),
        Err(error) => return Err(Failure::Usage(error, USAGE)),
    };
    match &arguments.mode {
        Mode::Search => parent::search(&arguments),
        Mode::Range(target, range) => child::run(*target, range.clone(), &arguments),
        Mode::Replay(path) => replay::run(path, &arguments),
    }
}
