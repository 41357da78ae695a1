//! `fuzz`: searches for inputs on which the package fails.

mod child;
mod parent;
mod settings;

use super::Command;
use settings::{Mode, Settings, USAGE};

pub const COMMAND: Command = Command {
    name: "fuzz",
    about: "searches for inputs on which the package fails",
    usage: USAGE,
    run: |arguments| {
        let settings = Settings::parse(arguments)?;
        match &settings.mode {
            Mode::Search => parent::search(&settings),
            Mode::Range(target, range) => child::run(*target, range.clone(), &settings),
            Mode::Replay(path) => child::replay(path, &settings.ceilings),
        }
    },
};
