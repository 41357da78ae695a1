//! `bench`: runs methods over generated cases and case folders, and prints tables of the results.

mod run;
mod settings;
mod table;

use super::{Command, monocular};
use settings::{Settings, USAGE};
use sim3align_lab::cases::tier::CaseSet;
use sim3align_lab::prelude::*;

pub const COMMAND: Command = Command {
    name: "bench",
    about: "aligns cases with a known truth, and prints tables",
    usage: USAGE,
    run: |arguments| {
        // The rows of that set differ in what is given of a case, not in the options.
        if arguments.take("set", CaseSet::Monocular.as_str())? {
            return monocular::run(arguments);
        }
        run::run(&Settings::parse(arguments)?)
    },
};
