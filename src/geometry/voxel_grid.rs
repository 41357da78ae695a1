//! Voxel downsampling: one point, the mean, per occupied cell.

use glam::{I64Vec3, Vec3};

use super::cloud::{Bounds, Cloud};

/// Cells along an axis; what lies beyond shares the last one. 2²¹ cells of 1 mm are two kilometres.
const MAX_CELLS: i64 = (1 << 21) - 1;

/// The mean point (and the normalised mean normal) of every occupied cell of edge `voxel_size`, cell by cell
/// in ascending x, then y, then z. Cells are counted from the cloud's own smallest corner, so that the result
/// moves with the cloud. Sorted rather than hashed: the order never depends on the platform. The cloud as it is
/// where `voxel_size` is not above 0.
pub fn voxel_downsample(cloud: &Cloud, voxel_size: f32) -> Cloud {
    let Some(bounds) = Bounds::of(&cloud.points) else { return Cloud::default() };
    if voxel_size.is_nan() || voxel_size <= 0.0 {
        return cloud.clone();
    }
    let cell = |p: Vec3| ((p - bounds.min) / voxel_size).as_i64vec3().clamp(I64Vec3::ZERO, I64Vec3::splat(MAX_CELLS));
    let key = |p: Vec3| {
        let c = cell(p);
        (c.x << 42) | (c.y << 21) | c.z
    };
    let mut keyed: Vec<(i64, u32)> = cloud.points.iter().map(|&p| key(p)).zip(0..).collect();
    keyed.sort_unstable();

    let mut out = Cloud::default();
    for run in keyed.chunk_by(|a, b| a.0 == b.0) {
        let members = || run.iter().map(|&(_, i)| i as usize);
        // Sums are taken about the first member: a mean of large coordinates keeps its digits.
        let first = cloud.points[run[0].1 as usize];
        let sum: Vec3 = members().map(|i| cloud.points[i] - first).sum();
        out.points.push(first + sum / run.len() as f32);
        if !cloud.normals.is_empty() {
            out.normals.push(members().filter_map(|i| cloud.normals.get(i)).sum::<Vec3>().normalize_or_zero());
        }
    }
    out
}
