//! Convex parts of meshes.

use glam::{DVec3, Vec3};
use parry3d::math::Vector;
use parry3d::transformation::try_convex_hull;
use parry3d::transformation::vhacd::{VHACD, VHACDParameters};
use sim3align_geometry::cloud::Bounds;
use sim3align_geometry::decimate::decimate;
use sim3align_geometry::mesh::Mesh;

/// Cells along the longest side of a mesh while it is decomposed.
const RESOLUTION: u32 = 48;
/// Concavity below which a part is not split further.
const CONCAVITY: f32 = 0.01;
/// Triangles of the mesh that is decomposed; larger ones are decimated first.
const TRIANGLES: usize = 12_000;
/// A mesh whose parts fill this share of its hull is that hull.
const CONVEX: f64 = 0.97;
/// Parts with less than this share of the volume of all are left out.
const SLIVER: f64 = 1e-4;
/// Thickness of the hull of a flat mesh, relative to its diagonal.
const THICKNESS: f32 = 1e-3;

/// A closed convex surface; triangles are counter-clockwise from outside.
#[derive(Debug, Clone)]
pub struct ConvexPart {
    /// The vertices.
    pub positions: Vec<DVec3>,
    /// Three vertices each.
    pub triangles: Vec<[u32; 3]>,
}

impl ConvexPart {
    /// The hull of points; `None` if they are in a plane.
    pub fn hull(points: &[DVec3]) -> Option<Self> {
        let bounds = Bounds::of(&points.iter().map(|p| p.as_vec3()).collect::<Vec<_>>())?;
        let (center, size) = (bounds.center().as_dvec3(), f64::from(bounds.diagonal()));
        if !(size > 0.0) {
            return None;
        }
        let unit: Vec<Vector> = points.iter().map(|p| vector(((*p - center) / size).as_vec3())).collect();
        let (vertices, triangles) = try_convex_hull(&unit).ok()?;
        let positions = vertices.iter().map(|v| center + size * DVec3::new(v.x.into(), v.y.into(), v.z.into()));
        Some(Self { positions: positions.collect(), triangles }).filter(|hull| hull.volume() > 1e-9 * size.powi(3))
    }

    /// Its volume.
    pub fn volume(&self) -> f64 {
        let sum: f64 = self.corners().map(|[a, b, c]| a.dot(b.cross(c))).sum();
        sum / 6.0
    }

    /// The corners of its triangles.
    pub fn corners(&self) -> impl Iterator<Item = [DVec3; 3]> + '_ {
        self.triangles.iter().map(|t| t.map(|i| self.positions[i as usize]))
    }

    /// With all vertices moved.
    pub fn mapped(&self, map: impl Fn(DVec3) -> DVec3) -> Self {
        Self { positions: self.positions.iter().map(|p| map(*p)).collect(), triangles: self.triangles.clone() }
    }
}

/// At most `most` convex parts of a mesh, in its frame: one is its hull.
pub fn convex_parts(mesh: &Mesh, most: usize) -> Vec<ConvexPart> {
    let points: Vec<DVec3> = mesh.positions().iter().map(|p| p.as_dvec3()).collect();
    let Some(hull) = ConvexPart::hull(&points).or_else(|| thickened(mesh)) else { return Vec::new() };
    if most <= 1 {
        return vec![hull];
    }
    let mut parts = decomposed(&decimate(mesh, TRIANGLES), most);
    let volume: f64 = parts.iter().map(ConvexPart::volume).sum();
    if parts.is_empty() || volume > CONVEX * hull.volume() {
        return vec![hull];
    }
    parts.retain(|part| part.volume() > SLIVER * volume);
    parts
}

fn decomposed(mesh: &Mesh, most: usize) -> Vec<ConvexPart> {
    let Some(bounds) = Bounds::of(mesh.positions()) else { return Vec::new() };
    let (center, size) = (bounds.center(), bounds.diagonal());
    let points: Vec<Vector> = mesh.positions().iter().map(|p| vector((*p - center) / size)).collect();
    let parameters = VHACDParameters {
        resolution: RESOLUTION,
        concavity: CONCAVITY,
        max_convex_hulls: most as u32,
        ..VHACDParameters::default()
    };
    let found = VHACD::decompose(&parameters, &points, mesh.triangles(), true);
    let hulls = found.compute_exact_convex_hulls(&points, mesh.triangles());
    let of = |(vertices, _): &(Vec<Vector>, Vec<[u32; 3]>)| {
        let points: Vec<DVec3> =
            vertices.iter().map(|v| (center + size * Vec3::new(v.x, v.y, v.z)).as_dvec3()).collect();
        ConvexPart::hull(&points)
    };
    hulls.iter().filter_map(of).collect()
}

/// The hull of a flat mesh, which is made thicker.
fn thickened(mesh: &Mesh) -> Option<ConvexPart> {
    let by = f64::from(Bounds::of(mesh.positions())?.diagonal() * THICKNESS);
    let around =
        |p: &Vec3| [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| [p.as_dvec3() + by * axis, p.as_dvec3() - by * axis]);
    let points: Vec<DVec3> = mesh.positions().iter().flat_map(|p| around(p).into_iter().flatten()).collect();
    ConvexPart::hull(&points)
}

fn vector(p: Vec3) -> Vector {
    Vector::new(p.x, p.y, p.z)
}
