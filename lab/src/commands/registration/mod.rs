//! `registration`: writes pairs of clouds with a known transform, and runs registration methods over them.

mod arguments;
mod method;
mod run;
mod table;

use super::{Failure, parsed};
use arguments::{Command, USAGE};

/// Runs the command.
pub fn main(arguments: lexopt::Parser) -> Result<(), Failure> {
    run::run(&parsed(arguments, Command::parse, USAGE)?).map_err(Failure::Failed)
}
