//! Photos from files: all kinds show the same picture, large ones are reduced, hostile ones refused.

use sim3align::geometry::surface_colors::Rgb;
use sim3align_formats::photo::{MAX_PHOTO_PIXELS, read_photo};
use sim3align_lab::case_folder::write;

use crate::formats_fixtures::fixture;
use crate::prelude::*;

/// The colours of the quarters in make_fixtures.py.
const QUARTERS: [Rgb; 4] = [[200, 40, 30], [40, 170, 60], [30, 60, 190], [220, 200, 40]];

fn check(name: &str, bytes: &[u8], quarters: [Rgb; 4], tolerance: u8) {
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

#[wasm_bindgen_test(unsupported = test)]
fn photos_of_every_kind_show_the_same_picture() {
    let grey = [87_u8, 119, 66, 188].map(|luma| [luma; 3]);
    check("PNG", fixture!("photo.png"), QUARTERS, 0);
    check("PNG of 16 bits", fixture!("photo-16.png"), QUARTERS, 0);
    check("palette", fixture!("photo-palette.png"), QUARTERS, 0);
    check("interlaced", fixture!("photo-interlaced.png"), QUARTERS, 0);
    check("alpha is ignored", fixture!("photo-alpha.png"), QUARTERS, 0);
    check("16 bits and alpha", fixture!("photo-16-alpha.png"), QUARTERS, 0);
    check("palette and alpha", fixture!("photo-palette-alpha.png"), QUARTERS, 0);
    check("grey PNG", fixture!("photo-grey.png"), grey, 0);
    check("grey and alpha", fixture!("photo-grey-alpha.png"), grey, 0);
    check("JPEG", fixture!("photo.jpg"), QUARTERS, 4);
    check("JPEG 4:2:0", fixture!("photo-420.jpg"), QUARTERS, 6);
    check("progressive JPEG", fixture!("photo-progressive.jpg"), QUARTERS, 6);
    check("grey JPEG", fixture!("photo-grey.jpg"), grey, 4);
    check("CMYK JPEG", fixture!("photo-cmyk.jpg"), QUARTERS, 6);
    // Adobe's marker says how the first three components are to be read: 2 stands for YCCK. Pillow's values of the result.
    let mut ycck = fixture!("photo-cmyk.jpg").to_vec();
    let marker = ycck.windows(5).position(|word| word == b"Adobe").unwrap();
    ycck[marker + 11] = 2;
    check("YCCK JPEG", &ycck, [[192, 0, 211], [255, 181, 141], [138, 246, 255], [158, 0, 0]], 6);
}

#[wasm_bindgen_test(unsupported = test)]
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
        check(&format!("orientation {}", i + 1), bytes, QUARTERS, 4);
    }
    check("PNG", fixture!("photo-exif.png"), QUARTERS, 0);
    // An orientation that does not exist, and a directory outside the data, count as none.
    let mut damaged = fixture!("photo-exif-1.jpg").to_vec();
    let tag = damaged.windows(2).position(|pair| pair == [0x01, 0x12]).unwrap();
    damaged[tag + 8..tag + 10].copy_from_slice(&[0, 9]);
    check("orientation 9", &damaged, QUARTERS, 4);
    let header = damaged.windows(4).position(|start| start == b"MM\0*").unwrap();
    damaged[header + 4..header + 8].copy_from_slice(&[0xff; 4]);
    check("a directory outside", &damaged, QUARTERS, 4);
}

/// Red grows to the right and blue downwards, by 255 over the whole sides: what is left of a reduced picture must be
/// where it was.
fn check_gradient(photo: &Image<Rgb>, full: [usize; 2], tolerance: f64) {
    let [width, height] = [photo.width(), photo.height()];
    for (v, u) in (1..height - 1).step_by(37).flat_map(|v| (1..width - 1).step_by(41).map(move |u| (v, u))) {
        let [red, _, blue] = photo.get(u, v).unwrap().map(f64::from);
        let at =
            |i: usize, side: usize, full: usize| ((i as f64 + 0.5) * full as f64 / side as f64 - 0.5) / full as f64;
        assert!((red - 255.0 * at(u, width, full[0])).abs() < tolerance, "{red} at ({u}, {v}) of {width} × {height}");
        assert!(
            (blue - 255.0 * at(v, height, full[1])).abs() < tolerance,
            "{blue} at ({u}, {v}) of {width} × {height}"
        );
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn large_photos_are_reduced_in_place() {
    let pixel = |i: usize| [(i % 2201 * 255 / 2200) as u8, 0, (i / 2201 * 255 / 1000) as u8];
    let pixels: Vec<Rgb> = (0..2201 * 1001).map(pixel).collect();
    let png = read_photo(&write::rgb_png(&pixels, 2201, 1001).unwrap()).unwrap();
    assert_eq!((png.width(), png.height()), (1100, 500));
    check_gradient(&png, [2201, 1001], 1.5);
    for bytes in [fixture!("photo-large.jpg"), fixture!("photo-large-progressive.jpg")] {
        let photo = read_photo(bytes).unwrap();
        assert_eq!((photo.width(), photo.height()), (1300, 900));
        check_gradient(&photo, [2600, 1800], 6.0);
    }
    // A side is never lost.
    let narrow = read_photo(&write::rgb_png(&vec![[7, 8, 9]; 2_200_000], 1, 2_200_000).unwrap()).unwrap();
    assert_eq!((narrow.width(), narrow.height()), (1, 2_200_000 / 2));
    assert!(narrow.data().len() <= MAX_PHOTO_PIXELS && narrow.data().iter().all(|&color| color == [7, 8, 9]));
}

#[wasm_bindgen_test(unsupported = test)]
fn hostile_photos_are_refused() {
    let code = |bytes: &[u8]| read_photo(bytes).map(drop).unwrap_err().code;
    // The size in the header of a PNG is not covered by what follows.
    let mut png = fixture!("photo.png").to_vec();
    png[16..24].copy_from_slice(&[0, 1, 0x86, 0xa0, 0, 1, 0x86, 0xa0]);
    assert_eq!(code(&png), ErrorCode::FileTooLarge);
    png[16..24].copy_from_slice(&[0, 0, 0x20, 0, 0, 0, 0x20, 0]);
    assert_eq!(code(&png), ErrorCode::CorruptFile);
    png[16..24].copy_from_slice(&[0; 8]);
    assert_eq!(code(&png), ErrorCode::EmptyImage);
    let mut jpeg = fixture!("photo.jpg").to_vec();
    let frame = jpeg.windows(2).position(|pair| pair == [0xff, 0xc0]).unwrap();
    jpeg[frame + 5..frame + 9].copy_from_slice(&[0xff; 4]);
    assert_eq!(code(&jpeg), ErrorCode::FileTooLarge);
    jpeg[frame + 5..frame + 9].copy_from_slice(&[0x1f, 0xff, 0x1f, 0xff]);
    assert_eq!(code(&jpeg), ErrorCode::CorruptFile);
    // The number of components is that of the header, whatever Adobe's marker says.
    let mut two = fixture!("photo.jpg").to_vec();
    two[frame + 9] = 2;
    assert!([ErrorCode::CorruptFile, ErrorCode::UnsupportedFormat].contains(&code(&two)));
    for bytes in [
        fixture!("photo.jpg"),
        fixture!("photo-cmyk.jpg"),
        fixture!("photo-progressive.jpg"),
        fixture!("photo-palette.png"),
        fixture!("photo-16.png"),
        fixture!("photo-interlaced.png"),
    ] {
        for length in 0..bytes.len() {
            let expected = [ErrorCode::CorruptFile, ErrorCode::UnsupportedFormat];
            let result = read_photo(&bytes[..length]).map(drop).map_err(|error| error.code);
            assert!(result.is_err_and(|code| expected.contains(&code)), "cut to {length}: {result:?}");
        }
    }
    assert_eq!(code(b"RIFF\0\0\0\0WEBPVP8 "), ErrorCode::UnsupportedFormat);
    assert_eq!(code(b""), ErrorCode::UnsupportedFormat);
}
