//! The subcommands of `sim3align-lab`.

mod arguments;
mod bench;
mod cases;
mod generators;
mod monocular;
mod outlines;
mod pictures;
mod profile;
mod proportions;
mod registration;
mod scenes;
mod sequence_rows;
mod together;
mod trace;
mod track;
mod views;

use std::borrow::Borrow;
use std::fmt::Display;

pub use arguments::Arguments;
use serde::Serialize;
use sim3align_lab::bench::case_line::CaseLine;
use sim3align_lab::prelude::*;

/// A subcommand.
pub struct Command {
    /// Its name.
    pub name: &'static str,
    /// What it does, in a line.
    pub about: &'static str,
    /// Its usage.
    pub usage: &'static str,
    /// Runs it.
    pub run: fn(&mut Arguments) -> Result<(), Failure>,
}

/// All subcommands.
pub const COMMANDS: [Command; 13] = [
    cases::COMMAND,
    scenes::COMMAND,
    bench::COMMAND,
    together::COMMAND,
    monocular::COMMAND,
    proportions::COMMAND,
    generators::COMMAND,
    registration::COMMAND,
    views::COMMAND,
    track::COMMAND,
    trace::COMMAND,
    outlines::COMMAND,
    profile::COMMAND,
];

/// Reason for which a command ended early.
pub enum Failure {
    /// Help was requested.
    Help,
    /// Invalid arguments.
    Usage(String),
    /// Failure of the command.
    Failed(String),
}

impl<E: Display> From<E> for Failure {
    fn from(error: E) -> Self {
        Self::Failed(error.to_string())
    }
}

/// The failure of arguments that are wrong.
fn usage(error: impl Display) -> Failure {
    Failure::Usage(error.to_string())
}

/// Writes a file of results.
fn write_file(path: &Path, content: impl AsRef<[u8]>) -> Result<(), Failure> {
    std::fs::write(path, content).map_err(|error| Failure::Failed(format!("{}: {error}", path.display())))
}

/// Writes the lines of all cases to a file, if one is named.
fn write_lines(json: Option<PathBuf>, lines: impl Iterator<Item: Borrow<CaseLine> + Serialize>) -> Result<(), Failure> {
    let Some(path) = json else { return Ok(()) };
    write_file(&path, serde_json::to_string(&lines.collect::<Vec<_>>())?)
}

/// Prints how many of `all` items are done, now and then, on standard error.
fn print_progress(done: usize, all: usize) {
    if done.is_multiple_of(10) || done == all {
        eprint!("\r{done} of {all} {}", if done == all { "\n" } else { "" });
    }
}
