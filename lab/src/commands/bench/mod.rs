//! `bench`: runs methods over generated cases and case folders, and prints tables of the results.

mod arguments;
mod run;
mod table;

use super::{Failure, parsed};
use arguments::{Arguments, USAGE};

/// Runs the command.
pub fn main(arguments: lexopt::Parser) -> Result<(), Failure> {
    run::run(&parsed(arguments, Arguments::parse, USAGE)?).map_err(Failure::Failed)
}
