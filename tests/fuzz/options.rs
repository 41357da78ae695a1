//! Options of every type, and transforms.

use nalgebra::{Matrix3, Vector3};
use sim3align::geometry::rotations::super_fibonacci;
use sim3align::geometry::similarity::Similarity;
use sim3align::metrics::symmetry::{Symmetry, SymmetryAxis};
use sim3align::options::scale::ScaleOption;
use sim3align::options::{Field, Options};

use crate::entropy::Entropy;

/// Options of which up to four differ from the defaults; integers are at most `most`, as far as their range allows.
pub fn options<O: Options>(e: &mut Entropy<'_>, most: u32) -> O {
    let mut options = O::default();
    for _ in 0..e.below(8).saturating_sub(3) {
        let at = e.below(O::NAMES.len());
        if let Some(field) = options.fields().into_iter().nth(at) {
            change(e, field, most);
        }
    }
    options
}

fn change(e: &mut Entropy<'_>, field: Field<'_>, most: u32) {
    match field {
        Field::Count(value, range) => {
            let (low, high) = (*range.start(), (*range.end()).min(most.max(*range.start())));
            *value = e.pick(&[low, high, low / 2 + high / 2, low.wrapping_sub(1)]);
        }
        Field::Number(value, range) => *value = number_in(e, *range.start(), *range.end()),
        Field::OptionalNumber(value, range) => {
            *value = (!e.once_in(4)).then(|| number_in(e, *range.start(), *range.end()));
        }
        Field::Positive(value) => *value = Some(e.number()),
        Field::Flag(value) => *value = !*value,
        Field::Scale(value) => {
            *value = match e.below(3) {
                0 => ScaleOption::Fixed(e.number()),
                1 => ScaleOption::Between([e.number(), e.number()]),
                _ => ScaleOption::Free,
            };
        }
        Field::Direction(value) => *value = Some([e.number(), e.number(), e.number()]),
        Field::Symmetry(value) => *value = symmetry(e),
        Field::Transform(value) => *value = Some(transform(e)),
        Field::Guard(value) => *value = (!e.once_in(4)).then(|| [e.number(), e.number()]),
        Field::Choice(choice) => {
            let names = choice.names();
            choice.set(e.pick(names));
        }
    }
}

fn number_in(e: &mut Entropy<'_>, low: f64, high: f64) -> f64 {
    let any = e.number();
    e.pick(&[low, high, low / 2.0 + high / 2.0, any])
}

/// A symmetry, also one that no object has.
fn symmetry(e: &mut Entropy<'_>) -> Symmetry {
    let axis = |e: &mut Entropy<'_>| SymmetryAxis {
        axis: Vector3::new(e.number(), e.number(), e.number()),
        fold: e.pick(&[Some(2), None, Some(1), Some(0), Some(4), Some(360), Some(u32::MAX)]),
    };
    match e.below(3) {
        0 => Symmetry::Auto,
        1 => Symmetry::None,
        _ => Symmetry::Declared((0..1 + e.below(3)).map(|_| axis(e)).collect()),
    }
}

/// A transform that the package accepts; mostly one that puts a mesh of size 1 in front of the camera.
pub fn transform(e: &mut Entropy<'_>) -> Similarity {
    let turn = super_fibonacci(e.below(100), 100).to_array();
    let rotation = Similarity::rotation_from_xyzw(&turn).unwrap_or_else(|_| Matrix3::identity());
    let [x, y] = [e.below(21), e.below(21)].map(|k| 0.1 * k as f64 - 1.0);
    let z = e.pick(&[1.0, 2.0, 0.5, 0.1, 0.01, 10.0, -1.0, 0.0]);
    let translation = Vector3::new(x, y, z) * e.power(12);
    let scale = 0.01 * e.size(1, 100) as f64 * e.power(12);
    Similarity::from_parts(scale, rotation, translation).unwrap_or_else(|_| Similarity::identity())
}
