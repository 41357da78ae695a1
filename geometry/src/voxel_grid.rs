//! Voxel downsampling: the mean of the points in each occupied cell.

use glam::Vec3;

use super::cloud::{Bounds, Cloud};
use super::order::{index_of, sort};

/// Limit on the cells along an axis; points beyond are assigned to the last one. 2²¹ cells of 1 mm span two kilometres.
const MAX_CELLS: u32 = (1 << 21) - 1;

/// Rounds of [`voxel_size_leaving`], and the minimum growth of the voxels per round: a thousandfold in total.
const MAX_ROUNDS: usize = 64;
const MIN_GROWTH: f32 = 1.03;

/// The mean point (and the normalised mean normal) of every occupied cell of edge `voxel_size`, ordered by x, then y,
/// then z of the cell. The grid starts at the smallest corner of the cloud, so that the result moves with the cloud.
/// Cells are sorted instead of hashed: the order does not depend on the platform. Returns the cloud unchanged if
/// `voxel_size` is not above 0.
pub fn voxel_downsample(cloud: &Cloud, voxel_size: f32) -> Cloud {
    let Some(bounds) = Bounds::of(&cloud.points) else { return Cloud::default() };
    if voxel_size.is_nan() || voxel_size <= 0.0 {
        return cloud.clone();
    }
    let cells: Vec<[u32; 3]> = cloud.points.iter().map(|&p| cell(p, bounds.min, voxel_size)).collect();
    let order = in_cell_order(&cells);

    let mut out = Cloud::default();
    for run in order.chunk_by(|&i, &j| cells[i as usize] == cells[j as usize]) {
        let members = || run.iter().map(|&i| i as usize);
        // Sums are relative to the first member, so that the mean of large coordinates loses no precision.
        let first = cloud.points[run[0] as usize];
        let sum: Vec3 = members().map(|i| cloud.points[i] - first).sum();
        out.points.push(first + sum / run.len() as f32);
        if !cloud.normals.is_empty() {
            out.normals.push(members().filter_map(|i| cloud.normals.get(i)).sum::<Vec3>().normalize_or_zero());
        }
    }
    out
}

/// A voxel size that leaves at most `count` points of a cloud and, if the points sample a surface, not many fewer.
pub fn voxel_size_leaving(cloud: &Cloud, count: usize) -> f32 {
    let wanted = count.max(1) as f32;
    let Some(bounds) = Bounds::of(&cloud.points) else { return 0.0 };
    // Starts too fine for any surface that fills its box. Doubling the voxels quarters the cells of a surface.
    let mut size = 0.3 * bounds.diagonal() / wanted.sqrt();
    for _ in 0..MAX_ROUNDS {
        let left = voxel_downsample(cloud, size).len();
        if left <= count {
            break;
        }
        let growth = (left as f32 / wanted).sqrt();
        size *= if growth < MIN_GROWTH { MIN_GROWTH } else { growth };
    }
    size
}

fn cell(p: Vec3, min: Vec3, voxel_size: f32) -> [u32; 3] {
    // Casts from float saturate: points beyond the last cell are assigned to it.
    ((p - min) / voxel_size).to_array().map(|x| (x as u32).min(MAX_CELLS))
}

/// Indices sorted by cell x, y, z, then index: one sort per axis, the least significant first. Each sort is stable,
/// because the rank in the previous one breaks ties.
fn in_cell_order(cells: &[[u32; 3]]) -> Vec<u32> {
    let mut order: Vec<u32> = (0..cells.len() as u32).collect();
    let mut keys = Vec::with_capacity(cells.len());
    for axis in [2, 1, 0] {
        keys.clear();
        keys.extend(order.iter().zip(0..).map(|(&i, rank)| u64::from(cells[i as usize][axis]) << 32 | rank));
        sort(&mut keys);
        order = keys.iter().map(|&key| order[index_of(key) as usize]).collect();
    }
    order
}
