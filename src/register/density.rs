//! Separates dense points on surfaces from sparse points scattered through the volume.

use glam::Vec3;

use crate::geometry::kd_tree::KdTree;
use crate::geometry::order::quantile;
use crate::scheduler::Scheduler;

/// The neighbour whose distance measures the density at a point.
const NEIGHBOR: usize = 8;

/// Quantile of these distances that represents the surface; valid if at most three quarters of the points are clutter.
const SURFACE_QUANTILE: f64 = 0.25;

/// Maximum ratio of the distance at a point to that quantile. On a randomly sampled surface, the distance to the eighth
/// neighbour varies by a quarter; for as many points in a volume, it is about three times larger.
const SPARSER: f32 = 1.5;

/// Units of work of a search for the neighbour.
const SEARCH: f64 = 1e-3;

/// Indices of the points that are about as dense as the densest quarter, in ascending order.
pub async fn dense_points(points: &[Vec3], scheduler: &Scheduler) -> Vec<usize> {
    let tree = KdTree::paused(points, scheduler).await;
    let mut found = Vec::new();
    let mut reaches_squared: Vec<f32> = Vec::with_capacity(points.len());
    for &point in points {
        tree.k_nearest(point, NEIGHBOR + 1, &mut found);
        reaches_squared.push(found.last().map_or(f32::INFINITY, |n| n.distance_squared));
        scheduler.yield_after(SEARCH).await;
    }
    let surface = quantile(reaches_squared.iter().copied(), SURFACE_QUANTILE).unwrap_or_default();
    let limit = SPARSER * SPARSER * surface;
    reaches_squared.iter().enumerate().filter(|(_, r)| **r <= limit).map(|(i, _)| i).collect()
}
