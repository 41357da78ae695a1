//! Sorting and order statistics of f32 values, through one integer sort.
//!
//! A value and an index are packed into a u64 that sorts by the value (in `f32::total_cmp`'s order), ties by
//! the index. All sorts and selections share one instance for u64: every further element type would add several
//! kilobytes of WebAssembly.

use wide::bytemuck::cast;
use wide::{f32x4, i32x4};

/// `value` and `index` as one sortable key.
pub fn pack(value: f32, index: u32) -> u64 {
    let bits = value.to_bits();
    // Negative floats sort backwards and below the positive ones.
    let ordered = if bits >> 31 == 1 { !bits } else { bits | 1 << 31 };
    u64::from(ordered) << 32 | u64::from(index)
}

/// The index of a key.
pub fn index_of(key: u64) -> u32 {
    key as u32
}

/// The value of a key.
pub fn value_of(key: u64) -> f32 {
    let ordered = (key >> 32) as u32;
    f32::from_bits(if ordered >> 31 == 1 { ordered & !(1 << 31) } else { !ordered })
}

/// Sorts keys by a least-significant-byte radix sort: linear for every input.
#[inline(never)]
pub fn sort(keys: &mut [u64]) {
    let mut sorted = vec![0; keys.len()];
    let first = keys.first().copied().unwrap_or_default();
    let varying = keys.iter().fold(0, |bits, key| bits | (key ^ first));
    for shift in (0..64).step_by(8).filter(|shift| varying >> shift & 0xff != 0) {
        let digit = |key: u64| (key >> shift) as usize & 0xff;
        let mut starts = [0_usize; 256];
        for &key in keys.iter() {
            starts[digit(key)] += 1;
        }
        let mut start = 0;
        for slot in &mut starts {
            (*slot, start) = (start, start + *slot);
        }
        for &key in keys.iter() {
            let slot = &mut starts[digit(key)];
            sorted[*slot] = key;
            *slot += 1;
        }
        keys.copy_from_slice(&sorted);
    }
}

/// Number of keys below which a partition is sorted by insertion.
const FEW: usize = 16;

/// Moves the `n` smallest keys to the front, followed by the next larger one. Does nothing if there are at most `n`
/// keys.
#[inline(never)]
pub fn select_smallest(keys: &mut [u64], n: usize) {
    let (mut low, mut high) = (0, keys.len());
    if n >= high {
        return;
    }
    // Quickselect; falls back to sorting if the input defeats the median of three.
    for _ in 0..64 {
        let part = &mut keys[low..high];
        if part.len() <= FEW {
            for i in 1..part.len() {
                let mut j = i;
                while j > 0 && part[j] < part[j - 1] {
                    part.swap(j, j - 1);
                    j -= 1;
                }
            }
            return;
        }
        let (a, b, c) = (part[0], part[part.len() / 2], part[part.len() - 1]);
        let pivot = a.min(b).max(c).min(a.max(b));
        let mut below = divide(part, |key| key < pivot);
        if below == 0 {
            // The pivot is the smallest: it is in place, with all keys equal to it.
            below = divide(part, |key| key == pivot);
            if n < low + below {
                return;
            }
        }
        if n < low + below {
            high = low + below;
        } else {
            low += below;
        }
    }
    sort(&mut keys[low..high]);
}

/// Moves the keys that satisfy `first` to the front and returns their number.
fn divide(keys: &mut [u64], first: impl Fn(u64) -> bool) -> usize {
    let mut count = 0;
    for i in 0..keys.len() {
        let is_first = first(keys[i]);
        keys.swap(i, count);
        count += usize::from(is_first);
    }
    count
}

/// The indices of the `count` largest values, the largest first; ties go to the smaller index.
pub fn largest(values: impl Iterator<Item = f32>, count: usize) -> Vec<u32> {
    let mut keys: Vec<u64> = (0..).zip(values).map(|(i, value)| pack(-value, i)).collect();
    select_smallest(&mut keys, count);
    keys.truncate(count);
    sort(&mut keys);
    keys.into_iter().map(index_of).collect()
}

/// Moves the ⌊n/2⌋ indices with the smallest values to the front; ties go to the smaller index.
pub fn halve(indices: &mut [u32], value: impl Fn(u32) -> f32) {
    let mut keys: Vec<u64> = indices.iter().map(|&index| pack(value(index), index)).collect();
    select_smallest(&mut keys, indices.len() / 2);
    for (index, key) in indices.iter_mut().zip(keys) {
        *index = index_of(key);
    }
}

/// The quantile (0 to 1): the sorted value at index ⌊quantile · n⌋. `None` without values.
pub fn quantile(values: impl Iterator<Item = f32>, quantile: f64) -> Option<f32> {
    let mut keys: Vec<u64> = Vec::with_capacity(values.size_hint().1.unwrap_or(0));
    keys.extend(values.map(|value| pack(value, 0)));
    at_quantile(&mut keys, quantile)
}

#[inline(never)]
fn at_quantile(keys: &mut [u64], quantile: f64) -> Option<f32> {
    let at = ((quantile * keys.len() as f64) as usize).min(keys.len().checked_sub(1)?);
    select_smallest(keys, at);
    keys.get(at).copied().map(value_of)
}

/// The median; of an even number of values, the upper of the two middle ones. `None` without values.
pub fn median(values: impl Iterator<Item = f32>) -> Option<f32> {
    quantile(values, 0.5)
}

/// Number of values that are left to be sorted.
const LEFT: usize = 16;

/// The [`median`] of the values above 0, which takes no copy of them.
pub fn median_of_positive(values: &[f32x4]) -> Option<f32> {
    // The bits of positive values have their order, and others are taken for 0.
    let bits = |value: &f32x4| -> i32x4 { cast(*value & value.simd_gt(f32x4::ZERO)) };
    let up_to = |most: i32| {
        let is_above = |value| bits(value).simd_gt(i32x4::splat(most));
        let above = values.iter().fold(i32x4::ZERO, |above, value| above + is_above(value));
        values.len() * 4 - above.to_array().iter().map(|lane| lane.unsigned_abs() as usize).sum::<usize>()
    };
    let mut below = up_to(0);
    let mut through = values.len() * 4;
    if below == through {
        return None;
    }
    let rank = below + (through - below) / 2;
    // Halves the range of the bits until it holds few values: counting is faster than moving them.
    let highest = values.iter().fold(i32x4::ZERO, |highest, value| highest.max(bits(value))).reduce_max();
    let without_zeros = |value: &f32x4| bits(value) | (i32x4::splat(i32::MAX) & bits(value).simd_eq(i32x4::ZERO));
    let lowest = values.iter().fold(i32x4::MAX, |lowest, value| lowest.min(without_zeros(value))).reduce_min();
    let (mut low, mut high) = (lowest, highest);
    while low < high && through - below > LEFT {
        let middle = low + (high - low) / 2;
        let count = up_to(middle);
        if count > rank {
            (high, through) = (middle, count);
        } else {
            (low, below) = (middle + 1, count);
        }
    }
    if low == high {
        return Some(f32::from_bits(low as u32));
    }
    let mut left: Vec<u64> = Vec::with_capacity(LEFT);
    for value in values {
        left.extend(bits(value).to_array().iter().filter(|bits| (low..=high).contains(*bits)).map(|bits| *bits as u64));
    }
    select_smallest(&mut left, rank - below);
    left.get(rank - below).map(|bits| f32::from_bits(*bits as u32))
}
