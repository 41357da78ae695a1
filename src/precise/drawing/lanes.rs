//! Four neighbouring cells of a grid at a time.

use wide::bytemuck::cast;
use wide::{f32x4, i32x4};

/// Cells at a time.
pub const LANES: usize = 4;

/// Four values from `at` on; 0 beyond the end.
#[inline(always)]
pub fn four(values: &[f32], at: usize) -> f32x4 {
    match values.get(at..).and_then(|values| values.first_chunk::<LANES>()) {
        Some(four) => f32x4::new(*four),
        None => last(values, at),
    }
}

#[cold]
#[inline(never)]
fn last(values: &[f32], at: usize) -> f32x4 {
    f32x4::new([0, 1, 2, 3].map(|lane| values.get(at + lane).copied().unwrap_or(0.0)))
}

/// All bits of the lanes of four flags from `at` on that are set; none beyond the end.
#[inline(always)]
pub fn four_set(flags: &[bool], at: usize) -> f32x4 {
    let bits = match flags.get(at..).and_then(|flags| flags.first_chunk::<LANES>()) {
        Some(&[a, b, c, d]) => u32::from_le_bytes([a.into(), b.into(), c.into(), d.into()]),
        None => (0..LANES).map(|lane| u32::from(flags.get(at + lane) == Some(&true)) << (8 * lane)).sum(),
    };
    cast((i32x4::splat(bits as i32) & i32x4::new([1, 1 << 8, 1 << 16, 1 << 24])).simd_gt(i32x4::ZERO))
}

/// All bits of the first `count` lanes.
#[inline(always)]
pub fn first(count: usize) -> f32x4 {
    cast(i32x4::new([0, 1, 2, 3]).simd_lt(i32x4::splat(count.min(LANES) as i32)))
}

/// The sum with the lanes added in turn, as one cell after the other would be.
#[inline(always)]
pub fn plus(sum: f32, lanes: f32x4) -> f32 {
    let [a, b, c, d] = lanes.to_array();
    sum + a + b + c + d
}

/// Number of lanes with bits set, of lanes with all or none.
#[inline(always)]
pub fn count(lanes: f32x4) -> u32 {
    lanes.to_bitmask().count_ones()
}
