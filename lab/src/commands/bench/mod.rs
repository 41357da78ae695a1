//! `bench`: runs methods over generated cases and case folders, and prints tables of the results.

mod run;
mod settings;
mod table;

use super::Command;
use settings::{Settings, USAGE};

pub const COMMAND: Command = Command {
    name: "bench",
    about: "aligns cases with a known truth, and prints tables",
    usage: USAGE,
    run: |arguments| run::run(&Settings::parse(arguments)?),
};
