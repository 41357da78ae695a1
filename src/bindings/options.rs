//! Options from JavaScript objects: types and names are checked here, ranges where the options live.

use js_sys::{Array, Object, Reflect};
use serde::de::{DeserializeOwned, Deserializer, Visitor};
use serde::forward_to_deserialize_any;
use wasm_bindgen::{JsCast, JsValue};

use super::object::{get, number, to_number, to_numbers, wrong_type};
use super::transform::similarity;
use crate::align::evaluate::Truth;
use crate::align::options::ScaleOption;
use crate::error::{Error, ErrorCode, Result};
use crate::metrics::symmetry::{Symmetry, SymmetryAxis};

/// An options struct from an object; `also` names the keys that are read apart from the struct.
pub fn options<T: DeserializeOwned + Default>(value: &JsValue, also: &[&str]) -> Result<T> {
    if value.is_undefined() || value.is_null() {
        return Ok(T::default());
    }
    if !value.is_object() || Array::is_array(value) {
        return Err(wrong_type("options", value, "an object", "Leave it out to take all defaults."));
    }
    let known = field_names::<T>();
    // A key that is there but undefined (`{ seed: maybe }`) means the default, as everywhere in JavaScript.
    let given = Object::new();
    for key in Object::keys(value.unchecked_ref::<Object>()).iter() {
        let name = key.as_string().unwrap_or_default();
        let field = Reflect::get(value, &key).unwrap_or(JsValue::UNDEFINED);
        if field.is_undefined() || also.contains(&name.as_str()) {
            continue;
        }
        if !known.contains(&name.as_str()) {
            return Err(unknown_option(&name, known.iter().chain(also)));
        }
        check_type::<T>(&name, &field)?;
        let _ = Reflect::set(&given, &key, &field);
    }
    serde_wasm_bindgen::from_value(given.into())
        .map_err(|e| not_of_type("options", &JsValue::UNDEFINED, &e.to_string()))
}

/// Deserialises one field alone, so that an error can name it.
fn check_type<T: DeserializeOwned>(name: &str, field: &JsValue) -> Result<()> {
    let alone = Object::new();
    let _ = Reflect::set(&alone, &name.into(), field);
    let parsed: core::result::Result<T, _> = serde_wasm_bindgen::from_value(alone.into());
    parsed.map(|_| ()).map_err(|e| not_of_type(&format!("options.{name}"), field, &e.to_string()))
}

fn not_of_type(argument: &str, found: &JsValue, reason: &str) -> Error {
    let remedy = "Leave the option out to take its default.";
    let error = wrong_type(argument, found, &format!("another value ({reason})"), remedy);
    Error { code: ErrorCode::InvalidOption, ..error }
}

fn unknown_option<'a>(name: &str, known: impl Iterator<Item = &'a &'a str>) -> Error {
    let names: Vec<&str> = known.copied().collect();
    let nearest = names.iter().min_by_key(|known| edit_distance(name, known)).copied().unwrap_or_default();
    Error::new(
        ErrorCode::UnknownOption,
        format!("options.{name}"),
        "an option that does not exist",
        format!("one of {}", names.join(", ")),
        format!("Did you mean `{nearest}`?"),
    )
}

/// Levenshtein's distance.
fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
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
            return Err(Error { code: ErrorCode::InvalidOption, ..error });
        }
    };
    Ok(scale)
}

/// The true transform and the symmetry of `evaluate`'s options.
pub fn truth(options: &JsValue) -> Result<Option<Truth>> {
    let Some(value) = get(options, "truth") else { return Ok(None) };
    let camera_from_mesh = similarity(&value, "options.truth")?;
    Ok(Some(Truth { camera_from_mesh, symmetry: symmetry(options)? }))
}

/// `"none"`, `"auto"`, `"auto-revolution"`, or `[{ axis, fold? }]`.
fn symmetry(options: &JsValue) -> Result<Symmetry> {
    let Some(value) = get(options, "symmetry") else { return Ok(Symmetry::None) };
    match value.as_string().as_deref() {
        Some("none") => return Ok(Symmetry::None),
        Some("auto") => return Ok(Symmetry::Auto),
        Some("auto-revolution") => return Ok(Symmetry::AutoRevolution),
        _ => {}
    }
    if !Array::is_array(&value) {
        let remedy = "A missing fold declares a continuous symmetry about the axis.";
        let error = wrong_type(
            "options.symmetry",
            &value,
            "\"none\", \"auto\", \"auto-revolution\" or [{ axis: [x, y, z], fold? }]",
            remedy,
        );
        return Err(Error { code: ErrorCode::InvalidOption, ..error });
    }
    let array = Array::from(&value);
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
        Error::new(ErrorCode::InvalidOption, argument, found, expected, "The axis is a direction in the mesh's frame.")
    };
    let axis = nalgebra::Vector3::from(axis);
    if !(axis.norm().is_finite() && axis.norm() > 0.0) {
        return Err(invalid("options.symmetry.axis", format!("{axis:?}"), "a direction other than 0"));
    }
    let fold = match fold {
        None => None,
        Some(fold) if (2.0..=360.0).contains(&fold) && fold.fract() == 0.0 => Some(fold as u32),
        Some(fold) => return Err(invalid("options.symmetry.fold", format!("{fold}"), "a whole number from 2 to 360")),
    };
    Ok(SymmetryAxis { axis, fold })
}

/// The names of a struct's fields as serde spells them.
fn field_names<T: DeserializeOwned>() -> &'static [&'static str] {
    let mut names: &'static [&'static str] = &[];
    // Ends in an error by design: it only listens to what the struct asks for.
    let _ = T::deserialize(FieldNames(&mut names));
    names
}

struct FieldNames<'a>(&'a mut &'static [&'static str]);

impl<'de> Deserializer<'de> for FieldNames<'_> {
    type Error = serde::de::value::Error;

    fn deserialize_any<V: Visitor<'de>>(self, _visitor: V) -> core::result::Result<V::Value, Self::Error> {
        Err(serde::de::Error::custom("not a struct"))
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> core::result::Result<V::Value, Self::Error> {
        *self.0 = fields;
        self.deserialize_any(visitor)
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option unit
        unit_struct newtype_struct seq tuple tuple_struct map enum identifier ignored_any
    }
}
