//! Voxel downsampling: the mean of the points in each occupied cell.

use glam::Vec3;

use super::cloud::{Bounds, Cloud};
use super::order::{index_of, sort_from};
use sim3align_runtime::scheduler::{Scheduler, finished};

/// Limit on the cells along an axis; points beyond are assigned to the last one. 2²¹ cells of 1 mm span two kilometres.
const MAX_CELLS: u32 = (1 << 21) - 1;

/// Rounds of [`voxel_size_leaving`], and the minimum growth of the voxels per round: at least 6.6-fold in total.
const MAX_ROUNDS: usize = 64;
const MIN_GROWTH: f32 = 1.03;

/// Units of work of a point that is sorted by an axis, and of one that is averaged.
const SORTED: f64 = 3e-5;
const AVERAGED: f64 = 2e-5;

/// The mean point (and the normalised mean normal) of every occupied cell of edge `voxel_size`, ordered by x, then y,
/// then z of the cell. The grid starts at the smallest corner of the cloud, so that the result moves with the cloud.
/// Cells are sorted instead of hashed: the order does not depend on the platform. Returns the cloud unchanged if
/// `voxel_size` is not above 0.
pub fn voxel_downsample(cloud: &Cloud, voxel_size: f32) -> Cloud {
    finished(paused_downsample(cloud, voxel_size, &Scheduler::unbounded()))
}

/// [`voxel_downsample`], yielding.
pub async fn paused_downsample(cloud: &Cloud, voxel_size: f32, scheduler: &Scheduler) -> Cloud {
    match Occupied::of(&cloud.points, voxel_size, scheduler).await {
        None => cloud.clone(),
        Some(occupied) => {
            scheduler.yield_after(AVERAGED * cloud.len() as f64).await;
            occupied.means(cloud)
        }
    }
}

/// A voxel size that leaves at most `count` points of a cloud and, if the points sample a surface, not many fewer.
pub async fn voxel_size_leaving(cloud: &Cloud, count: usize, scheduler: &Scheduler) -> f32 {
    let wanted = count.max(1) as f32;
    let Some(bounds) = Bounds::of(&cloud.points) else { return 0.0 };
    // Starts too fine for any surface that fills its box. Doubling the voxels quarters the cells of a surface.
    let mut size = 0.3 * bounds.diagonal() / wanted.sqrt();
    for _ in 0..MAX_ROUNDS {
        let occupied = Occupied::of(&cloud.points, size, scheduler).await;
        let left = occupied.map_or(cloud.len(), |occupied| occupied.cells().count());
        if left <= count {
            break;
        }
        let growth = (left as f32 / wanted).sqrt();
        size *= if growth < MIN_GROWTH { MIN_GROWTH } else { growth };
    }
    size
}

/// The occupied cells of a grid.
struct Occupied {
    /// The cell of each point.
    cell_of: Vec<[u32; 3]>,
    /// The points by cell x, y, z, then index.
    order: Vec<u32>,
}

impl Occupied {
    /// `None` without points, or for a `voxel_size` that is not above 0.
    async fn of(points: &[Vec3], voxel_size: f32, scheduler: &Scheduler) -> Option<Self> {
        let bounds = Bounds::of(points).filter(|_| voxel_size > 0.0)?;
        let cell_of: Vec<[u32; 3]> = points.iter().map(|&p| cell(p, bounds.min, voxel_size)).collect();
        let mut order: Vec<u32> = (0..points.len() as u32).collect();
        // One sort per axis, the least significant first.
        for axis in [2, 1, 0] {
            scheduler.yield_after(SORTED * points.len() as f64).await;
            order = sorted_by(axis, &cell_of, &order);
        }
        Some(Self { cell_of, order })
    }

    /// The points of each cell.
    fn cells(&self) -> impl Iterator<Item = &[u32]> {
        self.order.chunk_by(|&i, &j| self.cell_of[i as usize] == self.cell_of[j as usize])
    }

    fn means(&self, cloud: &Cloud) -> Cloud {
        let mut out = Cloud::default();
        for cell in self.cells() {
            let members = || cell.iter().map(|&i| i as usize);
            // Sums are relative to the first member, so that the mean of large coordinates loses no precision.
            let first = cloud.points[cell[0] as usize];
            let sum: Vec3 = members().map(|i| cloud.points[i] - first).sum();
            out.points.push(first + sum / cell.len() as f32);
            if !cloud.normals.is_empty() {
                out.normals.push(members().filter_map(|i| cloud.normals.get(i)).sum::<Vec3>().normalize_or_zero());
            }
        }
        out
    }
}

fn cell(p: Vec3, min: Vec3, voxel_size: f32) -> [u32; 3] {
    // Casts from float saturate: points beyond the last cell are assigned to it.
    ((p - min) / voxel_size).to_array().map(|x| (x as u32).min(MAX_CELLS))
}

/// The indices sorted by an axis of their cells; equal ones keep their order.
#[inline(never)]
fn sorted_by(axis: usize, cells: &[[u32; 3]], order: &[u32]) -> Vec<u32> {
    let cell_and_index = |&i: &u32| u64::from(cells[i as usize][axis]) << 32 | u64::from(i);
    let mut keys: Vec<u64> = order.iter().map(cell_and_index).collect();
    sort_from(32, &mut keys);
    keys.into_iter().map(index_of).collect()
}
