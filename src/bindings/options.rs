//! Options from JavaScript objects: names and types are checked here, ranges by the declarations of the options.

use js_sys::{Array, Object, Reflect};
use wasm_bindgen::{JsCast, JsValue};

use super::object::{describe, get, number, to_numbers, wrong_type};
use super::transform::similarity;
use crate::error::{Error, ErrorCode, Result};
use crate::metrics::symmetry::{Symmetry, SymmetryAxis};
use crate::number::{number as number_text, numbers};
use crate::options::scale::ScaleOption;
use crate::options::{Field, Options, SYMMETRY};
use crate::paper::options::PaperOptions;
use crate::precise::options::AlignOptions;
use crate::report::Preset;

/// Options of every call that the TypeScript package handles itself. Lists of options in errors contain them.
pub const OF_CALLS: [&str; 2] = ["signal", "transfer"];

/// The same for calls that report their progress.
pub const OF_LONG_CALLS: [&str; 3] = [OF_CALLS[0], OF_CALLS[1], "onProgress"];

/// The same for `align`, whose method `preset` selects.
const OF_ALIGN: [&str; 4] = ["preset", OF_CALLS[0], OF_CALLS[1], "onProgress"];

/// The options of `align` with the preset `precise`, the default.
pub fn precise(value: &JsValue) -> Result<AlignOptions> {
    read(value, Preset::Precise)
}

/// The options of `align` with the preset `paper`.
pub fn paper(value: &JsValue) -> Result<PaperOptions> {
    read(value, Preset::Paper)
}

/// The options of one preset, which another value of `preset` contradicts.
fn read<T: Options>(value: &JsValue, preset: Preset) -> Result<T> {
    if let Some(name) = property(value, "preset")
        && name.as_string().as_deref() != Some(preset.as_str())
    {
        return Err(Field::Choice(&mut Preset::default()).error("preset", describe(&name)));
    }
    options(value, &OF_ALIGN, |name| {
        let (other, names) = match preset {
            Preset::Precise => (Preset::Paper, PaperOptions::names()),
            Preset::Paper => (Preset::Precise, AlignOptions::names()),
        };
        names.iter().any(|known| known == name).then(|| of_other_preset(name, preset, other))
    })
}

/// The error for an option of the other preset.
fn of_other_preset(name: &str, preset: Preset, other: Preset) -> Error {
    let remedy = match other {
        Preset::Paper => format!("Pass `preset: \"paper\"` for the method of the paper, or omit `{name}`."),
        Preset::Precise => format!("Omit `preset` for the default method, or omit `{name}`."),
    };
    Error::new(
        ErrorCode::UnknownOption,
        format!("options.{name}"),
        format!("`{name}`, which is an option of preset \"{}\"", other.as_str()),
        format!("options of preset \"{}\"", preset.as_str()),
        remedy,
    )
}

/// Reads a struct of options from an object. `also` lists keys that are read elsewhere; `refuse` may return a specific
/// error for an unknown option.
pub fn options<T: Options>(value: &JsValue, also: &[&str], refuse: impl Fn(&str) -> Option<Error>) -> Result<T> {
    let mut options = T::default();
    if !value.is_undefined() && !value.is_null() {
        set_fields(value, also, &mut options.named_fields(), &refuse)?;
    }
    Ok(options)
}

fn set_fields(
    object: &JsValue,
    also: &[&str],
    fields: &mut [(String, Field<'_>)],
    refuse: &dyn Fn(&str) -> Option<Error>,
) -> Result<()> {
    if !object.is_object() || Array::is_array(object) {
        return Err(wrong_type("options", object, "an object", "Omit it to use all defaults."));
    }
    for key in Object::keys(object.unchecked_ref::<Object>()).iter() {
        let name = key.as_string().unwrap_or_default();
        // An undefined value (`{ seed: maybe }`) means the default, as usual in JavaScript.
        let Some(value) = property(object, &name) else { continue };
        if also.contains(&name.as_str()) {
            continue;
        }
        match fields.iter_mut().find(|(field, _)| *field == name) {
            Some((_, field)) => {
                if !set(field, &value, &name)? {
                    return Err(field.error(&name, describe(&value)));
                }
                field.check(&name)?;
            }
            None => {
                let known: Vec<&str> =
                    also.iter().copied().chain(fields.iter().map(|(field, _)| field.as_str())).collect();
                return Err(refuse(&name).unwrap_or_else(|| unknown_option(&name, &known)));
            }
        }
    }
    Ok(())
}

/// A property that exists and is not `undefined`.
fn property(object: &JsValue, name: &str) -> Option<JsValue> {
    Reflect::get(object, &name.into()).ok().filter(|value| !value.is_undefined())
}

/// Sets a field from a value of its type; `false` for other types. The field checks its range.
fn set(field: &mut Field<'_>, value: &JsValue, name: &str) -> Result<bool> {
    Ok(match field {
        Field::Count(count, _) => {
            let whole = |x: &f64| x.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(x);
            put(*count, value.as_f64().filter(whole).map(|x| x as u32))
        }
        Field::Number(number, _) => put(*number, value.as_f64()),
        Field::OptionalNumber(number, _) | Field::Positive(number) => put(*number, or_null(value, value.as_f64())),
        Field::Flag(flag) => put(*flag, value.as_bool()),
        Field::Scale(scale) => put(*scale, scale_of(value)),
        Field::Direction(direction) => put(*direction, or_null(value, to_numbers(value, "").ok())),
        Field::Guard(guard) => put(*guard, or_null(value, to_numbers(value, "").ok())),
        Field::Symmetry(known) => put(*known, Some(symmetry(value)?)),
        Field::Transform(pose) if value.is_null() => put(*pose, Some(None)),
        Field::Transform(pose) => put(*pose, Some(Some(similarity(value, &format!("options.{name}"))?))),
        Field::Choice(choice) => value.as_string().is_some_and(|name| choice.set(&name)),
    })
}

/// Sets an option to the value, if one was read.
fn put<T>(option: &mut T, read: Option<T>) -> bool {
    read.map(|value| *option = value).is_some()
}

/// Reads an option that may be `null`.
fn or_null<T>(value: &JsValue, read: Option<T>) -> Option<Option<T>> {
    if value.is_null() { Some(None) } else { read.map(Some) }
}

/// `"free"`, a number, or `[min, max]`.
fn scale_of(value: &JsValue) -> Option<ScaleOption> {
    if value.as_string().as_deref() == Some("free") {
        return Some(ScaleOption::Free);
    }
    let fixed = value.as_f64().map(ScaleOption::Fixed);
    fixed.or_else(|| to_numbers(value, "").ok().map(ScaleOption::Between))
}

/// Minimum similarity of a name, 0 to 1, for it to be suggested.
const MISSPELT: f64 = 0.6;

fn unknown_option(name: &str, known: &[&str]) -> Error {
    let likeness = |known: &&&str| strsim::normalized_levenshtein(name, known);
    let nearest = known.iter().max_by(|a, b| likeness(a).total_cmp(&likeness(b)));
    let remedy = match nearest {
        Some(nearest) if likeness(&nearest) >= MISSPELT => format!("Did you mean `{nearest}`?"),
        _ => "Check the spelling.".to_owned(),
    };
    Error::new(
        ErrorCode::UnknownOption,
        format!("options.{name}"),
        "an unknown option",
        format!("one of {}", known.join(", ")),
        remedy,
    )
}

/// The named symmetries.
const SYMMETRY_NAMES: [(&str, Symmetry); 2] = [("none", Symmetry::None), ("auto", Symmetry::Auto)];

/// `"none"`, `"auto"`, or `[{ axis, fold? }]`.
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
            "The axis is a direction in the mesh frame.",
        )
    };
    let axis = nalgebra::Vector3::from(axis);
    if !(axis.norm().is_finite() && axis.norm() > 0.0) {
        return Err(invalid("options.symmetry.axis", numbers(axis.as_slice()), "a direction other than 0"));
    }
    let fold = match fold {
        None => None,
        Some(fold) if (2.0..=360.0).contains(&fold) && fold.fract() == 0.0 => Some(fold as u32),
        Some(fold) => return Err(invalid("options.symmetry.fold", number_text(fold), "an integer from 2 to 360")),
    };
    Ok(SymmetryAxis { axis, fold })
}
