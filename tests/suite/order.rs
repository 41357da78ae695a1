//! Packed keys sort as `f32::total_cmp` sorts, and give back what went in.

use sim3align::geometry::order::{
    index_of, median, median_of_positive, pack, quantile, select_smallest, sort, value_of,
};
use wide::f32x4;

use crate::prelude::*;

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

#[wasm_bindgen_test(unsupported = test)]
fn the_median_of_positive_values_leaves_out_zeros() {
    let kinds: [fn(&mut Draw) -> f32; 4] = [
        |draw| draw.between(0.8, 1.2) as f32,
        |draw| 10f32.powi(draw.below(60) as i32 - 30),
        |draw| [1.0, 1.0, 2.0, 0.0][draw.below(4)],
        |draw| if draw.below(9) == 0 { draw.between(0.0, 1e-3) as f32 } else { 0.0 },
    ];
    for seed in 0..200 {
        let mut draw = Draw::new(seed);
        for (kind, value) in kinds.iter().enumerate() {
            let values: Vec<f32x4> =
                (0..draw.below(40)).map(|_| f32x4::new([0; 4].map(|_| value(&mut draw)))).collect();
            let expected = median(values.iter().flat_map(|four| four.to_array()).filter(|value| *value > 0.0));
            assert_eq!(median_of_positive(&values), expected, "seed {seed}, kind {kind}: {values:?}");
        }
    }
}

/// Keys in orders that are hard on one algorithm or another.
fn hard_keys(draw: &mut Draw, n: usize) -> Vec<Vec<u64>> {
    let random: Vec<u64> = (0..n).map(|i| pack(draw.between(-1.0, 1.0) as f32, i as u32)).collect();
    let ascending: Vec<u64> = (0..n as u64).collect();
    let descending = ascending.iter().rev().copied().collect();
    let organ_pipe = ascending.iter().map(|&i| i.min(n as u64 - i)).collect();
    let few = (0..n).map(|_| draw.below(3) as u64).collect();
    let wide = (0..n).map(|i| (draw.below(1 << 30) as u64) << 34 | i as u64 & 7).collect();
    vec![random, ascending, descending, organ_pipe, few, wide, vec![7; n], vec![u64::MAX; n]]
}

#[wasm_bindgen_test(unsupported = test)]
fn keys_are_sorted_and_selected_as_the_standard_library_does() {
    for seed in 0..10 {
        let mut draw = Draw::new(seed);
        for n in [0, 1, 2, 3, 15, 16, 17, 18, 100, 1000, 5000] {
            for (kind, keys) in hard_keys(&mut draw, n).into_iter().enumerate() {
                let mut expected = keys.clone();
                expected.sort_unstable();
                let mut found = keys.clone();
                sort(&mut found);
                assert_eq!(found, expected, "seed {seed}, {n} keys of kind {kind}");
                for at in [0, n / 3, n / 2, n.saturating_sub(1), n, n + 1] {
                    let mut found = keys.clone();
                    select_smallest(&mut found, at);
                    let context = format!("seed {seed}, {at} of {n} keys of kind {kind}");
                    assert_eq!(found.get(at), expected.get(at), "{context}");
                    let (front, back) = found.split_at_mut(at.min(n));
                    front.sort_unstable();
                    back.sort_unstable();
                    assert_eq!([front, back].concat(), expected, "{context}");
                }
            }
        }
    }
}
