//! Options of every type.

use sim3align::options::{Field, Options};
use sim3align_geometry::rotations::super_fibonacci;

use super::choices::Choices;
use crate::prelude::*;

/// Numbers that may replace any number.
const NUMBERS: [f64; 16] = [
    1.0,
    0.0,
    -1.0,
    0.5,
    2.0,
    1e-3,
    1e3,
    1e-9,
    1e9,
    1e-30,
    1e30,
    1e-300,
    1e300,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
];

/// Any number, mostly an ordinary one.
pub fn any_number(c: &mut Choices) -> f64 {
    if c.once_in(4) { c.pick(&NUMBERS) } else { 0.01 * c.size(1, 1000) as f64 }
}

/// Options of which `changed` differ from the defaults; integers are at most `most`, as far as their range allows.
pub fn options<O: Options>(c: &mut Choices, changed: usize, most: u32) -> O {
    let mut options = O::default();
    let count = O::FIELDS.len();
    for _ in 0..changed {
        let at = c.below(count);
        if let Some(field) = options.fields().into_iter().nth(at) {
            change(c, field, most);
        }
    }
    options
}

fn change(c: &mut Choices, field: Field<'_>, most: u32) {
    match field {
        Field::Count(value, range) => {
            let (low, high) = (*range.start(), (*range.end()).min(most.max(*range.start())));
            *value = match c.below(4) {
                0 => low,
                1 => high,
                2 => c.size(low as usize, high as usize) as u32,
                _ if c.once_in(4) => range.start().wrapping_sub(1),
                _ => low / 2 + high / 2,
            };
        }
        Field::Number(value, range) => *value = number_in(c, *range.start(), *range.end()),
        Field::OptionalNumber(value, range) => {
            *value = (!c.once_in(4)).then(|| number_in(c, *range.start(), *range.end()));
        }
        Field::Positive(value) => *value = Some(any_number(c)),
        Field::Flag(value) => *value = !*value,
        Field::Scale(value) => {
            *value = match c.below(3) {
                0 => ScaleOption::Fixed(any_number(c)),
                1 => ScaleOption::Between([any_number(c), any_number(c)]),
                _ => ScaleOption::Free,
            };
        }
        Field::Direction(value) => *value = Some([any_number(c), any_number(c), any_number(c)]),
        Field::Symmetry(value) => *value = symmetry(c),
        Field::Transform(value) => *value = Some(transform(c)),
        Field::Guard(value) => *value = (!c.once_in(4)).then(|| [any_number(c), any_number(c)]),
        Field::Choice(choice) => {
            let names = choice.names();
            choice.set(c.pick(names));
        }
    }
}

fn number_in(c: &mut Choices, low: f64, high: f64) -> f64 {
    match c.below(4) {
        0 => low,
        1 => high,
        2 => low + (high - low) * c.share(),
        _ => any_number(c),
    }
}

/// A symmetry, also one that no object has.
pub fn symmetry(c: &mut Choices) -> Symmetry {
    match c.below(3) {
        0 => Symmetry::Auto,
        1 => Symmetry::None,
        _ => {
            let axes = 1 + c.below(3);
            let axis = |c: &mut Choices| SymmetryAxis {
                axis: Vector3::new(any_number(c), any_number(c), any_number(c)),
                fold: c.pick(&[Some(2), None, Some(1), Some(0), Some(4), Some(360), Some(u32::MAX)]),
            };
            Symmetry::Declared((0..axes).map(|_| axis(c)).collect())
        }
    }
}

/// A transform: mostly one that puts a mesh of size 1 in front of the camera, and always one that the package accepts.
pub fn transform(c: &mut Choices) -> Similarity {
    let turn = super_fibonacci(c.below(100), 100).to_array();
    let rotation = Similarity::rotation_from_xyzw(&turn).unwrap_or_else(|_| Matrix3::identity());
    let [x, y] = [c.below(21), c.below(21)].map(|k| 0.1 * k as f64 - 1.0);
    let z = c.pick(&[1.0, 2.0, 0.5, 0.1, 0.01, 10.0, -1.0, 0.0]);
    let translation = Vector3::new(x, y, z) * c.power(12);
    let scale = 0.01 * c.size(1, 100) as f64 * c.power(12);
    Similarity::from_parts(scale, rotation, translation).unwrap_or_else(|_| Similarity::identity())
}
