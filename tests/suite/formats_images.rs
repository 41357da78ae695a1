//! Depth maps and masks from files.

use sim3align_formats::depth::{DepthReadOptions, read_depth};
use sim3align_formats::mask::read_mask;
use sim3align_lab::case_folder::write;

use crate::formats_fixtures::fixture;
use crate::prelude::*;

/// The depth of make_fixtures.py: 7 × 5 pixels, no reading at (0, 0) and (3, 2).
fn expected_depth() -> Vec<f64> {
    let metres = |v: u32, u: u32| 0.5 + 0.01 * f64::from(u) + 0.1 * f64::from(v);
    let hole = |v, u| (v, u) == (0, 0) || (v, u) == (2, 3);
    (0..5).flat_map(|v| (0..7).map(move |u| if hole(v, u) { 0.0 } else { metres(v, u) })).collect()
}

/// The mask of make_fixtures.py.
fn expected_mask() -> Vec<u8> {
    (0..5).flat_map(|v| (0..7).map(move |u| u8::from((u * u + 3 * v) % 5 < 2))).collect()
}

fn depth(bytes: &[u8], depth_scale: Option<f64>) -> sim3align::error::Result<DepthMap> {
    read_depth(bytes, &DepthReadOptions { depth_scale, integer_depth_scale: None })
}

#[wasm_bindgen_test(unsupported = test)]
fn depth_of_every_kind_is_the_same_depth() {
    let files = [
        ("f4", fixture!("depth-f4.npy"), 1e-7),
        ("f8, Fortran order, version 2", fixture!("depth-f8-fortran.npy"), 1e-7),
        ("big-endian f4, version 3", fixture!("depth-f4-big.npy"), 1e-7),
        // Half precision has 11 bits.
        ("f2", fixture!("depth-f2.npy"), 5e-4),
        ("u2, H×W×1", fixture!("depth-u2-hw1.npy"), 1e-7),
        ("big-endian u2, Fortran order, 1×H×W", fixture!("depth-u2-big-1hw.npy"), 1e-7),
        ("i4", fixture!("depth-i4.npy"), 1e-7),
        ("PNG by imageio", fixture!("depth-16.png"), 1e-7),
        ("PNG by Pillow", fixture!("depth-16-pillow.png"), 1e-7),
    ];
    for (name, bytes, tolerance) in files {
        let depth = depth(bytes, None).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!((depth.width(), depth.height()), (7, 5), "{name}");
        for (i, (&found, expected)) in depth.data().iter().zip(expected_depth()).enumerate() {
            assert!((f64::from(found) - expected).abs() <= tolerance, "{name}: {found} at {i}, not {expected}");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn depth_scales_apply_to_what_they_say() {
    // Pixel (1, 0) holds 0.51 or 510; rounded to micrometres.
    let first = |bytes: &[u8], options: DepthReadOptions| {
        (f64::from(read_depth(bytes, &options).unwrap().data()[1]) * 1e6).round()
    };
    let explicit = DepthReadOptions { depth_scale: Some(0.01), integer_depth_scale: Some(7.0) };
    let of_camera = DepthReadOptions { depth_scale: None, integer_depth_scale: Some(0.0001) };
    assert_eq!(first(fixture!("depth-16.png"), explicit), 5_100_000.0);
    assert_eq!(first(fixture!("depth-16.png"), of_camera), 51_000.0);
    assert_eq!(first(fixture!("depth-u2-hw1.npy"), of_camera), 51_000.0);
    assert_eq!(first(fixture!("depth-f4.npy"), of_camera), 510_000.0);
    assert_eq!(first(fixture!("depth-f4.npy"), explicit), 5_100.0);
    for scale in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = depth(fixture!("depth-16.png"), Some(scale)).unwrap_err();
        assert_eq!((error.code, &*error.argument), (ErrorCode::InvalidOption, "options.depthScale"));
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn pictures_of_depth_are_refused() {
    let code = |bytes: &[u8]| depth(bytes, None).unwrap_err().code;
    let error = depth(fixture!("depth-8.png"), None).unwrap_err();
    assert_eq!((error.code, &*error.found), (ErrorCode::EightBitDepth, "an 8-bit PNG"));
    assert!(error.remedy.contains("256 steps") && error.remedy.contains("numpy.save"), "{error}");
    assert_eq!(code(fixture!("depth-rgb.png")), ErrorCode::EightBitDepth);
    assert_eq!(code(fixture!("mask-1bit.png")), ErrorCode::EightBitDepth);
    assert_eq!(code(fixture!("depth-u1.npy")), ErrorCode::EightBitDepth);
    assert_eq!(code(fixture!("mask-bool.npy")), ErrorCode::EightBitDepth);
    assert_eq!(code(fixture!("depth-3hw.npy")), ErrorCode::UnsupportedFormat);
    assert_eq!(code(fixture!("depth-c16.npy")), ErrorCode::UnsupportedFormat);
    assert_eq!(code(b"\xff\xd8\xff\xe0JFIF"), ErrorCode::UnsupportedFormat);
    assert_eq!(code(b""), ErrorCode::UnsupportedFormat);
    // 16 bits a sample, but colour: the header of the grey one, changed.
    let mut colour = fixture!("depth-16.png").to_vec();
    colour[25] = 2;
    assert_eq!(code(&colour), ErrorCode::UnsupportedFormat);
}

#[wasm_bindgen_test(unsupported = test)]
fn masks_of_every_kind_are_the_same_mask() {
    let files = [
        ("1 bit", fixture!("mask-1bit.png")),
        ("grey, object is 1", fixture!("mask-grey.png")),
        ("grey, 16 bits", fixture!("mask-grey-16.png")),
        ("only blue", fixture!("mask-blue.png")),
        ("cut-out: colour photo, alpha is the mask", fixture!("mask-cut-out.png")),
        ("opaque RGBA, black and white", fixture!("mask-opaque.png")),
        ("black, alpha is the mask", fixture!("mask-grey-alpha.png")),
        ("palette whose colour 0 is not black", fixture!("mask-palette.png")),
        ("bool", fixture!("mask-bool.npy")),
        ("i8, Fortran order, object is −3", fixture!("mask-i8-fortran.npy")),
        ("f4, object is 0.25", fixture!("mask-f4.npy")),
    ];
    for (name, bytes) in files {
        let mask = read_mask(bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!((mask.width(), mask.height()), (7, 5), "{name}");
        assert_eq!(mask.data(), expected_mask(), "{name}");
    }
    assert_eq!(read_mask(b"GIF89a").unwrap_err().code, ErrorCode::UnsupportedFormat);
}

#[wasm_bindgen_test(unsupported = test)]
fn images_that_claim_more_than_they_hold_are_refused() {
    let resized = |width: u32, height: u32| {
        let mut png = fixture!("depth-16.png").to_vec();
        png[16..20].copy_from_slice(&width.to_be_bytes());
        png[20..24].copy_from_slice(&height.to_be_bytes());
        depth(&png, None).unwrap_err().code
    };
    assert_eq!(resized(8000, 8000), ErrorCode::CorruptFile);
    assert_eq!(resized(1 << 20, 1 << 20), ErrorCode::FileTooLarge);
    assert_eq!(resized(u32::MAX, u32::MAX), ErrorCode::FileTooLarge);
    assert_eq!(resized(0, 5), ErrorCode::EmptyImage);
    let npy = |shape: &str| {
        let header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}\n");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend([0; 64]);
        depth(&bytes, None).map(|depth| depth.data().len()).map_err(|error| error.code)
    };
    assert_eq!(npy("(4, 4)"), Ok(16));
    assert_eq!(npy("(4L, 4L)"), Ok(16));
    assert_eq!(npy("(5, 4)"), Err(ErrorCode::CorruptFile));
    assert_eq!(npy("(4000, 4000)"), Err(ErrorCode::CorruptFile));
    assert_eq!(npy("(4000000000, 4000000000)"), Err(ErrorCode::FileTooLarge));
    assert_eq!(npy("(18446744073709551616, 1)"), Err(ErrorCode::CorruptFile));
    assert_eq!(npy("(0, 4)"), Err(ErrorCode::EmptyImage));
    assert_eq!(npy("(16,)"), Err(ErrorCode::UnsupportedFormat));
    assert_eq!(npy("()"), Err(ErrorCode::UnsupportedFormat));
    assert_eq!(npy("(4, 4"), Err(ErrorCode::CorruptFile));
}

#[wasm_bindgen_test(unsupported = test)]
fn written_images_read_back() {
    let depth_map = depth(fixture!("depth-f4.npy"), None).unwrap();
    assert_eq!(depth(&write::depth_npy(&depth_map), None).unwrap(), depth_map);
    let png = write::depth_png(&depth_map, 0.0005).unwrap();
    let back = depth(&png, Some(0.0005)).unwrap();
    assert!(back.data().iter().zip(depth_map.data()).all(|(a, b)| (a - b).abs() < 1e-6));
    assert_eq!(write::depth_png(&depth_map, 1e-6).unwrap_err().code, ErrorCode::InvalidOption);
    assert_eq!(write::depth_png(&depth_map, f64::NAN).unwrap_err().code, ErrorCode::InvalidOption);
    let mask = read_mask(fixture!("mask-grey.png")).unwrap();
    assert_eq!(read_mask(&write::mask_png(&mask).unwrap()).unwrap(), mask);
}
