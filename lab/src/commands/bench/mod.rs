//! `bench`: runs methods over generated cases and case folders, and prints tables of the results.

mod arguments;
mod run;
mod table;

use super::Failure;
use arguments::{Arguments, USAGE};

/// Runs the command.
pub fn main(arguments: lexopt::Parser) -> Result<(), Failure> {
    match Arguments::parse(arguments) {
        Ok(Some(arguments)) => run::run(&arguments).map_err(Failure::Failed),
        Ok(None) => Err(Failure::Help(USAGE)),
        Err(error) => Err(Failure::Usage(error, USAGE)),
    }
}
