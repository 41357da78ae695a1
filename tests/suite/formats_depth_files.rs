//! Depth in the files of depth models, as their libraries wrote them (tests/fixtures/make_depth_files.py).

use sim3align::geometry::depth_kind::DepthKind;
use sim3align_formats::depth::{DepthImage, DepthReadOptions, read_depth};
use sim3align_formats::depth_files::read_depth_file;

use crate::formats_fixtures::fixture;
use crate::prelude::*;

const SIZE: [usize; 2] = [37, 23];

const FILES: [(&str, &[u8]); 8] = [
    ("Depth Pro", fixture!("depth-depth-pro.npz")),
    ("MoGe", fixture!("depth-moge.npz")),
    ("Depth Anything 3", fixture!("depth-da3.npz")),
    ("OpenCV", fixture!("depth-opencv.exr")),
    ("Blender", fixture!("depth-blender.exr")),
    ("tifffile", fixture!("depth-float32.tiff")),
    ("tifffile, integers", fixture!("depth-uint16.tiff")),
    ("OpenCV PFM", fixture!("depth-opencv.pfm")),
];

fn read(bytes: &[u8], kind: DepthKind) -> Result<DepthImage, ErrorCode> {
    read_depth_file(bytes, &DepthReadOptions::default(), kind).map_err(|error| {
        assert!(!error.found.is_empty() && !error.expected.is_empty() && !error.remedy.is_empty(), "{error}");
        error.code
    })
}

fn metric(bytes: &[u8]) -> Result<DepthImage, ErrorCode> {
    read(bytes, DepthKind::Metric)
}

#[wasm_bindgen_test(unsupported = test)]
fn depth_of_every_library() {
    let [width, height] = SIZE;
    for (name, bytes) in FILES {
        let depth = metric(bytes).unwrap();
        assert_eq!([depth.values.width(), depth.values.height()], SIZE, "{name}");
        // What the generator made of these pixels: 0, NaN, infinity, −1.
        assert_eq!(depth.values.data()[..4], [0.0; 4], "{name}");
        let unit = if name.ends_with("integers") { 5.0 } else { 1.0 };
        for (u, v) in [(4, 0), (20, 11), (width - 1, height - 3)] {
            let z = f64::from(depth.values.get(u, v).unwrap()) / unit;
            let expected = 1.5 + 0.02 * u as f64 + 0.01 * v as f64;
            assert!((expected..expected + 0.0011).contains(&z), "{name}: {z} at {u}, {v}");
        }
        let map = read_depth(bytes, &DepthReadOptions::default()).unwrap();
        assert_eq!(map, depth.values, "{name}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn cameras_in_files_are_in_pixels_of_the_depth() {
    let camera = |bytes| metric(bytes).unwrap().camera.map(|camera| [camera.fx, camera.fy, camera.cx, camera.cy]);
    let near = |found: Option<[f64; 4]>, expected: [f64; 4]| {
        let found = found.unwrap();
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-5), "{found:?}");
    };
    near(camera(FILES[0].1), [41.5, 41.5, 18.0, 11.0]);
    // Intrinsics in image sizes; pixel centres are at integers.
    near(camera(FILES[1].1), [0.9 * 37.0, 1.4 * 23.0, 18.0, 0.52 * 23.0 - 0.5]);
    near(camera(FILES[2].1), [40.0, 41.0, 18.0, 11.0]);
    assert_eq!(camera(FILES[3].1), None);
}

#[wasm_bindgen_test(unsupported = test)]
fn what_is_no_single_depth_map_is_refused() {
    let unsupported = Err(ErrorCode::UnsupportedFormat);
    for bytes in [fixture!("depth-da3-batch.npz"), fixture!("depth-moge-points.exr"), b"PF\n1 1\n-1\n", b"?"] {
        assert_eq!(metric(bytes).map(drop), unsupported);
    }
    let disparity = fixture!("depth-disparity.npz");
    assert_eq!(metric(disparity).map(drop), unsupported);
    let values = read(disparity, DepthKind::AffineInvariantDisparity).unwrap().values;
    // 1 − 0, NaN, infinity, 1 + 1; the values of most pixels are below zero.
    assert_eq!((values.data()[0], values.data()[3]), (1.0, 2.0));
    assert!(values.data()[1].is_nan() && values.data()[2].is_nan() && values.data()[9] < 0.0);
}

#[wasm_bindgen_test(unsupported = test)]
fn pfm_of_both_byte_orders_from_the_bottom_up() {
    let pixels = [1.0_f32, 2.0, 3.0, 4.0];
    let file = |scale: &str, bytes: fn(f32) -> [u8; 4]| {
        [format!("Pf\n2 2\n{scale}\n").into_bytes(), pixels.into_iter().flat_map(bytes).collect()].concat()
    };
    for bytes in [file("-1.0", f32::to_le_bytes), file("1", f32::to_be_bytes)] {
        assert_eq!(metric(&bytes).unwrap().values.data(), [3.0, 4.0, 1.0, 2.0]);
        assert_eq!(metric(&bytes[..bytes.len() - 1]).map(drop), Err(ErrorCode::CorruptFile));
    }
    for (header, code) in [
        ("Pf\n0 2\n-1\n", ErrorCode::EmptyImage),
        ("Pf\n100000 100000\n-1\n", ErrorCode::FileTooLarge),
        ("Pf\n99999999999999999999 1\n-1\n", ErrorCode::CorruptFile),
        ("Pf\n-2 2\n-1\n", ErrorCode::CorruptFile),
        ("Pf\n2 2\n0\n", ErrorCode::CorruptFile),
        ("Pf\n2 2\nnan\n", ErrorCode::CorruptFile),
        ("Pf\n2 2", ErrorCode::CorruptFile),
    ] {
        assert_eq!(metric(header.as_bytes()).map(drop), Err(code), "{header:?}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn files_cut_short_are_refused() {
    for (name, bytes) in FILES {
        for length in 0..bytes.len() {
            let result = metric(&bytes[..length]).map(drop);
            // The directory of a TIFF may come after its pixels, or a last byte may be padding.
            let is_refused = result.is_err_and(|code| {
                matches!(code, ErrorCode::CorruptFile | ErrorCode::UnsupportedFormat | ErrorCode::FileTooLarge)
            });
            assert!(is_refused, "{name} cut to {length}: {result:?}");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn random_damage_gives_depth_or_a_code() {
    for (k, (name, bytes)) in FILES.into_iter().enumerate() {
        let mut refused = 0;
        for seed in 0..300 {
            let mut random = Random::new(1000 * k as u64 + seed, 30);
            let mut damaged = bytes.to_vec();
            for _ in 0..1 + random.below(5) {
                let reach = if random.below(2) == 0 { damaged.len() } else { damaged.len().min(500) };
                let place = random.below(reach);
                damaged[place] = random.below(256) as u8;
            }
            refused += usize::from(metric(&damaged).is_err());
        }
        assert!(refused > 0, "{name}: no damage was noticed");
    }
}
