//! Normals of a cloud: the direction in which a point's neighbourhood is thinnest.

use glam::{DMat3, DVec3, Vec3};

use crate::geometry::kd_tree::KdTree;
use crate::geometry::order::{index_of, median};
use crate::geometry::symmetric_eigen::SymmetricEigen;

/// Variance across a neighbourhood, as a share of that along it, below which it is a line.
const COLLINEAR: f64 = 1e-8;

/// Which points are a point's neighbours: the nearest `max_neighbors` that lie within `radius`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neighborhood {
    /// Most neighbours, the point itself included.
    pub max_neighbors: usize,
    /// How far they may be, in the points' unit; infinite for no bound.
    pub radius: f32,
}

impl Neighborhood {
    /// The nearest `max_neighbors`, however far.
    pub fn nearest(max_neighbors: usize) -> Self {
        Self { max_neighbors, radius: f32::INFINITY }
    }
}

impl From<usize> for Neighborhood {
    fn from(max_neighbors: usize) -> Self {
        Self::nearest(max_neighbors)
    }
}

/// Which of its two directions a normal takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Orientation {
    /// Towards the origin: the side of the surface that a camera there can see.
    TowardsCamera,
    /// Away from this point, such as the middle of a closed object.
    AwayFrom(Vec3),
}

/// Unit normals of `points` by principal component analysis of their neighbours (Hoppe et al. 1992, §3.2): the
/// eigenvector of the smallest eigenvalue of the covariance. The zero vector where there are fewer than three
/// neighbours or all lie on one line. `tree` is the tree over these very points; a plain number is that many
/// nearest neighbours.
pub fn estimate_normals(
    points: &[Vec3],
    tree: &KdTree,
    neighborhood: impl Into<Neighborhood>,
    orientation: Orientation,
) -> Vec<Vec3> {
    let neighborhood = neighborhood.into();
    let mut normals = vec![Vec3::ZERO; points.len()];
    tree.neighborhoods(points, neighborhood.max_neighbors, neighborhood.radius, |index, neighbors| {
        let Some((&point, slot)) = points.get(index as usize).zip(normals.get_mut(index as usize)) else { return };
        let normal = thinnest_direction(point, neighbors, points);
        let outward = match orientation {
            Orientation::TowardsCamera => -point,
            Orientation::AwayFrom(center) => point - center,
        };
        *slot = if normal.dot(outward) < 0.0 { -normal } else { normal };
    });
    normals
}

/// Normals that point away from where the points were seen from or, where that is not known, from their middle: the
/// median, which clutter moves least. Without a viewpoint that is the orientation that two clouds can agree on.
pub fn outward_normals(points: &[Vec3], eye: Option<Vec3>, neighbors: usize) -> Vec<Vec3> {
    let middle = |axis: usize| median(points.iter().map(|p| p[axis])).unwrap_or_default();
    let center = eye.unwrap_or_else(|| Vec3::new(middle(0), middle(1), middle(2)));
    estimate_normals(points, &KdTree::new(points), Neighborhood::nearest(neighbors), Orientation::AwayFrom(center))
}

/// Unit, or zero where the neighbours do not span a plane. Sums are taken about `point`, to keep digits.
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
