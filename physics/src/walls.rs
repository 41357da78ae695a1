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
    let mut triangles: Vec<([DVec3; 3], DVec3)> = Vec::new();
    for triangle in mesh.triangles() {
        let corners = mesh.corners(*triangle).map(|p| p.as_dvec3());
        triangles.push((corners, doubled_area(corners)));
    }
    // The largest ones decide the planes.
    triangles.sort_by(|a, b| b.1.length_squared().total_cmp(&a.1.length_squared()));

    let mut found: Vec<Wall> = Vec::new();
    for (corners, normal) in triangles {
        let unit = normal.normalize_or_zero();
        let holds = |wall: &Wall| {
            let far = corners.iter().map(|p| wall.normal.dot(*p - wall.points[0]).abs()).fold(0.0, f64::max);
            far < FLAT * size && (unit == DVec3::ZERO || wall.normal.dot(unit).abs() > FILLED)
        };
        let area = 0.5 * normal.length();
        if let Some(wall) = found.iter_mut().find(|wall| holds(wall)) {
            wall.points.extend(corners);
            wall.area += area;
        } else if found.len() < most {
            found.push(Wall { normal: unit, points: corners.to_vec(), area });
        } else {
            return None;
        }
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
