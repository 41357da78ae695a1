//! Images: what a reading is, sizes, resampling, distances, and the outline of a mask.

use sim3align::geometry::distance_transform::{NO_PIXEL, squared_distances, within};
use sim3align::precise::observation::clean::CleanObservation;

use crate::prelude::*;
use crate::shapes::view;

#[wasm_bindgen_test]
fn depths_that_are_no_reading_become_0() {
    let raw = [1.5, 0.0, -0.0, -2.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MIN_POSITIVE, f32::MAX];
    let depth = DepthMap::from_metres(3, 3, raw.to_vec()).unwrap();
    let bits: Vec<u32> = depth.data().iter().map(|z| z.to_bits()).collect();
    assert_eq!(bits, [1.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, f32::MIN_POSITIVE, f32::MAX].map(f32::to_bits));
}

#[wasm_bindgen_test]
fn sizes_and_lengths_belong_together() {
    for (width, height, length, code) in [
        (0, 4, 0, ErrorCode::EmptyImage),
        (4, 3, 11, ErrorCode::WrongLength),
        // A product that overflows to 0.
        (1 << (usize::BITS / 2), 1 << (usize::BITS / 2), 0, ErrorCode::WrongLength),
    ] {
        let error = Mask::new("mask", width, height, vec![0; length]).unwrap_err();
        assert_eq!((error.code, &*error.argument), (code, "mask"), "{width} × {height}");
        let error = DepthMap::from_metres(width, height, vec![0.0; length]).unwrap_err();
        assert_eq!((error.code, &*error.argument), (code, "depth"), "{width} × {height}");
    }
}

#[wasm_bindgen_test]
fn resampling_takes_the_pixel_under_the_centre() {
    for (from, to) in [(5, 7), (7, 5), (640, 518), (518, 640), (1, 9), (9, 1), (1000, 999)] {
        let expected = |i: usize| ((i as f64 + 0.5) * from as f64 / to as f64).floor() as usize;
        let line = Image::new("x", from, 1, (0..from).collect()).unwrap().resize_nearest(to, 1);
        let column = Image::new("x", 1, from, (0..from).collect()).unwrap().resize_nearest(1, to);
        assert!(line.data() == column.data() && line.data().iter().copied().eq((0..to).map(expected)), "{from} → {to}");
    }
}

fn distances_by_search(set: &[bool], width: usize) -> Vec<u32> {
    let at = |i: usize| ((i % width) as i64, (i / width) as i64);
    let distance = |i: usize, j: usize| {
        let ((a, b), (c, d)) = (at(i), at(j));
        ((a - c) * (a - c) + (b - d) * (b - d)) as u32
    };
    (0..set.len())
        .map(|i| (0..set.len()).filter(|&j| set[j]).map(|j| distance(i, j)).min().unwrap_or(NO_PIXEL))
        .collect()
}

#[wasm_bindgen_test]
fn distances_are_those_of_an_exhaustive_search() {
    for seed in 0..100 {
        let mut random = Random::new(seed, 910);
        let (width, height) = (1 + random.below(24), 1 + random.below(24));
        let density = [0.003, 0.02, 0.2, 0.9][seed as usize % 4];
        let set: Vec<bool> = (0..width * height).map(|_| random.uniform() < density).collect();
        let expected = distances_by_search(&set, width);
        assert_eq!(squared_distances(&set, width, height), expected, "seed {seed}, {width} × {height}");
        for radius in [0, 1, 3, 7, 40, 100_000] {
            let near: Vec<bool> =
                expected.iter().map(|d| u64::from(*d) <= (radius * radius).min(u64::from(NO_PIXEL) - 1)).collect();
            let found = within(radius as u32, &set, width, height);
            assert_eq!(found, near, "seed {seed}, {width} × {height}, radius {radius}");
        }
    }
}

const WIDTH: usize = 120;
const HEIGHT: usize = 90;

/// Discs that overlap: one connected mask without holes.
fn blob(draw: &mut Draw) -> impl Fn(usize, usize) -> bool + use<> {
    let discs: Vec<[f64; 3]> = (0..4)
        .map(|_| [60.0 + draw.between(-12.0, 12.0), 45.0 + draw.between(-9.0, 9.0), draw.between(12.0, 18.0)])
        .collect();
    move |u, v| {
        let inside = |disc: &[f64; 3]| DVec2::new(u as f64 - disc[0], v as f64 - disc[1]).length() < disc[2];
        discs.iter().any(inside)
    }
}

#[wasm_bindgen_test]
fn the_outline_is_the_distance_to_the_rim_of_the_mask() {
    // Pixels that are not square.
    let camera = Pinhole::new(150.0, 130.0, 57.3, 46.1).unwrap();
    for seed in 0..3 {
        let mask = blob(&mut Draw::new(seed));
        // A wall without an edge: the depth has no outline of its own.
        let clean = CleanObservation::new(
            &view(camera, [WIDTH, HEIGHT], &mask, |u, v| 0.5 + 1e-4 * (u % 3 + v % 2) as f32).unwrap(),
        );
        assert_eq!(clean.boundary_offset, 0.0, "seed {seed}");
        let pixels: Vec<(usize, usize)> = (0..WIDTH * HEIGHT).map(|i| (i % WIDTH, i / WIDTH)).collect();
        let (inside, outside): (Vec<_>, Vec<_>) = pixels.into_iter().partition(|&(u, v)| mask(u, v));
        assert_eq!(clean.pixels, inside.len(), "seed {seed}");
        let nearest = |to: &[(usize, usize)], u: usize, v: usize| {
            let squared = to.iter().map(|&(x, y)| (x.abs_diff(u).pow(2) + y.abs_diff(v).pow(2)) as f64);
            squared.fold(f64::INFINITY, f64::min).sqrt()
        };
        for (i, found) in clean.outline.iter().enumerate() {
            let (u, v) = (clean.origin[0] + i % clean.width, clean.origin[1] + i / clean.width);
            let expected = if mask(u, v) { 0.5 - nearest(&outside, u, v) } else { nearest(&inside, u, v) - 0.5 };
            assert!((f64::from(*found) - expected).abs() < 1e-5, "seed {seed}, ({u}, {v}): {found} for {expected}");
        }
        for (axis, at) in
            [(0, inside.iter().map(|p| p.0).collect::<Vec<_>>()), (1, inside.iter().map(|p| p.1).collect())]
        {
            let bounds = [*at.iter().min().unwrap() as f64, *at.iter().max().unwrap() as f64];
            assert_eq!(clean.bounds[axis], bounds, "seed {seed}");
        }
    }
}
