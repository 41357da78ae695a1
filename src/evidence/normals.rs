//! Normal estimation for point clouds by principal component analysis.

use glam::{DMat3, DVec3, Vec3};

use crate::geometry::kd_tree::{GroupSearch, KdTree};
use crate::geometry::order::{index_of, median};
use crate::geometry::symmetric_eigen::SymmetricEigen;
use crate::scheduler::Scheduler;

/// Ratio of the middle to the largest eigenvalue below which a neighbourhood is collinear.
const COLLINEAR: f64 = 1e-8;

/// Units of work of a point's normal, and of a point of which a median is made.
const NORMAL: f64 = 2e-3;
const OF_MEDIAN: f64 = 3e-5;

/// The orientation of normals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Orientation {
    /// Towards the origin, for clouds in the frame of a camera.
    TowardsCamera,
    /// Away from this point, such as the centre of a closed object.
    AwayFrom(Vec3),
}

/// The [`Estimation`] of all points, yielding.
pub async fn paused_normals(
    points: &[Vec3],
    tree: &KdTree,
    neighbors: usize,
    orientation: Orientation,
    scheduler: &Scheduler,
) -> Vec<Vec3> {
    let mut estimation = Estimation::new(points, tree, neighbors, orientation);
    for group in tree.groups() {
        estimation.add(group);
        scheduler.yield_after(NORMAL * group.len() as f64).await;
    }
    estimation.normals
}

/// Unit normals of points by principal component analysis of their neighbours (Hoppe et al. 1992, §3.2): the
/// eigenvector of the smallest eigenvalue of the covariance.
pub struct Estimation<'a> {
    points: &'a [Vec3],
    search: GroupSearch<'a>,
    orientation: Orientation,
    /// The normals so far: zero for the others, and for points with fewer than three neighbours, or with neighbours that
    /// are collinear.
    pub normals: Vec<Vec3>,
}

impl<'a> Estimation<'a> {
    /// No normals so far. `tree` is the search tree over the points; `neighbors` counts the point itself.
    pub fn new(points: &'a [Vec3], tree: &'a KdTree, neighbors: usize, orientation: Orientation) -> Self {
        let search = GroupSearch::new(tree, points, neighbors);
        Self { points, search, orientation, normals: vec![Vec3::ZERO; points.len()] }
    }

    /// Estimates the normals of points that are close to each other.
    pub fn add(&mut self, group: &[(Vec3, u32)]) {
        let Self { points, search, orientation, normals } = self;
        search.visit(group, &mut |index, neighbors| {
            let Some((&point, slot)) = points.get(index as usize).zip(normals.get_mut(index as usize)) else { return };
            let normal = thinnest_direction(point, neighbors, points);
            let outward = match *orientation {
                Orientation::TowardsCamera => -point,
                Orientation::AwayFrom(center) => point - center,
            };
            *slot = if normal.dot(outward) < 0.0 { -normal } else { normal };
        });
    }
}

/// Normals that point away from the viewpoint `eye` or, if it is unknown, from the median of the points, which is
/// robust to clutter. Without viewpoints, this orientation is consistent between two clouds.
pub async fn outward_normals(points: &[Vec3], eye: Option<Vec3>, neighbors: usize, scheduler: &Scheduler) -> Vec<Vec3> {
    let mut center = eye.unwrap_or_default();
    for axis in (0..3).take_while(|_| eye.is_none()) {
        center[axis] = median(points.iter().map(|p| p[axis])).unwrap_or_default();
        scheduler.yield_after(OF_MEDIAN * points.len() as f64).await;
    }
    let tree = KdTree::paused(points, scheduler).await;
    paused_normals(points, &tree, neighbors, Orientation::AwayFrom(center), scheduler).await
}

/// The unit eigenvector of the smallest eigenvalue, or zero if the neighbours do not span a plane. Sums are relative to
/// `point`, to preserve precision.
fn thinnest_direction(point: Vec3, neighbors: &[u64], points: &[Vec3]) -> Vec3 {
    let (mut sum, mut squares, mut count) = (DVec3::ZERO, DMat3::ZERO, 0.0);
    for p in neighbors.iter().filter_map(|&key| points.get(index_of(key) as usize)) {
        let d = (p - point).as_dvec3();
        sum += d;
        squares += DMat3::from_cols(d * d.x, d * d.y, d * d.z);
        count += 1.0;
    }
    if count < 3.0 {
        return Vec3::ZERO;
    }
    let mean = sum / count;
    let covariance = squares * (1.0 / count) - DMat3::from_cols(mean * mean.x, mean * mean.y, mean * mean.z);
    let eigen = SymmetricEigen::of(covariance);
    if eigen.values[1] > COLLINEAR * eigen.values[2] { eigen.vectors[0].as_vec3() } else { Vec3::ZERO }
}
