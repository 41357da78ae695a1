//! The observation: back-projection by hand, subsampling, what is refused, point maps.

use sim3align::evidence::observation::{MIN_POINTS, from_point_map};

use crate::prelude::*;

fn camera() -> Pinhole {
    Pinhole::new(2.0, 4.0, 1.0, 1.0).unwrap()
}

/// Three columns, as many rows as it takes; depths 1, 2, 3, … and a mask over everything.
fn small() -> (Vec<f32>, Vec<u8>, usize) {
    let height = 2 + MIN_POINTS.div_ceil(3);
    ((0..3 * height).map(|i| 1.0 + i as f32).collect(), vec![1; 3 * height], height)
}

fn observe(depth: Vec<f32>, mask: Vec<u8>, height: usize) -> sim3align::error::Result<Observation> {
    let width = depth.len() / height;
    Observation::new(
        DepthMap::from_metres(width, height, depth).unwrap(),
        Mask::new("mask", width, height, mask).unwrap(),
        camera(),
    )
}

#[wasm_bindgen_test(unsupported = test)]
fn points_by_hand() {
    let (mut depth, mut mask, height) = small();
    // In the upper 3 × 3 pixels: one outside the mask, one without a reading, one mask value other than 1.
    mask[4] = 0;
    depth[7] = f32::NAN;
    mask[8] = 255;
    let observation = observe(depth, mask, height).unwrap();
    let cloud = observation.cloud(1000, 0);
    // x = (u − 1)·z/2, y = (v − 1)·z/4.
    let expected = [
        Vec3::new(-0.5, -0.25, 1.0),
        Vec3::new(0.0, -0.5, 2.0),
        Vec3::new(1.5, -0.75, 3.0),
        Vec3::new(-2.0, 0.0, 4.0),
        Vec3::new(3.0, 0.0, 6.0),
        Vec3::new(-3.5, 1.75, 7.0),
        Vec3::new(4.5, 2.25, 9.0),
        Vec3::new(-5.0, 5.0, 10.0),
    ];
    assert_eq!(cloud.points[..8], expected);
    assert_eq!(cloud.len(), 3 * height - 2);
    assert!(cloud.normals.is_empty());
    assert_eq!(observation.camera(), camera());
    assert_eq!((observation.depth().get(1, 2), observation.mask().get(1, 1)), (Some(0.0), Some(0)));
}

#[wasm_bindgen_test(unsupported = test)]
fn subsampling_takes_one_of_each_run() {
    // VGA, all of it object but the last row: the product of both counts is beyond 32 bits.
    let (width, height, max_points) = (640, 480, 20_000);
    let n = width * (height - 1);
    let depth: Vec<f32> = (0..width * height).map(|i| 1.0 + i as f32 * 1e-6).collect();
    let mask: Vec<u8> = (0..width * height).map(|i| u8::from(i < n)).collect();
    let depth = DepthMap::from_metres(width, height, depth).unwrap();
    let mask = Mask::new("mask", width, height, mask).unwrap();
    let observation = Observation::new(depth, mask, Pinhole::new(500.0, 500.0, 319.5, 239.5).unwrap()).unwrap();
    let index = |p: &Vec3| ((p.z - 1.0) * 1e6).round() as usize;
    for seed in [0, 1, 77] {
        let cloud = observation.cloud(max_points, seed);
        assert_eq!(cloud.len(), max_points, "seed {seed}");
        assert_eq!(cloud, observation.cloud(max_points, seed), "seed {seed}");
        assert_ne!(cloud, observation.cloud(max_points, seed + 1), "seed {seed}");
        for (k, p) in cloud.points.iter().enumerate() {
            // Within the k-th run of 15.3 pixels; depths as f32 tell neighbours apart to a tenth.
            let run = n as f64 / max_points as f64;
            let place = index(p) as f64 - k as f64 * run;
            assert!(place > -1.5 && place < run + 1.5, "seed {seed}: point {k} from pixel {}", index(p));
            assert!(index(p) < n, "seed {seed}: {p} lies outside the mask");
        }
    }
    assert!(observation.cloud(0, 0).is_empty());
    assert_eq!(observation.cloud(n, 0).len(), n);
    assert_eq!(observation.cloud(n - 1, 0).len(), n - 1);
}

#[wasm_bindgen_test(unsupported = test)]
fn what_shows_no_object_is_refused() {
    let (depth, mask, height) = small();
    let refused = |depth: &[f32], mask: &[u8], code: ErrorCode, argument: &str, found: &str| {
        let error = observe(depth.to_vec(), mask.to_vec(), height).unwrap_err();
        assert_eq!((error.code, &*error.argument), (code, argument));
        assert!(error.found.contains(found), "{error}");
    };
    let n = depth.len();
    refused(&depth, &vec![0; n], ErrorCode::EmptyMask, "mask", "no non-zero pixel");
    refused(&vec![0.0; n], &mask, ErrorCode::NoDepthInMask, "depth", &format!("{n} pixels"));
    let hole: Vec<f32> = depth.iter().map(|&z| if z > 20.0 { z } else { f32::NAN }).collect();
    let there: Vec<u8> = depth.iter().map(|&z| u8::from(z <= 20.0)).collect();
    refused(&hole, &there, ErrorCode::NoDepthInMask, "depth", "20 pixels");
    refused(&vec![0.7; n], &mask, ErrorCode::FlatDepth, "depth", "0.7 m in all");
    let mut few = mask.clone();
    few[MIN_POINTS - 1..].fill(0);
    refused(&depth, &few, ErrorCode::TooFewPoints, "depth", &format!("{} readings", MIN_POINTS - 1));
    few[MIN_POINTS - 1] = 1;
    assert!(observe(depth.clone(), few, height).is_ok());
    // Constant outside the mask alone, and constant but for one pixel inside it, are measurements.
    let mut nearly_flat = vec![0.7; n];
    nearly_flat[5] = 0.71;
    assert!(observe(nearly_flat, mask.clone(), height).is_ok());

    let depth = DepthMap::from_metres(3, height, depth).unwrap();
    let mask = Mask::new("mask", height, 3, mask).unwrap();
    let error = Observation::new(depth, mask, camera()).unwrap_err();
    assert_eq!((error.code, &*error.argument), (ErrorCode::SizeMismatch, "mask"));
    let (one, other) = (format!("3 × {height}"), format!("{height} × 3"));
    assert!(error.found.contains(&one) && error.found.contains(&other), "{error}");
}

/// The points of a bumpy surface, with holes, seen by a camera.
fn point_map(camera: &Pinhole, width: usize, height: usize, draw: &mut Draw) -> Vec<f32> {
    let mut map = Vec::new();
    for i in 0..width * height {
        let z = draw.between(1.0, 3.0);
        let p = camera.back_project((i % width) as f64, (i / width) as f64, z).to_array();
        map.extend(if draw.below(5) == 0 { [f32::NAN, 0.0, f32::INFINITY] } else { p });
    }
    map
}

#[wasm_bindgen_test(unsupported = test)]
fn a_point_map_tells_its_camera() {
    for seed in 0..10 {
        let mut draw = Draw::new(seed);
        let f = draw.between(30.0, 300.0);
        let truth = Pinhole::new(f, 1.1 * f, draw.between(10.0, 30.0), draw.between(10.0, 20.0)).unwrap();
        let map = point_map(&truth, 40, 30, &mut draw);
        let (depth, found) = from_point_map(40, 30, &map).unwrap();
        let pairs = [(found.fx, truth.fx), (found.fy, truth.fy), (found.cx, truth.cx), (found.cy, truth.cy)];
        for (found, truth) in pairs {
            assert!((found - truth).abs() < 1e-4 * truth, "seed {seed}: {found} for {truth}");
        }
        for (p, z) in map.chunks_exact(3).zip(depth.data()) {
            assert_eq!(*z, if p[0].is_nan() { 0.0 } else { p[2] }, "seed {seed}");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn point_maps_of_other_frames_are_refused() {
    let camera = Pinhole::new(50.0, 50.0, 20.0, 15.0).unwrap();
    let map = point_map(&camera, 40, 30, &mut Draw::new(1));
    let signed = |signs: [f32; 3]| -> Vec<f32> {
        map.chunks_exact(3).flat_map(|p| [p[0] * signs[0], p[1] * signs[1], p[2] * signs[2]]).collect()
    };
    let refused = |width: usize, height: usize, points: &[f32], code: ErrorCode| {
        let error = from_point_map(width, height, points).unwrap_err();
        assert_eq!((error.code, &*error.argument), (code, "pointMap"), "{error}");
    };
    assert!(from_point_map(40, 30, &map).is_ok());
    refused(40, 30, &signed([-1.0, -1.0, 1.0]), ErrorCode::InvalidCamera);
    refused(40, 30, &signed([1.0, -1.0, 1.0]), ErrorCode::InvalidCamera);
    refused(40, 30, &signed([1.0, -1.0, -1.0]), ErrorCode::NoDepthInMask);
    refused(40, 30, &vec![f32::NAN; map.len()], ErrorCode::NoDepthInMask);
    refused(40, 30, &vec![1.0; map.len()], ErrorCode::InvalidCamera);
    refused(40, 30, &map[..map.len() - 1], ErrorCode::WrongLength);
    refused(40, 29, &map, ErrorCode::WrongLength);
    refused(0, 30, &[], ErrorCode::EmptyImage);
    // One column, one row, one reading: no telling the focal length.
    refused(1, 30, &map[..90], ErrorCode::InvalidCamera);
    refused(40, 1, &map[..120], ErrorCode::InvalidCamera);
}
