//! Convex parts of meshes.

use glam::{DVec3, Vec3};
use parry3d::math::Vector;
use parry3d::transformation::try_convex_hull;
use parry3d::transformation::vhacd::{VHACD, VHACDParameters};
use sim3align_geometry::cloud::Bounds;
use sim3align_geometry::decimate::decimate;
use sim3align_geometry::mesh::Mesh;

use super::walls::walls;

/// Cells along the longest side of a mesh while it is decomposed.
const RESOLUTION: u32 = 64;
/// Parts that a mesh is split into, before those that fill their common hull are joined.
const SPLIT: u32 = 64;
/// Concavity below which a part is not split further.
const CONCAVITY: f32 = 0.003;
/// Step between the planes that may split a part, in cells.
const PLANES: u32 = 2;
/// Volume that joining two parts may add, as a share of the volume of all.
const JOINED: f64 = 5e-4;
/// Triangles of the mesh that is decomposed; larger ones are decimated first.
const TRIANGLES: usize = 12_000;
/// A mesh whose parts fill this share of its hull is that hull.
const CONVEX: f64 = 0.97;
/// Distance up to which parts count as touching, relative to the cube root of the volume of all.
const TOUCHING: f64 = 0.02;
/// Parts with less than this share of the volume of all are left out.
const SLIVER: f64 = 1e-4;
/// Thickness of the hull of a flat mesh, relative to its diagonal.
const THICKNESS: f64 = 1e-3;

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
        if size.is_nan() || size <= 0.0 {
            return None;
        }
        // Hulls are the same in any proportions, and those of sheets are found in better ones.
        let sides = (bounds.max - bounds.min).as_dvec3().max(DVec3::splat(1e-6 * size));
        let unit: Vec<Vector> = points.iter().map(|p| vector(((*p - center) / sides).as_vec3())).collect();
        let (vertices, triangles) = try_convex_hull(&unit).ok()?;
        let positions = vertices.iter().map(|v| center + sides * DVec3::new(v.x.into(), v.y.into(), v.z.into()));
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

    /// Whether its box is at most this far from that of another part.
    fn is_near(&self, other: &Self, distance: f64) -> bool {
        let low = |part: &Self| part.positions.iter().fold(DVec3::INFINITY, |a, b| a.min(*b));
        let high = |part: &Self| part.positions.iter().fold(DVec3::NEG_INFINITY, |a, b| a.max(*b));
        let gap = (low(self) - high(other)).max(low(other) - high(self));
        gap.max_element() <= distance
    }

    /// The part at or above `height` along a direction; `None` if it has no volume.
    pub fn above(&self, up: DVec3, height: f64) -> Option<Self> {
        let over = |p: DVec3| up.dot(p) - height;
        let mut points: Vec<DVec3> = self.positions.iter().copied().filter(|p| over(*p) >= 0.0).collect();
        if points.len() == self.positions.len() {
            return Some(self.clone());
        }
        for [a, b, c] in self.corners() {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let (low, high) = (over(from), over(to));
                // Each edge belongs to two triangles, once in each direction.
                if low < 0.0 && high > 0.0 {
                    points.push(from.lerp(to, low / (low - high)));
                }
            }
        }
        Self::hull(&points)
    }

    /// With all vertices moved.
    pub fn mapped(&self, map: impl Fn(DVec3) -> DVec3) -> Self {
        Self { positions: self.positions.iter().map(|p| map(*p)).collect(), triangles: self.triangles.clone() }
    }
}

/// At most `most` convex parts of a mesh, in its frame: one is its hull. `volume` is that which the mesh encloses, if it does.
pub fn convex_parts(mesh: &Mesh, volume: Option<f64>, most: usize) -> Vec<ConvexPart> {
    let points: Vec<DVec3> = mesh.positions().iter().map(|p| p.as_dvec3()).collect();
    // All of a flat mesh is one plate.
    let Some(hull) = ConvexPart::hull(&points) else {
        return thickened(&points, mesh.diagonal()).into_iter().collect();
    };
    if most <= 1 || volume.is_some_and(|volume| volume > CONVEX * hull.volume()) {
        return vec![hull];
    }
    let mesh = decimate(mesh, TRIANGLES);
    if let Some(parts) = walls(&mesh, &hull, SPLIT as usize) {
        return joined(parts, most);
    }
    let mut parts = decomposed(&mesh);
    let volume: f64 = parts.iter().map(ConvexPart::volume).sum();
    if parts.is_empty() || volume > CONVEX * hull.volume() {
        return vec![hull];
    }
    parts.retain(|part| part.volume() > SLIVER * volume);
    joined(parts, most)
}

/// The number of walls without thickness that an open mesh consists of; 0 for others.
pub fn wall_count(mesh: &Mesh) -> usize {
    let points: Vec<DVec3> = mesh.positions().iter().map(|p| p.as_dvec3()).collect();
    let hull = ConvexPart::hull(&points);
    hull.and_then(|hull| walls(&decimate(mesh, TRIANGLES), &hull, SPLIT as usize)).map_or(0, |walls| walls.len())
}

/// Joins pairs of parts to their common hull: those that it adds little to, and the next best until there are few enough.
/// Parts that do not touch are joined only if nothing else makes them few enough.
fn joined(parts: Vec<ConvexPart>, most: usize) -> Vec<ConvexPart> {
    let parts = joined_pairs(parts, most, true);
    if parts.len() <= most { parts } else { joined_pairs(parts, most, false) }
}

fn joined_pairs(mut parts: Vec<ConvexPart>, most: usize, must_touch: bool) -> Vec<ConvexPart> {
    let all: f64 = parts.iter().map(ConvexPart::volume).sum();
    let margin = TOUCHING * libm::cbrt(all);
    let union = |a: &ConvexPart, b: &ConvexPart| {
        if must_touch && !a.is_near(b, margin) {
            return None;
        }
        let points: Vec<DVec3> = a.positions.iter().chain(&b.positions).copied().collect();
        let hull = ConvexPart::hull(&points)?;
        let cost = hull.volume() - a.volume() - b.volume();
        Some((cost, hull))
    };
    let costs_of = |parts: &[ConvexPart], k: usize| -> Vec<Option<(f64, ConvexPart)>> {
        parts[..k].iter().map(|other| union(other, &parts[k])).collect()
    };
    // The common hull of each part and of each before it.
    let mut pairs: Vec<Vec<_>> = (0..parts.len()).map(|k| costs_of(&parts, k)).collect();
    loop {
        let candidates = pairs
            .iter()
            .enumerate()
            .flat_map(|(k, row)| row.iter().enumerate().filter_map(move |(i, pair)| Some((pair.as_ref()?.0, i, k))));
        let Some((cost, i, k)) = candidates.min_by(|a, b| a.0.total_cmp(&b.0)) else { break };
        if parts.len() <= most && cost > JOINED * all {
            break;
        }
        let Some((_, hull)) = pairs[k][i].take() else { break };
        for gone in [k, i] {
            parts.remove(gone);
            pairs.remove(gone);
            pairs.iter_mut().skip(gone).for_each(|row| drop(row.remove(gone)));
        }
        parts.push(hull);
        pairs.push(costs_of(&parts, parts.len() - 1));
    }
    parts
}

fn decomposed(mesh: &Mesh) -> Vec<ConvexPart> {
    let Some(bounds) = Bounds::of(mesh.positions()) else { return Vec::new() };
    let (center, size) = (bounds.center(), bounds.diagonal());
    let points: Vec<Vector> = mesh.positions().iter().map(|p| vector((*p - center) / size)).collect();
    let parameters = VHACDParameters {
        resolution: RESOLUTION,
        concavity: CONCAVITY,
        plane_downsampling: PLANES,
        max_convex_hulls: SPLIT,
        ..VHACDParameters::default()
    };
    let found = VHACD::decompose(&parameters, &points, mesh.triangles(), true);
    let hulls = found.compute_exact_convex_hulls(&points, mesh.triangles());
    let of = |(vertices, _): &(Vec<Vector>, Vec<[u32; 3]>)| {
        let points: Vec<DVec3> =
            vertices.iter().map(|v| (center + size * Vec3::new(v.x, v.y, v.z)).as_dvec3()).collect();
        // Walls without thickness are thickened.
        ConvexPart::hull(&points).or_else(|| thickened(&points, f64::from(size)))
    };
    hulls.iter().filter_map(of).collect()
}

/// The hull of points in a plane, which is made thicker by a share of `size`.
pub fn thickened(points: &[DVec3], size: f64) -> Option<ConvexPart> {
    let by = size * THICKNESS;
    let around = |p: &DVec3| [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| [*p + by * axis, *p - by * axis]);
    let points: Vec<DVec3> = points.iter().flat_map(|p| around(p).into_iter().flatten()).collect();
    ConvexPart::hull(&points)
}

fn vector(p: Vec3) -> Vector {
    Vector::new(p.x, p.y, p.z)
}
