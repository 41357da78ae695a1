//! A curve that fills space: an order of points in which neighbours are close to each other.

use glam::Vec3;

use super::order::{index_of, sort_from};

/// Bits of a coordinate, and its largest value.
const BITS: u32 = 10;
const MOST: f32 = ((1 << BITS) - 1) as f32;

/// The indices of points along the curve of Morton ("A computer oriented geodetic data base", 1966), over the cube that
/// contains them.
pub fn along_curve(points: impl Iterator<Item = Vec3> + Clone) -> Vec<u32> {
    let nothing = [Vec3::INFINITY, Vec3::NEG_INFINITY];
    let [min, max] = points.clone().fold(nothing, |[min, max], p| [min.min(p), max.max(p)]);
    let scale = MOST / (max - min).max_element().max(f32::MIN_POSITIVE);
    let key = |(index, point): (u32, Vec3)| {
        let [x, y, z] = ((point - min) * scale).to_array().map(|cell| spread(cell as u32));
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
