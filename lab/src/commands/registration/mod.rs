//! `registration`: writes pairs of clouds with a known transform, and runs registration methods over them.

mod method;
mod run;
mod settings;
mod table;

use sim3align_lab::clouds::generated::write_pairs;
use sim3align_lab::prelude::*;

use super::{Arguments, Command, Failure, usage};
use settings::{Settings, USAGE};

pub const COMMAND: Command = Command {
    name: "registration",
    about: "writes pairs of clouds, and registers them",
    usage: USAGE,
    run: |arguments| match arguments.word().as_deref() {
        Some("write") => write(arguments),
        Some("run") => run::run(&Settings::parse(arguments)?),
        Some(other) => Err(usage(format!("unexpected argument {other:?}"))),
        None => Err(Failure::Help),
    },
};

fn write(arguments: &mut Arguments) -> Result<(), Failure> {
    let (seed, scenes) = (arguments.value("seed", 0)?, arguments.value("scenes", 4)?);
    let words = arguments.rest()?;
    match words.as_slice() {
        [kind, out] if kind == "rooms" || kind == "lidar" => {
            Ok(write_pairs(out.as_ref(), kind == "lidar", seed, scenes)?)
        }
        _ => Err(usage("write needs rooms or lidar, and a folder")),
    }
}
