//! Point clouds, interleaved x, y, z.

use super::choices::Choices;
use super::options::{any_number, transform};
use crate::prelude::*;

/// Two clouds of at most `most` points, and a description of them.
pub fn pair(c: &mut Choices, most: usize) -> (String, [Vec<f64>; 2]) {
    let (source_words, source) = cloud(c, most);
    let (target_words, target) = match c.below(3) {
        // The same points, moved.
        0 | 1 => {
            let pose = transform(c);
            let moved = source.chunks_exact(3).flat_map(|p| {
                let q = pose.apply(Vector3::new(p[0], p[1], p[2]));
                [q.x, q.y, q.z]
            });
            ("the same, moved".into(), moved.collect())
        }
        _ => cloud(c, most),
    };
    (format!("{source_words}; {target_words}"), [source, target])
}

fn cloud(c: &mut Choices, most: usize) -> (String, Vec<f64>) {
    let count = if c.once_in(16) { c.below(40) } else { c.size(32, most) };
    let mut random = c.noise();
    let kind = c.below(9);
    let mut points: Vec<f64> = (0..count).flat_map(|i| point(&mut random, kind, i)).collect();
    let unit = c.power(30);
    let far = if c.once_in(8) { c.pick(&[10.0, 1e3, 1e6, 1e12]) } else { 0.0 };
    points.iter_mut().for_each(|x| *x = (*x + far) * unit);
    match c.below(16) {
        14 => {
            let hostile = any_number(c);
            points.iter_mut().take(1).for_each(|x| *x = hostile);
        }
        15 => drop(points.pop()),
        _ => {}
    }
    let name =
        ["bumpy surface", "random", "plane", "line", "one point", "grid", "clusters", "two points", "helix"][kind];
    (format!("{name} of {count} points × {unit:e} from {far}"), points)
}

fn point(random: &mut Random, kind: usize, i: usize) -> [f64; 3] {
    let [x, y, z] = [random.uniform(), random.uniform(), random.uniform()];
    let s = i as f64;
    match kind {
        0 => [x, y, 0.2 * libm::sin(5.0 * x) * libm::cos(7.0 * y) + 0.3 * x * y],
        1 => [x, y, z],
        2 => [x, y, 0.0],
        3 => [x, 2.0 * x, -x],
        4 => [0.5; 3],
        5 => [(i % 10) as f64, (i / 10 % 10) as f64, (i / 100) as f64],
        6 => [(i % 3) as f64 + 1e-6 * x, (i % 2) as f64 + 1e-6 * y, 1e-6 * z],
        7 => [(i % 2) as f64; 3],
        _ => [libm::cos(0.1 * s), libm::sin(0.1 * s), 0.01 * s],
    }
}
