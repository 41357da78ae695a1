//! What results are as plain values.

use sim3align::align::report::{Alternative, Sim3, Warning, WarningCode};
use sim3align::bindings::value::Value;
use sim3align::geometry::similarity::Similarity;
use wasm_bindgen_test::wasm_bindgen_test;

fn numbers(values: &[f64]) -> Value {
    Value::List(values.iter().map(|&x| Value::Number(x)).collect())
}

fn names(value: &Value) -> Vec<&str> {
    let Value::Record(fields) = value else { panic!("{value:?}") };
    fields.iter().map(|(name, _)| name.as_str()).collect()
}

#[wasm_bindgen_test(unsupported = test)]
fn a_flattened_transform_lies_beside_its_neighbours() {
    let camera_from_mesh = Sim3::from(&Similarity::identity());
    let tree = Value::of(&Alternative { camera_from_mesh, score: 1.5, turn_deg: 180.0 });
    assert_eq!(names(&tree), ["scale", "rotation", "rotationMatrix", "translation", "matrix", "score", "turnDeg"]);
    let Value::Record(fields) = tree else { unreachable!() };
    assert_eq!(fields[0].1, Value::Number(1.0));
    assert_eq!(fields[1].1, numbers(&[0.0, 0.0, 0.0, 1.0]));
    let rows = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    assert_eq!(fields[2].1, Value::List(rows.iter().map(|row| numbers(row)).collect()));
    assert_eq!(fields[5].1, Value::Number(1.5));
}

#[wasm_bindgen_test(unsupported = test)]
fn options_sequences_and_variants_are_plain() {
    assert_eq!(Value::of(&None::<f64>), Value::Null);
    assert_eq!(Value::of(&Some(true)), Value::Flag(true));
    let warning = Warning { code: WarningCode::ScaleClamped, message: "m".into() };
    let text = |text: &str| Value::Text(text.into());
    let expected = Value::Record(vec![("code".into(), text("SCALE_CLAMPED")), ("message".into(), text("m"))]);
    assert_eq!(Value::of(&vec![warning]), Value::List(vec![expected]));
}

#[wasm_bindgen_test(unsupported = test)]
fn a_tree_serialises_as_what_it_was_made_of() {
    let camera_from_mesh = Sim3::from(&Similarity::identity());
    let alternative = Alternative { camera_from_mesh, score: 0.25, turn_deg: 90.5 };
    let direct = serde_json::to_value(&alternative).unwrap();
    assert_eq!(serde_json::to_value(Value::of(&alternative)).unwrap(), direct);
}
