//! Depth maps, masks and photos from files: all kinds show the same, and what they are not is refused.

use sim3align::geometry::depth_kind::DepthKind;
use sim3align::geometry::surface_colors::Rgb;
use sim3align_formats::depth::{DepthImage, DepthReadOptions, read_depth, read_depth_file};
use sim3align_formats::mask::read_mask;
use sim3align_formats::photo::{read_photo, read_stored_photo};
use sim3align_formats::webp::read_webp;

use crate::fixtures::{fixture, floats, png_of};
use crate::prelude::*;

/// The depth in the fixtures: 7 × 5 pixels, no reading at (0, 0) and (3, 2).
fn expected_depth() -> Vec<f64> {
    let metres = |v: u32, u: u32| 0.5 + 0.01 * f64::from(u) + 0.1 * f64::from(v);
    let hole = |v, u| (v, u) == (0, 0) || (v, u) == (2, 3);
    (0..5).flat_map(|v| (0..7).map(move |u| if hole(v, u) { 0.0 } else { metres(v, u) })).collect()
}

/// The mask in the fixtures.
fn expected_mask() -> Vec<u8> {
    (0..5).flat_map(|v| (0..7).map(move |u| u8::from((u * u + 3 * v) % 5 < 2))).collect()
}

fn depth(bytes: &[u8], depth_scale: Option<f64>) -> sim3align::error::Result<DepthMap> {
    read_depth(bytes, &DepthReadOptions { depth_scale, ..DepthReadOptions::default() })
}

#[wasm_bindgen_test]
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
        ("three times", fixture!("depth-3hw.npy"), 1e-7),
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

#[wasm_bindgen_test]
fn depth_scales_apply_to_what_they_say() {
    // Pixel (1, 0) holds 0.51 or 510; rounded to micrometres.
    let first = |bytes: &[u8], options: DepthReadOptions| {
        (f64::from(read_depth(bytes, &options).unwrap().data()[1]) * 1e6).round()
    };
    let explicit = DepthReadOptions { depth_scale: Some(0.01), integer_depth_scale: Some(7.0), is_packed: false };
    let of_camera = DepthReadOptions { integer_depth_scale: Some(0.0001), ..DepthReadOptions::default() };
    let [png, integers, floats] = [fixture!("depth-16.png"), fixture!("depth-u2-hw1.npy"), fixture!("depth-f4.npy")];
    assert_eq!([first(png, explicit), first(floats, explicit)], [5_100_000.0, 5_100.0]);
    assert_eq!([png, integers, floats].map(|bytes| first(bytes, of_camera)), [51_000.0, 51_000.0, 510_000.0]);
    for scale in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = depth(fixture!("depth-16.png"), Some(scale)).unwrap_err();
        assert_eq!((error.code, &*error.argument), (ErrorCode::InvalidOption, "options.depthScale"));
    }
}

#[wasm_bindgen_test]
fn pictures_of_depth_are_refused() {
    use ErrorCode::{EightBitDepth, UnsupportedFormat};
    let error = depth(fixture!("depth-8.png"), None).unwrap_err();
    assert_eq!((error.code, &*error.found), (EightBitDepth, "an 8-bit PNG"));
    assert!(error.remedy.contains("256 steps") && error.remedy.contains("numpy.save"), "{error}");
    // 16 bits a sample, but colours.
    let colour = png_of([1, 1], png::ColorType::Rgb, png::BitDepth::Sixteen, &[1, 0, 2, 0, 3, 0]);
    let eight =
        [fixture!("depth-rgb.png"), fixture!("mask-1bit.png"), fixture!("depth-u1.npy"), fixture!("mask-bool.npy")];
    let other = [fixture!("depth-c16.npy"), b"\xff\xd8\xff\xe0JFIF", b"", &colour];
    for (files, code) in [(eight.as_slice(), EightBitDepth), (&other, UnsupportedFormat)] {
        assert!(files.iter().all(|bytes| depth(bytes, None).unwrap_err().code == code), "{code:?}");
    }
}

#[wasm_bindgen_test]
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
        let mask = read_mask(bytes).unwrap_or_else(|error| panic!("{name}: {error}")).object;
        assert_eq!((mask.width(), mask.height()), (7, 5), "{name}");
        assert_eq!(mask.data(), expected_mask(), "{name}");
    }
    assert_eq!(read_mask(b"GIF89a").unwrap_err().code, ErrorCode::UnsupportedFormat);
}

#[wasm_bindgen_test]
fn images_that_claim_more_than_they_hold_are_refused() {
    use ErrorCode::{CorruptFile, EmptyImage, FileTooLarge, UnsupportedFormat};
    for (size, code) in [(8000, CorruptFile), (1 << 20, FileTooLarge), (u32::MAX, FileTooLarge), (0, EmptyImage)] {
        let mut png = fixture!("depth-16.png").to_vec();
        png[16..24].copy_from_slice(&[size.to_be_bytes(), size.to_be_bytes()].concat());
        assert_eq!(depth(&png, None).unwrap_err().code, code, "{size}");
    }
    for (shape, expected) in [
        ("(4L, 4L)", Ok(16)),
        ("(5, 4)", Err(CorruptFile)),
        ("(4000, 4000)", Err(CorruptFile)),
        ("(4000000000, 4000000000)", Err(FileTooLarge)),
        ("(18446744073709551616, 1)", Err(CorruptFile)),
        ("(0, 4)", Err(EmptyImage)),
        ("(16,)", Err(UnsupportedFormat)),
        ("()", Err(UnsupportedFormat)),
        ("(4, 4", Err(CorruptFile)),
    ] {
        let found = depth(&npy_of(shape, &[0.0; 16]), None).map(|depth| depth.data().len()).map_err(|error| error.code);
        assert_eq!(found, expected, "{shape}");
    }
}

const SIZE: [usize; 2] = [37, 23];

pub const DEPTH_FILES: [(&str, &[u8]); 8] = [
    ("Depth Pro", fixture!("depth-depth-pro.npz")),
    ("MoGe", fixture!("depth-moge.npz")),
    ("Depth Anything 3", fixture!("depth-da3.npz")),
    ("OpenCV", fixture!("depth-opencv.exr")),
    ("Blender", fixture!("depth-blender.exr")),
    ("tifffile", fixture!("depth-float32.tiff")),
    ("tifffile, integers", fixture!("depth-uint16.tiff")),
    ("OpenCV PFM", fixture!("depth-opencv.pfm")),
];

fn read_kind(bytes: &[u8], kind: DepthKind) -> Result<DepthImage, ErrorCode> {
    read_depth_file(bytes, &DepthReadOptions::default(), kind).map_err(|error| {
        assert!(!error.found.is_empty() && !error.expected.is_empty() && !error.remedy.is_empty(), "{error}");
        error.code
    })
}

fn metric(bytes: &[u8]) -> Result<DepthImage, ErrorCode> {
    read_kind(bytes, DepthKind::Metric)
}

#[wasm_bindgen_test]
fn depth_of_every_library() {
    let [width, height] = SIZE;
    for (name, bytes) in DEPTH_FILES {
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

#[wasm_bindgen_test]
fn files_without_a_single_depth_map_are_refused() {
    let disparity = fixture!("depth-disparity.npz");
    for bytes in [fixture!("depth-da3-batch.npz"), fixture!("depth-moge-points.exr"), disparity] {
        assert_eq!(metric(bytes).map(drop), Err(ErrorCode::UnsupportedFormat));
    }
    let values = read_kind(disparity, DepthKind::AffineInvariantDisparity).unwrap().values;
    // 1 − 0, NaN, infinity, 1 + 1.
    assert!(values.data()[1].is_nan() && (values.data()[0], values.data()[3]) == (1.0, 2.0));
}

/// An EXR of 2 × 1 pixels, without compression, whose channels have the values 1, 2, 3 … in the order of their names.
fn exr_of(names: &[&str]) -> Vec<u8> {
    let mut bytes = [0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0].to_vec();
    let mut attribute = |name: &str, kind: &str, value: &[u8]| {
        bytes.extend(
            [name.as_bytes(), b"\0", kind.as_bytes(), b"\0", &(value.len() as u32).to_le_bytes(), value].concat(),
        );
    };
    let words = |values: &[u32]| -> Vec<u8> { values.iter().flat_map(|value| value.to_le_bytes()).collect() };
    let channel = |name: &&str| [name.as_bytes(), b"\0", &words(&[2, 0, 1, 1])].concat();
    attribute("channels", "chlist", &[names.iter().flat_map(channel).collect(), vec![0]].concat());
    attribute("compression", "compression", &[0]);
    attribute("dataWindow", "box2i", &words(&[0, 0, 1, 0]));
    attribute("displayWindow", "box2i", &words(&[0, 0, 1, 0]));
    attribute("lineOrder", "lineOrder", &[0]);
    attribute("pixelAspectRatio", "float", &1f32.to_le_bytes());
    attribute("screenWindowCenter", "v2f", &[0; 8]);
    attribute("screenWindowWidth", "float", &1f32.to_le_bytes());
    bytes.push(0);
    let start = bytes.len() as u64 + 8;
    let values = (1..=names.len()).flat_map(|k| [k as f32; 2]).flat_map(f32::to_le_bytes);
    [bytes, start.to_le_bytes().to_vec(), words(&[0, 8 * names.len() as u32]), values.collect()].concat()
}

/// Channels as renderers name them: the depth, not the z of a normal or of a position, nor Blender's mist.
#[wasm_bindgen_test]
fn the_z_of_a_vector_is_no_depth() {
    for (names, depth) in [
        (&["N.X", "N.Y", "N.Z", "Z"] as &[&str], 4.0),
        (&["Layer.Depth.Z", "Layer.Normal.X", "Layer.Normal.Y", "Layer.Normal.Z"], 1.0),
        (&["Layer.Combined.R", "Layer.Depth.Z", "Layer.Mist.Z"], 2.0),
        (&["B", "G", "R", "depth.Z"], 4.0),
    ] {
        let read = metric(&exr_of(names)).unwrap();
        assert_eq!((read.values.data(), read.unread.len()), ([depth; 2].as_slice(), 0), "{names:?}");
    }
    let two = metric(&exr_of(&["A.Denoising Depth.Z", "A.Depth.Z", "B.Depth.Z"])).unwrap();
    assert_eq!(
        (two.values.data(), two.unread),
        ([2.0; 2].as_slice(), vec!["the channel `b.depth.z` of the depth file".to_owned()])
    );
    for names in [&["X", "Y", "Z"] as &[&str], &["N.X", "N.Y", "N.Z"], &["Layer.Mist.Z"]] {
        assert_eq!(metric(&exr_of(names)).map(drop), Err(ErrorCode::UnsupportedFormat), "{names:?}");
    }
}

#[wasm_bindgen_test]
fn lines_of_a_pfm_end_with_one_character_or_more() {
    for header in ["Pf\n2 1\n-1\n", "Pf\r\n2 1\r\n-1.0\r\n", "Pf\n2 1 \n-1.0 \n", "Pf 2 1 -1\n"] {
        // A value that begins with a space, and one that does not.
        let first = f32::from_le_bytes([0x20, 0x0a, 0x20, 0x40]);
        let bytes: Vec<u8> = header.bytes().chain([first, 3.0].into_iter().flat_map(f32::to_le_bytes)).collect();
        assert_eq!(metric(&bytes).unwrap().values.data(), [first, 3.0], "{header:?}");
    }
}

#[wasm_bindgen_test]
fn cameras_in_files_are_in_pixels_of_the_depth() {
    let camera = |bytes| metric(bytes).unwrap().camera.map(|camera| [camera.fx, camera.fy, camera.cx, camera.cy]);
    let near = |found: Option<[f64; 4]>, expected: [f64; 4]| {
        let found = found.unwrap();
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-5), "{found:?}");
    };
    near(camera(DEPTH_FILES[0].1), [41.5, 41.5, 18.0, 11.0]);
    // Intrinsics in image sizes; pixel centres are at integers.
    near(camera(DEPTH_FILES[1].1), [0.9 * 37.0, 1.4 * 23.0, 18.0, 0.52 * 23.0 - 0.5]);
    near(camera(DEPTH_FILES[2].1), [40.0, 41.0, 18.0, 11.0]);
    assert_eq!(camera(DEPTH_FILES[3].1), None);
}

/// The colours of the quarters of the photos.
const QUARTERS: [Rgb; 4] = [[200, 40, 30], [40, 170, 60], [30, 60, 190], [220, 200, 40]];

fn check_photo(name: &str, bytes: &[u8], quarters: [Rgb; 4], tolerance: u8) {
    let photo = read_photo(bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
    assert_eq!((photo.width(), photo.height()), (48, 32), "{name}");
    for (i, &color) in photo.data().iter().enumerate() {
        let (u, v) = (i % 48, i / 48);
        let near_edge = tolerance > 0 && (u.abs_diff(24).min(v.abs_diff(16)) < 4);
        let expected = quarters[usize::from(u >= 24) + 2 * usize::from(v >= 16)];
        let is_near = color.iter().zip(expected).all(|(a, b)| a.abs_diff(b) <= tolerance);
        assert!(near_edge || is_near, "{name}: {color:?} at ({u}, {v}), not {expected:?}");
    }
}

#[wasm_bindgen_test]
fn photos_of_every_kind_show_the_same_picture() {
    let grey = [87_u8, 119, 66, 188].map(|luma| [luma; 3]);
    check_photo("PNG", fixture!("photo.png"), QUARTERS, 0);
    check_photo("PNG of 16 bits", fixture!("photo-16.png"), QUARTERS, 0);
    check_photo("palette", fixture!("photo-palette.png"), QUARTERS, 0);
    check_photo("interlaced", fixture!("photo-interlaced.png"), QUARTERS, 0);
    check_photo("alpha is ignored", fixture!("photo-alpha.png"), QUARTERS, 0);
    check_photo("16 bits and alpha", fixture!("photo-16-alpha.png"), QUARTERS, 0);
    check_photo("palette and alpha", fixture!("photo-palette-alpha.png"), QUARTERS, 0);
    check_photo("grey PNG", fixture!("photo-grey.png"), grey, 0);
    check_photo("grey and alpha", fixture!("photo-grey-alpha.png"), grey, 0);
    check_photo("JPEG", fixture!("photo.jpg"), QUARTERS, 4);
    check_photo("JPEG 4:2:0", fixture!("photo-420.jpg"), QUARTERS, 6);
    check_photo("progressive JPEG", fixture!("photo-progressive.jpg"), QUARTERS, 6);
    check_photo("grey JPEG", fixture!("photo-grey.jpg"), grey, 4);
    check_photo("CMYK JPEG", fixture!("photo-cmyk.jpg"), QUARTERS, 6);
    // Adobe's marker says how the first three components are to be read: 2 stands for YCCK. Pillow's values of the result.
    let mut ycck = fixture!("photo-cmyk.jpg").to_vec();
    let marker = ycck.windows(5).position(|word| word == b"Adobe").unwrap();
    ycck[marker + 11] = 2;
    check_photo("YCCK JPEG", &ycck, [[192, 0, 211], [255, 181, 141], [138, 246, 255], [158, 0, 0]], 6);
}

#[wasm_bindgen_test]
fn large_photos_are_reduced_also_where_they_are_progressive() {
    let [one, other] = [fixture!("photo-large.jpg"), fixture!("photo-large-progressive.jpg")].map(|bytes| {
        let photo = read_photo(bytes).unwrap();
        assert_eq!((photo.width(), photo.height()), (1300, 900), "half of 2600 × 1800");
        photo
    });
    // The same image: the fixtures differ in their encoding only.
    let off = one.data().as_flattened().iter().zip(other.data().as_flattened()).map(|(a, b)| a.abs_diff(*b)).max();
    assert!(off.unwrap() <= 2, "{off:?}");
    assert!(one.data().iter().any(|color| *color != one.data()[0]), "it shows something");
}

#[wasm_bindgen_test]
fn photos_are_turned_as_their_exif_data_say() {
    let turned = [
        fixture!("photo-exif-1.jpg"),
        fixture!("photo-exif-2.jpg"),
        fixture!("photo-exif-3.jpg"),
        fixture!("photo-exif-4.jpg"),
        fixture!("photo-exif-5.jpg"),
        fixture!("photo-exif-6.jpg"),
        fixture!("photo-exif-7.jpg"),
        fixture!("photo-exif-8.jpg"),
    ];
    for (i, bytes) in turned.into_iter().enumerate() {
        check_photo(&format!("orientation {}", i + 1), bytes, QUARTERS, 4);
    }
    check_photo("PNG", fixture!("photo-exif.png"), QUARTERS, 0);
}

/// A `.npy` array of f32.
fn npy_of(shape: &str, values: &[f32]) -> Vec<u8> {
    let header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}\n");
    let length = (header.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\x00", length.as_slice(), header.as_bytes(), &floats(values)].concat()
}

/// Coverage of a disc of radius 20 in 64 × 64 pixels, with an edge `blur` pixels wide.
fn disc(blur: f32) -> Vec<f32> {
    let distance = |i: usize| ((i % 64) as f32 - 32.0).hypot((i / 64) as f32 - 32.0) - 20.0;
    (0..64 * 64).map(|i| (0.5 - distance(i) / blur).clamp(0.0, 1.0)).collect()
}

#[wasm_bindgen_test]
fn the_outline_of_a_soft_mask_is_at_half_of_its_range() {
    use png::{BitDepth, ColorType};
    let hard: Vec<u8> = disc(1e-3).iter().map(|coverage| u8::from(*coverage >= 0.5)).collect();
    for blur in [1.5, 4.0, 9.0] {
        let soft = disc(blur);
        let scaled = |most: f32| soft.iter().map(move |coverage| (coverage * most).round());
        let grey: Vec<u8> = scaled(255.0).map(|value| value as u8).collect();
        let faint: Vec<u8> = scaled(180.0).map(|value| value as u8).collect();
        let alpha: Vec<u8> = grey.iter().flat_map(|alpha| [90, 90, 90, *alpha]).collect();
        let wide: Vec<u8> = scaled(65535.0).flat_map(|value| (value as u16).to_be_bytes()).collect();
        let logits: Vec<f32> = soft.iter().map(|coverage| 20.0 * (coverage - 0.499)).collect();
        let files = [
            ("grey", png_of([64, 64], ColorType::Grayscale, BitDepth::Eight, &grey)),
            ("grey up to 180", png_of([64, 64], ColorType::Grayscale, BitDepth::Eight, &faint)),
            ("16 bits", png_of([64, 64], ColorType::Grayscale, BitDepth::Sixteen, &wide)),
            ("alpha", png_of([64, 64], ColorType::Rgba, BitDepth::Eight, &alpha)),
            ("probabilities", npy_of("(64, 64)", &soft)),
            ("logits", npy_of("(64, 64)", &logits)),
        ];
        for (name, bytes) in files {
            let read = read_mask(&bytes).unwrap();
            // Rounding moves pixels whose centre is at the outline.
            let off = read.object.data().iter().zip(&hard).filter(|(a, b)| a != b).count();
            assert!(off <= 8, "{name}, {blur} pixels: {off} pixels differ; {}", read.reading);
            assert_eq!(read.reading.contains("logits"), name == "logits", "{}", read.reading);
        }
    }
    // Enlarged, the outline is still no label.
    let coarse: Vec<f32> =
        (0..16 * 16).map(|i| (7.0 - ((i % 16) as f32 - 8.0).hypot((i / 16) as f32 - 8.0)) / 3.0).collect();
    let enlarged = (0..64 * 64).map(|i| coarse[i % 64 / 4 + 16 * (i / 256)].clamp(0.0, 1.0));
    let blocks: Vec<u8> = enlarged.map(|coverage| (8.0 * coverage).round() as u8 * 31).collect();
    let read = read_mask(&png_of([64, 64], ColorType::Grayscale, BitDepth::Eight, &blocks)).unwrap();
    assert!(!read.reading.contains("labels"), "{}", read.reading);
    // Logarithms of probabilities, none of which is above 0.
    let logarithms: Vec<f32> = disc(1e-3).iter().map(|coverage| if *coverage >= 0.5 { 0.0 } else { -6.0 }).collect();
    assert_eq!(read_mask(&npy_of("(64, 64)", &logarithms)).unwrap().object.data(), hard);
    // Labels are flat regions: all are the object, whatever their numbers.
    for [first, second] in [[1, 2], [100, 255], [40, 10], [1, 30], [1, 255]] {
        let labels: Vec<u8> = (0..64 * 64)
            .map(|i| match i % 64 {
                0..20 => first,
                20..40 => second,
                _ => 0,
            })
            .collect();
        let read = read_mask(&png_of([64, 64], ColorType::Grayscale, BitDepth::Eight, &labels)).unwrap();
        let expected: Vec<u8> = labels.iter().map(|label| u8::from(*label > 0)).collect();
        assert!(read.object.data() == expected, "{first}, {second}: {}", read.reading);
        // As colours, both as bright.
        let color = |label: &u8| if *label == first { [200, 0, 0] } else { [0, 200, 0] };
        let colors: Vec<u8> = labels.iter().flat_map(|label| if *label == 0 { [0; 3] } else { color(label) }).collect();
        let read = read_mask(&png_of([64, 64], ColorType::Rgb, BitDepth::Eight, &colors)).unwrap();
        assert!(read.reading.ends_with(": labels") && read.object.data() == expected, "{}", read.reading);
    }
}

#[wasm_bindgen_test]
fn depth_in_three_equal_channels_is_read_and_depth_below_zero_is_named() {
    use png::{BitDepth, ColorType};
    let pixel = |z: u16, other: u16| [z, z, other, u16::MAX].into_iter().flat_map(u16::to_be_bytes);
    let equal: Vec<u8> = (1..=6).flat_map(|i| pixel(500 * i, 500 * i)).collect();
    let read = depth(&png_of([3, 2], ColorType::Rgba, BitDepth::Sixteen, &equal), None).unwrap();
    assert_eq!(read.data(), [0.5, 1.0, 1.5, 2.0, 2.5, 3.0]);
    let other: Vec<u8> = (1..=6).flat_map(|i| pixel(500 * i, 499 * i)).collect();
    let error = depth(&png_of([3, 2], ColorType::Rgba, BitDepth::Sixteen, &other), None).unwrap_err();
    assert_eq!((error.code, &*error.found), (ErrorCode::UnsupportedFormat, "a 16-bit PNG with colours"));
    let error = depth(&npy_of("(2, 3)", &[-0.5, -1.0, 0.0, f32::NAN, f32::NEG_INFINITY, -2.5]), None).unwrap_err();
    assert_eq!((error.code, &*error.found), (ErrorCode::NoDepthInMask, "only values below 0, down to -2.5"));
    assert!(error.remedy.contains("Pass -depth"), "{error}");
}

#[wasm_bindgen_test]
fn photos_in_webp_have_the_pixels_of_their_lossless_form() {
    let mut random = Random::new(71, 0);
    let rgb: Vec<u8> = (0..3 * 50 * 40).map(|_| (random.uniform() * 256.0) as u8).collect();
    let mut bytes = Vec::new();
    image_webp::WebPEncoder::new(&mut bytes).encode(&rgb, 50, 40, image_webp::ColorType::Rgb8).unwrap();
    let photo = read_webp(&bytes, false).unwrap().pixels;
    assert_eq!((photo.width(), photo.height(), photo.data().as_flattened()), (50, 40, rgb.as_slice()));
    for length in 0..bytes.len() {
        match read_webp(&bytes[..length], false) {
            Err(error) => assert_eq!(error.code, ErrorCode::CorruptFile, "{length}"),
            Ok(read) => assert_eq!(read.pixels, photo, "{length}: only padding may be missing"),
        }
    }
}

#[wasm_bindgen_test]
fn a_photo_can_be_read_as_it_is_stored() {
    let [turned, plain] = [fixture!("photo-exif-6.jpg"), fixture!("photo-exif-1.jpg")];
    let [upright, stored] = [read_photo(turned).unwrap(), read_stored_photo(turned).unwrap()];
    assert_eq!([upright.width(), upright.height()], [stored.height(), stored.width()]);
    assert_eq!(read_photo(plain).unwrap(), read_stored_photo(plain).unwrap());
}
