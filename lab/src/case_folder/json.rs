//! JSON values as the readers need them.

use serde_json::Value;

use crate::prelude::*;
use sim3align_geometry::error::Text;

/// Parses a JSON file.
pub fn parse(argument: &str, bytes: &[u8]) -> Result<Value> {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    serde_json::from_slice(text).map_err(|error| corrupt(argument, format!("text that is no JSON: {error}"), "JSON"))
}

/// The error for a file that holds something else.
pub fn corrupt(argument: &str, found: impl Into<Text>, expected: &'static str) -> Error {
    Error::new(
        ErrorCode::CorruptFile,
        argument.to_owned(),
        found,
        expected,
        "Write the file as the guide describes it.",
    )
}

/// `N` numbers: an array of them, or of rows of them.
pub fn numbers<const N: usize>(value: &Value) -> Option<[f64; N]> {
    let mut numbers = [0.0; N];
    let mut slots = numbers.iter_mut();
    let mut store = |x: &Value| -> Option<()> {
        *slots.next()? = x.as_f64()?;
        Some(())
    };
    for item in value.as_array()? {
        match item.as_array() {
            Some(row) => row.iter().try_for_each(&mut store)?,
            None => store(item)?,
        }
    }
    slots.next().is_none().then_some(numbers)
}

/// What stands in place of something else, for the message; of long text the beginning.
pub fn found(value: Option<&Value>) -> String {
    const SHOWN: usize = 60;
    let Some(value) = value else { return "nothing".into() };
    let text = value.to_string();
    let shown: String = text.chars().take(SHOWN).collect();
    if shown.len() < text.len() { format!("{shown}…") } else { text }
}
