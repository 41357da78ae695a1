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
pub fn sort(keys: &mut [u64]) {
    sort_from(0, keys);
}

/// Sorts keys by their bits from this one on, and keeps the order of keys that differ below it only.
#[inline(never)]
pub fn sort_from(bit: usize, keys: &mut [u64]) {
    let mut sorted = vec![0; keys.len()];
    let first = keys.first().copied().unwrap_or_default();
    let varying = keys.iter().fold(0, |bits, key| bits | (key ^ first));
    for shift in (bit..64).step_by(8).filter(|shift| varying >> shift & 0xff != 0) {
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
const LEFT: usize = 4;

/// The [`median`] of the values above 0, where the others are 0. Counts instead of moving values.
pub fn median_of_positive(values: &[f32x4]) -> Option<f32> {
    // The bits of positive values have their order.
    let bits = |value: &f32x4| cast::<f32x4, i32x4>(*value);
    let all = values.len() * 4;
    let up_to = |most: i32| {
        let most = i32x4::splat(most);
        let mut above = i32x4::ZERO;
        for value in values {
            above += bits(value).simd_gt(most);
        }
        (all as i32 + above.to_array().iter().sum::<i32>()) as usize
    };
    let (mut lowest, mut highest) = (i32x4::MAX, i32x4::ZERO);
    for value in values {
        let bits = bits(value);
        highest = highest.max(bits);
        lowest = lowest.min(bits | (bits.simd_eq(i32x4::ZERO) & i32x4::MAX));
    }
    let (mut below, mut through) = (up_to(0), all);
    if below == through {
        return None;
    }
    let rank = below + (through - below) / 2;
    let (mut low, mut high) = (lowest.reduce_min(), highest.reduce_max());
    while low < high && through - below > LEFT {
        let middle = low + (high - low) / 2;
        let count = up_to(middle);
        if count > rank {
            (high, through) = (middle, count);
        } else {
            (low, below) = (middle + 1, count);
        }
    }
    let mut left = [0; LEFT];
    let mut count = 0;
    if low < high {
        let (first, last) = (i32x4::splat(low - 1), i32x4::splat(high));
        for value in values {
            let bits = bits(value);
            let is_left: i32x4 = bits.simd_gt(first) & !bits.simd_gt(last);
            if is_left.any() {
                for (bits, is_left) in bits.to_array().into_iter().zip(is_left.to_array()) {
                    if is_left != 0 && count < LEFT {
                        left[count] = bits as u64;
                        count += 1;
                    }
                }
            }
        }
        select_smallest(&mut left[..count], rank - below);
        low = left[rank - below] as i32;
    }
    Some(f32::from_bits(low as u32))
}
