//! Numbers in messages read as a person writes them.

use sim3align::number::{number, numbers};

use crate::prelude::*;

#[wasm_bindgen_test(unsupported = test)]
fn writes_numbers_by_hand() {
    let written = [
        (0.0, "0"),
        (-3.0, "-3"),
        (0.05, "0.05"),
        (1234.5, "1234.5"),
        (0.1 + 0.2, "0.3"),
        (2.0 / 3.0, "0.666667"),
        (999_999.96, "1000000"),
        (123_456_789.4, "123457000"),
        (1.5e-9, "1.5e-9"),
        (9.999_999_9e-6, "0.00001"),
        (-1e300, "-1e300"),
        (f64::NAN, "NaN"),
        (f64::NEG_INFINITY, "-Infinity"),
    ];
    for (x, text) in written {
        assert_eq!(number(x), text);
    }
    assert_eq!(numbers(&[0.5, 1.5]), "[0.5, 1.5]");
}

#[wasm_bindgen_test(unsupported = test)]
fn agrees_with_the_standard_library_to_six_digits() {
    let mut x = 1.234_567_89e-300_f64;
    while x < 1e300 {
        let back: f64 = number(x).parse().unwrap();
        assert!((back / x - 1.0).abs() < 5.1e-6, "{x} was written as {}", number(x));
        x *= -3.7;
        x = x.abs() * 1.01;
    }
}
