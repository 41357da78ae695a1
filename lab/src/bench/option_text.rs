//! Options from text, as the programs' command lines have them.

use sim3align::options::{Field, Options};

use crate::prelude::*;

/// Sets an option by its JavaScript name. Directions, symmetries and poses differ from case to case and have no text.
///
/// # Errors
/// In words: what is wrong with the value. `None` where the struct has no such option.
pub fn assign<T: Options>(options: &mut T, name: &str, text: &str) -> Option<Result<(), String>> {
    let (_, mut field) = options.named_fields().into_iter().find(|(own, _)| own == name)?;
    if set(&mut field, text).is_none() {
        return Some(Err(format!("{name}: found {text:?}, expected {}", field.expected())));
    }
    Some(field.check(name).map_err(|error| error.to_string()))
}

fn set(field: &mut Field<'_>, text: &str) -> Option<()> {
    match field {
        Field::Count(value, _) => **value = text.parse().ok()?,
        Field::Number(value, _) => **value = text.parse().ok()?,
        Field::OptionalNumber(value, _) | Field::Positive(value) => **value = or_null(text, |text| text.parse().ok())?,
        Field::Flag(flag) => **flag = text.parse().ok()?,
        Field::Scale(scale) => **scale = scale_of(text)?,
        Field::Guard(guard) => **guard = or_null(text, |text| numbers(text)?.try_into().ok())?,
        Field::Choice(choice) => return choice.set(text).then_some(()),
        Field::Direction(_) | Field::Symmetry(_) | Field::Transform(_) => return None,
    }
    Some(())
}

fn or_null<T>(text: &str, parse: impl FnOnce(&str) -> Option<T>) -> Option<Option<T>> {
    if text == "null" { Some(None) } else { parse(text).map(Some) }
}

fn scale_of(text: &str) -> Option<ScaleOption> {
    match numbers(text).as_deref() {
        _ if text == "free" => Some(ScaleOption::Free),
        Some(&[fixed]) => Some(ScaleOption::Fixed(fixed)),
        Some(&[min, max]) => Some(ScaleOption::Between([min, max])),
        _ => None,
    }
}

/// Numbers with commas between them.
fn numbers(text: &str) -> Option<Vec<f64>> {
    text.split(',').map(|part| part.trim().parse().ok()).collect()
}
