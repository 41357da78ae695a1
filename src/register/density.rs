//! Which points of a cloud lie on a surface: dense beside those scattered through the volume.

use glam::Vec3;

use crate::geometry::kd_tree::KdTree;
use crate::geometry::order::quantile;

/// The neighbour whose distance stands for a point's density.
const NEIGHBOR: usize = 8;

/// Of the distances to that neighbour, the one that stands for the surface: right while at most three quarters
/// of the points are clutter.
const SURFACE_QUANTILE: f64 = 0.25;

/// How many times sparser than that a point may be. On a surface sampled at random the distance to the eighth
/// neighbour varies by a quarter; through a volume of like count it is about three times larger.
const SPARSER: f32 = 1.5;

/// Indices of the points that are about as dense as the densest quarter, in order.
pub fn dense_points(points: &[Vec3]) -> Vec<usize> {
    let tree = KdTree::new(points);
    let mut found = Vec::new();
    let mut reach = |&point: &Vec3| {
        tree.k_nearest(point, NEIGHBOR + 1, &mut found);
        found.last().map_or(f32::INFINITY, |n| n.distance_squared)
    };
    let reaches_squared: Vec<f32> = points.iter().map(&mut reach).collect();
    let surface = quantile(reaches_squared.iter().copied(), SURFACE_QUANTILE).unwrap_or_default();
    let limit = SPARSER * SPARSER * surface;
    reaches_squared.iter().enumerate().filter(|(_, r)| **r <= limit).map(|(i, _)| i).collect()
}
