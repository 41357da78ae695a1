//! The distance transform against a search of every pixel.

use sim3align::geometry::distance_transform::{NO_PIXEL, squared_distances, within};

use crate::prelude::*;

fn by_search(set: &[bool], width: usize) -> Vec<u32> {
    let at = |i: usize| ((i % width) as i64, (i / width) as i64);
    let distance = |i: usize, j: usize| {
        let ((a, b), (c, d)) = (at(i), at(j));
        ((a - c) * (a - c) + (b - d) * (b - d)) as u32
    };
    (0..set.len())
        .map(|i| (0..set.len()).filter(|&j| set[j]).map(|j| distance(i, j)).min().unwrap_or(NO_PIXEL))
        .collect()
}

#[wasm_bindgen_test(unsupported = test)]
fn equals_an_exhaustive_search() {
    for seed in 0..300 {
        let mut random = Random::new(seed, 910);
        let (width, height) = (1 + random.below(24), 1 + random.below(24));
        let density = [0.003, 0.02, 0.2, 0.9][seed as usize % 4];
        let set: Vec<bool> = (0..width * height).map(|_| random.uniform() < density).collect();
        let expected = by_search(&set, width);
        assert_eq!(squared_distances(&set, width, height), expected, "seed {seed}, {width} × {height}");
        for radius in [0, 1, 3, 7, 40, 100_000] {
            let near: Vec<bool> =
                expected.iter().map(|d| u64::from(*d) <= (radius * radius).min(u64::from(NO_PIXEL) - 1)).collect();
            let found = within(radius as u32, &set, width, height);
            assert_eq!(found, near, "seed {seed}, {width} × {height}, radius {radius}");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn an_image_without_a_pixel_has_no_distance() {
    assert_eq!(squared_distances(&[false; 6], 3, 2), [NO_PIXEL; 6]);
    assert_eq!(within(3, &[false; 6], 3, 2), [false; 6]);
    assert!(squared_distances(&[], 0, 0).is_empty());
    assert!(within(3, &[], 0, 0).is_empty());
}
