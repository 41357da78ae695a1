//! Walls without thickness: open boxes, shelves and vessels of flat faces.

use glam::DVec3;
use sim3align_geometry::mesh::Mesh;

use super::part::{ConvexPart, thickened};
use super::solid::is_closed;

/// Share of the hull of a wall that its triangles fill at least.
const FILLED: f64 = 0.9;
/// Share of the surface of the hull of a mesh from which on it is meant to be whole: gaps in it are cracks.
const WHOLE: f64 = 0.99;
/// Farthest that a vertex is from the plane of its wall, relative to the diagonal.
const FLAT: f64 = 5e-4;

/// The walls of an open mesh, one convex part each; `None` if it is closed, has more than `most`, or one that is not convex.
/// V-HACD weighs hulls by volume, and cannot tell which of its cuts free a wall that has none: it slices some boxes into
/// layers, which stay concave.
pub fn walls(mesh: &Mesh, hull: &ConvexPart, most: usize) -> Option<Vec<ConvexPart>> {
    if is_closed(mesh) {
        return None;
    }
    let size = mesh.diagonal();
    let corners = |triangle: &[u32; 3]| mesh.corners(*triangle).map(|p| p.as_dvec3());
    let mut left: Vec<[DVec3; 3]> = mesh.triangles().iter().map(corners).collect();
    let mut found: Vec<Wall> = Vec::new();
    let by_area = |a: &&[DVec3; 3], b: &&[DVec3; 3]| {
        doubled_area(**a).length_squared().total_cmp(&doubled_area(**b).length_squared())
    };
    // The largest ones decide the planes.
    while let Some(&largest) = left.iter().max_by(by_area) {
        if found.len() == most {
            return None;
        }
        let normal = doubled_area(largest).normalize_or_zero();
        let mut wall = Wall { normal, points: largest.to_vec(), area: 0.0 };
        left.retain(|corners| {
            let far = corners.iter().map(|p| normal.dot(*p - largest[0]).abs()).fold(0.0, f64::max);
            let across = doubled_area(*corners);
            let is_in = far < FLAT * size && normal.dot(across).abs() >= FILLED * across.length();
            if is_in {
                wall.points.extend(corners);
                wall.area += 0.5 * across.length();
            }
            !is_in
        });
        if wall.area == 0.0 {
            break;
        }
        found.push(wall);
    }

    let area: f64 = found.iter().map(|wall| wall.area).sum();
    let around: f64 = hull.corners().map(|corners| 0.5 * doubled_area(corners).length()).sum();
    if area > WHOLE * around && found.iter().all(|wall| wall.is_on(hull, FLAT * size)) {
        return None;
    }
    found.iter().map(|wall| wall.part(size)).collect()
}

fn doubled_area([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// Triangles in a plane.
struct Wall {
    normal: DVec3,
    points: Vec<DVec3>,
    area: f64,
}

impl Wall {
    /// Whether all of the hull is on one side of it.
    fn is_on(&self, hull: &ConvexPart, margin: f64) -> bool {
        let heights = || hull.positions.iter().map(|p| self.normal.dot(*p - self.points[0]));
        heights().all(|h| h < margin) || heights().all(|h| h > -margin)
    }

    /// Its part; `None` if it is not convex.
    fn part(&self, size: f64) -> Option<ConvexPart> {
        let part = thickened(&self.points, size)?;
        // The largest section of a plate is its area, its surface is twice that.
        let facing: f64 = part.corners().map(|corners| 0.5 * doubled_area(corners).dot(self.normal).abs()).sum();
        (self.area > FILLED * 0.5 * facing).then_some(part)
    }
}
