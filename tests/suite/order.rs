//! Packed keys sort as `f32::total_cmp` sorts, and give back what went in.

use sim3align::geometry::order::{index_of, median, pack, quantile, value_of};
use wasm_bindgen_test::wasm_bindgen_test;

const VALUES: [f32; 11] =
    [f32::NEG_INFINITY, -1e30, -2.5, -1e-40, -0.0, 0.0, 1e-40, 1.0, 1.000_000_1, 3e38, f32::INFINITY];

#[wasm_bindgen_test(unsupported = test)]
fn keys_keep_value_index_and_order() {
    for (i, &a) in VALUES.iter().enumerate() {
        assert_eq!(value_of(pack(a, 7)).to_bits(), a.to_bits());
        assert_eq!(index_of(pack(a, u32::MAX)), u32::MAX);
        assert!(pack(a, 1) < pack(a, 2));
        for &b in &VALUES[i + 1..] {
            assert!(pack(a, 9) < pack(b, 0), "{a} should sort before {b}");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn quantiles_by_hand() {
    let values = || [5.0, 1.0, 4.0, 2.0, 3.0].into_iter();
    assert_eq!(median(values()), Some(3.0));
    assert_eq!(quantile(values(), 0.0), Some(1.0));
    assert_eq!(quantile(values(), 1.0), Some(5.0));
    assert_eq!(median([2.0, 1.0].into_iter()), Some(2.0));
    assert_eq!(median(core::iter::empty()), None);
}
