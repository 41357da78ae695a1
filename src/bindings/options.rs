//! Options from JavaScript objects: types and names are checked here, ranges where the options live.

use js_sys::{Array, Object, Reflect};
use wasm_bindgen::{JsCast, JsValue};

use super::object::{describe, get, number, to_number, to_numbers, wrong_type};
use super::transform::similarity;
use crate::align::evaluate::Truth;
use crate::align::field::{Field, Options, SYMMETRY};
use crate::align::options::ScaleOption;
use crate::error::{Error, ErrorCode, Result};
use crate::metrics::symmetry::{Symmetry, SymmetryAxis};
use crate::number::{number as number_text, numbers};

/// An options struct from an object; `also` names the keys that are read apart from the struct.
pub fn options<T: Options>(value: &JsValue, also: &[&str]) -> Result<T> {
    let mut options = T::default();
    if !value.is_undefined() && !value.is_null() {
        set_fields(value, also, &mut options.fields())?;
    }
    Ok(options)
}

fn set_fields(object: &JsValue, also: &[&str], fields: &mut [(&'static str, Field<'_>)]) -> Result<()> {
    if !object.is_object() || Array::is_array(object) {
        return Err(wrong_type("options", object, "an object", "Leave it out to take all defaults."));
    }
    for key in Object::keys(object.unchecked_ref::<Object>()).iter() {
        let name = key.as_string().unwrap_or_default();
        let value = Reflect::get(object, &key).unwrap_or(JsValue::UNDEFINED);
        // A key that is there but undefined (`{ seed: maybe }`) means the default, as everywhere in JavaScript.
        if value.is_undefined() || also.contains(&name.as_str()) {
            continue;
        }
        match fields.iter_mut().find(|(field, _)| *field == name) {
            Some((_, field)) => {
                if !set(field, &value)? {
                    return Err(field.error(&name, describe(&value)));
                }
                field.check(&name)?;
            }
            None => {
                let known: Vec<&str> = fields.iter().map(|(field, _)| *field).chain(also.iter().copied()).collect();
                return Err(unknown_option(&name, &known));
            }
        }
    }
    Ok(())
}

/// All options of a struct with their defaults.
pub fn defaults<T: Options>() -> JsValue {
    let mut options = T::default();
    object_of(options.fields().iter().map(|(name, field)| (*name, value_of(field))))
}

/// A plain object.
pub fn object_of<'a>(properties: impl IntoIterator<Item = (&'a str, JsValue)>) -> JsValue {
    let object = Object::new();
    for (name, value) in properties {
        // A fresh object is extensible: setting a property on it can't fail.
        let _ = Reflect::set(&object, &name.into(), &value);
    }
    object.into()
}

fn value_of(field: &Field<'_>) -> JsValue {
    match field {
        Field::Count { value, .. } => f64::from(**value).into(),
        Field::Number { value, .. } => (**value).into(),
        Field::Positive(value) => value.map_or(JsValue::NULL, Into::into),
        Field::Flag(value) => (**value).into(),
        Field::Switch(value) => value.map_or(JsValue::NULL, Into::into),
        Field::Bounds(bounds) | Field::Guard(bounds) => bounds.map_or(JsValue::NULL, numbers_of),
        Field::Direction(direction) => direction.map_or(JsValue::NULL, numbers_of),
        Field::Symmetry(symmetry) => SYMMETRY_NAMES
            .iter()
            .find(|(_, named)| named == *symmetry)
            .map_or(JsValue::NULL, |(name, _)| (*name).into()),
        // No struct of options comes with a pose.
        Field::Transform(_) => JsValue::NULL,
        Field::Choice(choice) => choice.name().into(),
    }
}

fn numbers_of<const N: usize>(numbers: [f64; N]) -> JsValue {
    numbers.into_iter().map(JsValue::from).collect::<Array>().into()
}

/// Sets a field from a value of its type; `false` for any other. Ranges are the field's own affair.
fn set(field: &mut Field<'_>, value: &JsValue) -> Result<bool> {
    Ok(match field {
        Field::Count { value: count, .. } => {
            let whole = |x: &f64| x.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(x);
            put(*count, value.as_f64().filter(whole).map(|x| x as u32))
        }
        Field::Number { value: number, .. } => put(*number, value.as_f64()),
        Field::Positive(number) => put(*number, or_null(value, value.as_f64())),
        Field::Flag(flag) => put(*flag, value.as_bool()),
        Field::Switch(flag) => put(*flag, or_null(value, value.as_bool())),
        Field::Bounds(bounds) => put(*bounds, or_null(value, bounds_of(value))),
        Field::Direction(direction) => put(*direction, or_null(value, to_numbers(value, "").ok())),
        Field::Guard(guard) => put(*guard, or_null(value, to_numbers(value, "").ok())),
        Field::Symmetry(known) => put(*known, Some(symmetry(value)?)),
        Field::Transform(pose) if value.is_null() => put(*pose, Some(None)),
        Field::Transform(pose) => put(*pose, Some(Some(similarity(value, "options.initial")?))),
        Field::Choice(choice) => value.as_string().is_some_and(|name| choice.set(&name)),
    })
}

/// Sets an option to what was read, if anything was.
fn put<T>(option: &mut T, read: Option<T>) -> bool {
    read.map(|value| *option = value).is_some()
}

/// What was read of an option that may be `null`.
fn or_null<T>(value: &JsValue, read: Option<T>) -> Option<Option<T>> {
    if value.is_null() { Some(None) } else { read.map(Some) }
}

/// A number for both bounds, `[min, max]` or `{ min, max }`.
fn bounds_of(value: &JsValue) -> Option<[f64; 2]> {
    if let Some(x) = value.as_f64() {
        return Some([x, x]);
    }
    let bound = |key| get(value, key).and_then(|x| x.as_f64());
    bound("min").zip(bound("max")).map(<[f64; 2]>::from).or_else(|| to_numbers(value, "").ok())
}

fn unknown_option(name: &str, known: &[&str]) -> Error {
    let mut nearest = (usize::MAX, "");
    for known in known {
        let distance = edit_distance(name, known);
        if distance < nearest.0 {
            nearest = (distance, known);
        }
    }
    let (_, nearest) = nearest;
    Error::new(
        ErrorCode::UnknownOption,
        format!("options.{name}"),
        "an option that does not exist",
        format!("one of {}", known.join(", ")),
        format!("Did you mean `{nearest}`?"),
    )
}

/// Levenshtein's distance, in bytes: the names are ASCII.
fn edit_distance(a: &str, b: &str) -> usize {
    let b = b.as_bytes();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.bytes().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, &y) in b.iter().enumerate() {
            let cost = (diagonal + usize::from(x != y)).min(row[j] + 1).min(row[j + 1] + 1);
            diagonal = row[j + 1];
            row[j + 1] = cost;
        }
    }
    row.last().copied().unwrap_or_default()
}

/// `"free"`, `"fixed"`, a number, or `[min, max]`.
pub fn scale(options: &JsValue) -> Result<ScaleOption> {
    let Some(value) = get(options, "scale") else { return Ok(ScaleOption::Free) };
    let scale = match value.as_string().as_deref() {
        Some("free") => ScaleOption::Free,
        Some("fixed") => ScaleOption::Fixed(1.0),
        None if value.as_f64().is_some() => ScaleOption::Fixed(to_number(&value, "options.scale")?),
        None if Array::is_array(&value) => ScaleOption::Between(to_numbers(&value, "options.scale")?),
        _ => {
            let remedy = "Leave it out to solve for the scale.";
            let error = wrong_type("options.scale", &value, "\"free\", \"fixed\", a number or [min, max]", remedy);
            return Err(error.coded(ErrorCode::InvalidOption));
        }
    };
    Ok(scale)
}

/// The true transform and the symmetry of `evaluate`'s options.
pub fn truth(options: &JsValue) -> Result<Option<Truth>> {
    let Some(value) = get(options, "truth") else { return Ok(None) };
    let camera_from_mesh = similarity(&value, "options.truth")?;
    Ok(Some(Truth {
        camera_from_mesh,
        symmetry: get(options, "symmetry").map_or(Ok(Symmetry::None), |s| symmetry(&s))?,
    }))
}

/// The symmetries that a word says.
const SYMMETRY_NAMES: [(&str, Symmetry); 3] =
    [("none", Symmetry::None), ("auto", Symmetry::Auto), ("auto-revolution", Symmetry::AutoRevolution)];

/// `"none"`, `"auto"`, `"auto-revolution"`, or `[{ axis, fold? }]`.
fn symmetry(value: &JsValue) -> Result<Symmetry> {
    if let Some((_, named)) = SYMMETRY_NAMES.into_iter().find(|(name, _)| *value == **name) {
        return Ok(named);
    }
    if !Array::is_array(value) {
        let remedy = "A missing fold declares a continuous symmetry about the axis.";
        return Err(wrong_type("options.symmetry", value, SYMMETRY, remedy).coded(ErrorCode::InvalidOption));
    }
    let array = Array::from(value);
    let axes = array.iter().map(|declared| {
        let axis = get(&declared, "axis").unwrap_or(JsValue::UNDEFINED);
        let axis = to_numbers(&axis, "options.symmetry.axis")?;
        let fold = number(&declared, "options.symmetry", "fold")?;
        symmetry_axis(axis, fold)
    });
    Ok(Symmetry::Declared(axes.collect::<Result<_>>()?))
}

fn symmetry_axis(axis: [f64; 3], fold: Option<f64>) -> Result<SymmetryAxis> {
    let invalid = |argument: &str, found: String, expected: &str| {
        Error::new(
            ErrorCode::InvalidOption,
            argument.to_owned(),
            found,
            expected.to_owned(),
            "The axis is a direction in the mesh's frame.",
        )
    };
    let axis = nalgebra::Vector3::from(axis);
    if !(axis.norm().is_finite() && axis.norm() > 0.0) {
        return Err(invalid("options.symmetry.axis", numbers(axis.as_slice()), "a direction other than 0"));
    }
    let fold = match fold {
        None => None,
        Some(fold) if (2.0..=360.0).contains(&fold) && fold.fract() == 0.0 => Some(fold as u32),
        Some(fold) => return Err(invalid("options.symmetry.fold", number_text(fold), "a whole number from 2 to 360")),
    };
    Ok(SymmetryAxis { axis, fold })
}
