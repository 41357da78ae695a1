//! The subcommands of `sim3align-lab`.

pub mod bench;
pub mod profile;
pub mod registration;

use std::fmt::Display;

use sim3align_lab::prelude::*;

/// Reason for which a command ended early.
pub enum Failure {
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

/// Prints how many of `all` items are done, now and then, on standard error.
fn print_progress(done: usize, all: usize) {
    if done.is_multiple_of(10) || done == all {
        eprint!("\r{done} of {all} {}", if done == all { "\n" } else { "" });
    }
}

/// Number of threads: by default, one for each processor.
fn thread_count(given: Option<usize>) -> usize {
    given.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from))
}
