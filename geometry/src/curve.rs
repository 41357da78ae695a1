//! A curve that fills space: an order of points in which neighbours are close to each other.

use glam::Vec3;

use super::cloud::Bounds;
use super::order::{index_of, sort_from};

/// Bits of a coordinate, and its largest value.
const BITS: u32 = 10;
const MOST: f32 = ((1 << BITS) - 1) as f32;

/// The indices of points along the curve of Morton ("A computer oriented geodetic data base", 1966), over the cube that
/// contains them.
#[inline(never)]
pub fn along_curve(points: &[Vec3]) -> Vec<u32> {
    let all = Bounds::of(points).unwrap_or(Bounds::NOTHING);
    let scale = MOST / all.extent().max_element().max(f32::MIN_POSITIVE);
    let key = |(index, point): (u32, &Vec3)| {
        let [x, y, z] = ((*point - all.min) * scale).to_array().map(|cell| spread(cell as u32));
        u64::from(x << 2 | y << 1 | z) << 32 | u64::from(index)
    };
    let mut keys: Vec<u64> = (0..).zip(points).map(key).collect();
    sort_from(32, &mut keys);
    keys.into_iter().map(index_of).collect()
}

/// The lowest [`BITS`] of a number, three places apart.
fn spread(bits: u32) -> u32 {
    let bits = (bits | bits << 16) & 0x0300_00ff;
    let bits = (bits | bits << 8) & 0x0300_f00f;
    let bits = (bits | bits << 4) & 0x030c_30c3;
    (bits | bits << 2) & 0x0924_9249
}
