//! Distances between observed points and the posed surface, in both directions.

use glam::Vec3;

use crate::geometry::cloud::Bounds;
use crate::geometry::mesh::Mesh;
use crate::geometry::similarity::{Similarity, vec3, vector3};
use crate::geometry::triangle_tree::TriangleTree;

use crate::evidence::Evidence;

/// Maximum distance of a fitting point to the surface, relative to the box diagonal of the points.
pub const FITNESS_TOLERANCE: f64 = 0.05;

/// Agreement of points and surface; values are `None` if there is nothing to measure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceAgreement {
    /// Mean distance of the observed points to the surface, in the unit of the observation.
    pub points_to_surface: Option<f64>,
    /// Mean distance of surface samples to the observed points, in the unit of the observation.
    pub surface_to_points: Option<f64>,
    /// Fraction of the observed points within [`FITNESS_TOLERANCE`] of the surface.
    pub fitness: Option<f64>,
    /// Mean |n·n′| of the normals of observed points and of their nearest triangles.
    pub normal_consistency: Option<f64>,
}

/// Compares the observed points with the surface of `mesh` posed by `camera_from_mesh`.
///
/// Distances from the points are exact point-to-triangle distances. Points and triangles without a normal are
/// excluded from the normal consistency.
pub fn surface_agreement(evidence: &Evidence, mesh: &Mesh, camera_from_mesh: &Similarity) -> SurfaceAgreement {
    let triangle_tree = TriangleTree::new(mesh);
    let (points, normals) = (&evidence.observed.points, &evidence.observed.normals);
    let tolerance = Bounds::of(points).map_or(0.0, |b| FITNESS_TOLERANCE * f64::from(b.diagonal()));

    let mesh_from_camera = camera_from_mesh.inverse();
    let (mut distance, mut fitting, mut consistency) = (Mean::default(), Mean::default(), Mean::default());
    // The query is in the mesh frame, where distances are 1/s of those in the camera frame.
    let query = |i: usize| vec3(&mesh_from_camera.apply(vector3(points[i])));
    triangle_tree.nearest_of_each(points.len().min(normals.len()), query, |i, nearest| {
        let Some(nearest) = nearest else { return };
        let d = f64::from(nearest.distance_squared).sqrt() * camera_from_mesh.scale;
        distance.add(d);
        fitting.add(if d <= tolerance { 1.0 } else { 0.0 });
        if normals[i] == Vec3::ZERO {
            return;
        }
        let facet = camera_from_mesh.rotation * vector3(facet_normal(mesh, nearest.triangle));
        if facet.norm_squared() > 0.0 {
            consistency.add(facet.dot(&vector3(normals[i])).abs().min(1.0));
        }
    });
    let mut back = Mean::default();
    let mut last = 0;
    for sample in &evidence.reconstructed.points {
        let query = vec3(&camera_from_mesh.apply(vector3(*sample)));
        let reach = points.get(last as usize).map_or(f32::INFINITY, |p| p.distance(query) * (1.0 + 1e-6));
        let nearest = evidence.tree.nearest_within(query, reach).or_else(|| evidence.tree.nearest(query));
        if let Some(nearest) = nearest {
            last = nearest.index;
            back.add(f64::from(nearest.distance_squared).sqrt());
        }
    }
    SurfaceAgreement {
        points_to_surface: distance.value(),
        surface_to_points: back.value(),
        fitness: fitting.value(),
        normal_consistency: consistency.value(),
    }
}

/// The unit normal of a triangle; zero without area.
fn facet_normal(mesh: &Mesh, triangle: u32) -> Vec3 {
    let Some(&corners) = mesh.triangles().get(triangle as usize) else { return Vec3::ZERO };
    let [a, b, c] = mesh.corners(corners).map(|p| p.as_dvec3());
    (b - a).cross(c - a).normalize_or_zero().as_vec3()
}

/// An arithmetic mean.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Mean {
    sum: f64,
    count: u64,
}

impl Mean {
    pub(super) fn add(&mut self, value: f64) {
        self.sum += value;
        self.count += 1;
    }

    /// The mean; `None` without values, or if the sum overflows.
    pub(super) fn value(&self) -> Option<f64> {
        let mean = self.sum / self.count as f64;
        mean.is_finite().then_some(mean)
    }
}
