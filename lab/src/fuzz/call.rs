//! Calls of the fuzzer, and the criteria for faults in their answers.

use crate::prelude::*;

/// A call prepared by a generator.
pub struct Call {
    /// The call. A fault is described by the error.
    pub run: Box<dyn FnOnce() -> Result<Answer, String>>,
    /// A short description of the arguments.
    pub description: String,
    /// Whether the ceilings apply: not to options that ask for more work than the defaults.
    pub is_bounded: bool,
}

/// What was wrong with a result.
pub(super) type Checked = Result<(), String>;

impl Call {
    /// A call whose result is checked, and whose error must be typed.
    pub(super) fn new<T: 'static>(
        description: String,
        is_bounded: bool,
        takes_transform: bool,
        call: impl FnOnce() -> Result<T> + 'static,
        check: fn(&T) -> Checked,
    ) -> Self {
        let run = move || match call() {
            Ok(found) => check(&found).map(|()| Answer::Result),
            Err(error) => typed(&error, takes_transform),
        };
        Self { run: Box::new(run), description, is_bounded }
    }
}

/// The kind of answer to a call without fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Answer {
    /// A result.
    Result,
    /// A typed error.
    Error(ErrorCode),
}

/// The answer for an error, or its fault: an error of the package itself, one without words, or one about an argument
/// that the call does not take.
pub(super) fn typed(error: &Error, takes_transform: bool) -> Result<Answer, String> {
    let empty = error.argument.is_empty() || error.found.is_empty() || error.expected.is_empty();
    let foreign = error.code == ErrorCode::InvalidTransform && !takes_transform;
    if empty || foreign || error.code == ErrorCode::Internal || error.remedy.is_empty() {
        return Err(format!("untyped: {} {error}", error.code.as_str()));
    }
    Ok(Answer::Error(error.code))
}

/// A fault for a number that no result may contain.
pub(super) fn finite(name: &str, numbers: &[f64]) -> Checked {
    if numbers.iter().all(|x| x.is_finite()) {
        return Ok(());
    }
    Err(format!("result: {name} is {numbers:?}"))
}
