//! Distances between observed points and the posed surface, in both directions.

use glam::{DVec3, Vec3};

use crate::geometry::cloud::Bounds;
use crate::geometry::image::Window;
use crate::geometry::mesh::Mesh;
use crate::geometry::pinhole::Pinhole;
use crate::geometry::rasteriser::NO_TRIANGLE;
use crate::geometry::similarity::{Similarity, vec3, vector3};
use crate::geometry::triangle_tree::TriangleTree;

use crate::evidence::Evidence;

/// Maximum distance of a fitting point to the surface, relative to the box diagonal of the points.
pub const FITNESS_TOLERANCE: f64 = 0.05;

/// Distance to the plane drawn at a point's pixel, relative to the mean, up to which it is about that to the surface.
const CLOSE: f64 = 2.0;

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

/// Compares the observed points with the surface of `mesh` posed by `camera_from_mesh`, of which `drawn` is the image.
///
/// Distances from the points are exact point-to-triangle distances of a sample. They are close to the distances to the planes
/// drawn at the same pixels, which cost next to nothing and are known of all points: where these are small, only the mean
/// difference is taken from the sample, and most others are measured (Cochran, "Sampling Techniques", §5.2 and §7.1). Points
/// and triangles without a normal are excluded from the normal consistency.
pub fn surface_agreement(
    evidence: &Evidence,
    mesh: &Mesh,
    camera_from_mesh: &Similarity,
    drawn: &Drawn<'_>,
) -> SurfaceAgreement {
    let triangle_tree = TriangleTree::new(mesh);
    let Evidence { observed, tree, reconstructed, measured: [measured, from_surface], .. } = evidence;
    let (points, normals) = (&observed.points, &observed.normals);
    let tolerance = Bounds::of(points).map_or(0.0, |b| FITNESS_TOLERANCE * f64::from(b.diagonal()));
    let mut estimates: Vec<f64> = points.iter().map(|p| drawn.distance(*p).unwrap_or(f64::INFINITY)).collect();
    let mean = Mean::of(estimates.iter().map(|d| d.min(tolerance))).value().unwrap_or(0.0);
    let most = if measured.len() < points.len() { CLOSE * mean } else { -1.0 };
    estimates.iter_mut().filter(|d| **d > most).for_each(|d| *d = f64::INFINITY);
    let is_close = |index: u32| estimates[index as usize].is_finite();
    let others: Vec<u32> = tree.indices().filter(|index| !is_close(*index)).collect();
    let [close, far] = [points.len() - others.len(), others.len()];
    let thinned = others.iter().step_by(far.div_ceil(measured.len().max(1)).max(1));
    let queries: Vec<u32> = measured.iter().filter(|index| is_close(**index)).chain(thinned).copied().collect();

    let mesh_from_camera = camera_from_mesh.inverse();
    // Of the close and of the other points.
    let [mut distances, mut fitting, mut consistency] = [[Mean::default(); 2]; 3];
    // The query is in the mesh frame, where distances are 1/s of those in the camera frame.
    let query = |i: usize| {
        let (index, point) = (queries[i], points[queries[i] as usize]);
        (vec3(&mesh_from_camera.apply(vector3(point))), drawn.triangle(point).filter(|_| is_close(index)))
    };
    triangle_tree.nearest_of_each(queries.len(), &query, &mut |i, nearest| {
        let Some(nearest) = nearest else { return };
        let index = queries[i] as usize;
        let d = f64::from(nearest.distance_squared).sqrt() * camera_from_mesh.scale;
        let is_far = usize::from(!is_close(queries[i]));
        distances[is_far].add(if is_far == 1 { d } else { d - estimates[index] });
        fitting[is_far].add(if d <= tolerance { 1.0 } else { 0.0 });
        let normal = normals.get(index).copied().unwrap_or_default();
        let facet = camera_from_mesh.rotation * vector3(facet_normal(mesh, nearest.triangle));
        if normal != Vec3::ZERO && facet.norm_squared() > 0.0 {
            consistency[is_far].add(facet.dot(&vector3(normal)).abs().min(1.0));
        }
    });
    let estimated = Mean::of(estimates.iter().copied().filter(|d| d.is_finite())).value().unwrap_or(0.0);
    let of_both = |means: [Mean; 2], estimated: f64| {
        let parts = [(close, means[0].value().map(|mean| mean + estimated)), (far, means[1].value())];
        let known = || parts.iter().filter_map(|(count, mean)| Some((*count as f64, (*mean)?)));
        let weight: f64 = known().map(|(count, _)| count).sum();
        (weight > 0.0).then(|| known().map(|(count, mean)| count * mean).sum::<f64>() / weight)
    };
    let mut back = Mean::default();
    let mut last = 0;
    for sample in from_surface.iter().filter_map(|index| reconstructed.points.get(*index as usize)) {
        let query = vec3(&camera_from_mesh.apply(vector3(*sample)));
        let reach = points.get(last as usize).map_or(f32::INFINITY, |p| p.distance(query) * (1.0 + 1e-6));
        let nearest = tree.nearest_within(query, reach).or_else(|| tree.nearest(query));
        if let Some(nearest) = nearest {
            last = nearest.index;
            back.add(f64::from(nearest.distance_squared).sqrt());
        }
    }
    SurfaceAgreement {
        points_to_surface: of_both(distances, estimated),
        surface_to_points: back.value(),
        fitness: of_both(fitting, 0.0),
        normal_consistency: of_both(consistency, 0.0),
    }
}

/// A rendered depth image, in a window of that of a camera.
pub struct Drawn<'a> {
    /// Depth in metres; 0 where nothing is drawn.
    pub depth: &'a [f32],
    /// Index of the triangle drawn at each pixel.
    pub triangles: &'a [u32],
    /// The window.
    pub window: Window,
    /// The intrinsics of the whole image.
    pub camera: Pinhole,
}

impl Drawn<'_> {
    /// The pixel of a point, in the window.
    fn pixel(&self, point: Vec3) -> [usize; 2] {
        let [u, v] = self.camera.project(point);
        let Window { first, .. } = self.window;
        [((u + 0.5) as usize).saturating_sub(first[0]), ((v + 0.5) as usize).saturating_sub(first[1])]
    }

    /// The triangle drawn at the pixel of a point.
    fn triangle(&self, point: Vec3) -> Option<u32> {
        let [u, v] = self.pixel(point);
        self.triangles.get(v * self.window.size[0] + u).copied().filter(|triangle| *triangle != NO_TRIANGLE)
    }

    /// The distance of a point to the plane of the surface at its pixel; `None` where nothing is drawn.
    fn distance(&self, point: Vec3) -> Option<f64> {
        let Self { depth, window: Window { size, .. }, camera, .. } = self;
        let [u, v] = self.pixel(point);
        let at = |u: usize, v: usize| {
            let z = if u < size[0] { depth.get(v * size[0] + u).copied().unwrap_or(0.0) } else { 0.0 };
            (z > 0.0).then_some(f64::from(z))
        };
        let z = at(u, v)?;
        // The slopes of the depth along the image, where a neighbour is drawn.
        let slope = |next: Option<f64>, focal: f64| next.map_or(0.0, |next| (next - z) * focal);
        let [du, dv] = [slope(at(u + 1, v), camera.fx), slope(at(u, v + 1), camera.fy)];
        let point = point.as_dvec3();
        let ray = point / point.z;
        let normal = DVec3::new(du, dv, -(z + ray.x * du + ray.y * dv));
        Some((point.z - z).abs() * z / normal.length_squared().sqrt())
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
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let mut mean = Self::default();
        values.for_each(|value| mean.add(value));
        mean
    }

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
