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

/// The parsed arguments of a command, or the reason to end it: `parse` returns `None` where help is requested.
///
/// # Errors
/// [`Failure::Help`], [`Failure::Usage`].
fn parsed<T>(
    parser: lexopt::Parser,
    parse: impl FnOnce(lexopt::Parser) -> Result<Option<T>, lexopt::Error>,
    usage: &'static str,
) -> Result<T, Failure> {
    match parse(parser) {
        Ok(Some(arguments)) => Ok(arguments),
        Ok(None) => Err(Failure::Help(usage)),
        Err(error) => Err(Failure::Usage(error, usage)),
    }
}
