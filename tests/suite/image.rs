//! Images: what a reading is, resampling, sizes.

use crate::prelude::*;

#[wasm_bindgen_test(unsupported = test)]
fn depths_that_are_no_reading_become_0() {
    let raw = [1.5, 0.0, -0.0, -2.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MIN_POSITIVE, f32::MAX];
    let depth = DepthMap::from_metres(3, 3, raw.to_vec()).unwrap();
    let bits: Vec<u32> = depth.data().iter().map(|z| z.to_bits()).collect();
    assert_eq!(bits, [1.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, f32::MIN_POSITIVE, f32::MAX].map(f32::to_bits));
}

#[wasm_bindgen_test(unsupported = test)]
fn sizes_and_lengths_belong_together() {
    for (width, height, length, code) in [
        (0, 4, 0, ErrorCode::EmptyImage),
        (4, 0, 0, ErrorCode::EmptyImage),
        (4, 3, 11, ErrorCode::WrongLength),
        (4, 3, 13, ErrorCode::WrongLength),
        // A product that overflows to 0.
        (1 << (usize::BITS / 2), 1 << (usize::BITS / 2), 0, ErrorCode::WrongLength),
        (usize::MAX, usize::MAX, 1, ErrorCode::WrongLength),
    ] {
        let error = Mask::new("mask", width, height, vec![0; length]).unwrap_err();
        assert_eq!((error.code, &*error.argument), (code, "mask"), "{width} × {height}");
        let error = DepthMap::from_metres(width, height, vec![0.0; length]).unwrap_err();
        assert_eq!((error.code, &*error.argument), (code, "depth"), "{width} × {height}");
    }
    let error = Mask::new("mask", 4, 3, vec![0; 11]).unwrap_err().to_string();
    assert!(error.contains("11 values") && error.contains("4 × 3 = 12"), "{error}");
}

#[wasm_bindgen_test(unsupported = test)]
fn pixels_are_row_major() {
    let mut image = Image::new("x", 3, 2, vec![0, 1, 2, 10, 11, 12]).unwrap();
    assert_eq!((image.width(), image.height()), (3, 2));
    assert_eq!(image.get(2, 1), Some(12));
    assert_eq!([image.get(3, 0), image.get(0, 2), image.get(usize::MAX, usize::MAX)], [None; 3]);
    image.data_mut()[4] = 7;
    assert_eq!(image.get(1, 1), Some(7));
    assert_eq!(Image::filled(2, 2, 5), Image::new("x", 2, 2, vec![5; 4]).unwrap());
}

#[wasm_bindgen_test(unsupported = test)]
fn resampling_takes_the_pixel_under_the_centre() {
    let image = Image::new("x", 3, 2, vec![0, 1, 2, 10, 11, 12]).unwrap();
    assert_eq!(image.resize_nearest(3, 2), image);
    let double = image.resize_nearest(6, 4);
    assert_eq!(double.data()[..6], [0, 0, 1, 1, 2, 2]);
    assert_eq!(double.data()[6..12], double.data()[..6]);
    assert_eq!(double.data()[18..], [10, 10, 11, 11, 12, 12]);
    assert_eq!(double.resize_nearest(3, 2), image);
    // Down to one pixel: the one in the middle; of an even number, the one after the middle.
    assert_eq!(image.resize_nearest(1, 1).data(), [11]);
    // 3 → 2: the centres lie at 0.75 and 2.25 of the old pixels' edges.
    assert_eq!(image.resize_nearest(2, 1).data(), [10, 12]);
    // Against the definition in floating point.
    for (from, to) in [(5, 7), (7, 5), (640, 518), (518, 640), (1, 9), (9, 1), (1000, 999)] {
        let line = Image::new("x", from, 1, (0..from).collect()).unwrap().resize_nearest(to, 1);
        let expected = (0..to).map(|i| ((i as f64 + 0.5) * from as f64 / to as f64).floor() as usize);
        assert!(line.data().iter().copied().eq(expected), "{from} → {to}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn long_rows_do_not_overflow() {
    // 70 000² is more than a 32-bit usize holds.
    let n = 70_000;
    let line = Image::new("x", n, 1, (0..n as u32).collect()).unwrap();
    assert_eq!(line.resize_nearest(n, 1), line);
}
