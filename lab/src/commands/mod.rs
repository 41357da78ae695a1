//! The subcommands of `sim3align-lab`.

pub mod bench;
pub mod cases;
pub mod profile;
pub mod registration;
pub mod scenes;

/// Why a command did not run to its end.
pub enum Failure {
    /// Help was asked for.
    Help(&'static str),
    /// The arguments are wrong; the usage says what is right.
    Usage(lexopt::Error, &'static str),
    /// The command failed.
    Failed(String),
}
