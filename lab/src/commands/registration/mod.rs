//! `registration`: writes pairs of clouds with a known transform, and runs registration methods over them.

mod arguments;
mod method;
mod run;
mod table;

use super::Failure;
use arguments::{Command, USAGE};

/// Runs the command.
pub fn main(arguments: lexopt::Parser) -> Result<(), Failure> {
    match Command::parse(arguments) {
        Ok(Some(command)) => run::run(&command).map_err(Failure::Failed),
        Ok(None) => Err(Failure::Help(USAGE)),
        Err(error) => Err(Failure::Usage(error, USAGE)),
    }
}
