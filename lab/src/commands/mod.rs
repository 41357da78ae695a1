//! The subcommands of `sim3align-lab`.

pub mod bench;
pub mod cases;
pub mod fuzz;
pub mod outlines;
pub mod profile;
pub mod registration;
pub mod scenes;
mod sequence_rows;
pub mod together;
pub mod track;
pub mod views;

/// Reason for which a command ended early.
pub enum Failure {
    /// Help was requested.
    Help(&'static str),
    /// Invalid arguments, with the usage text.
    Usage(lexopt::Error, &'static str),
    /// Failure of the command.
    Failed(String),
}
