//! Meshes that enclose a volume: closed, and nowhere inside of themselves.

use glam::DVec3;
use sim3align_geometry::mesh::Mesh;
use sim3align_geometry::random::mixed;

/// Rays along each side of the grid that looks for a mesh inside of itself.
const RAYS: usize = 64;
/// Share of the length inside of a mesh that may be inside more than once: rays along edges are miscounted.
const TWICE: f64 = 0.02;
/// Volume of a solid, relative to the cube of its diagonal: below this, it is rounding.
const LEAST: f64 = 1e-9;

/// The triangles of a mesh that encloses a volume, facing outward, and this volume; `None` for others. By the divergence theorem,
/// integrals over the volume are sums over them.
#[derive(Debug, Clone)]
pub struct Solid {
    /// The corners of the triangles, counter-clockwise from outside.
    pub corners: Vec<[DVec3; 3]>,
    /// The volume.
    pub volume: f64,
}

impl Solid {
    /// The solid of a mesh. Several surfaces are one solid if they do not overlap; one inside another that faces inward is a cavity.
    pub fn of(mesh: &Mesh) -> Option<Self> {
        if !is_closed(mesh) {
            return None;
        }
        let mut corners: Vec<[DVec3; 3]> =
            mesh.triangles().iter().map(|t| mesh.corners(*t).map(|p| p.as_dvec3())).collect();
        let volume = mesh.signed_volume6() / 6.0;
        if volume.abs() <= LEAST * mesh.diagonal().powi(3) {
            return None;
        }
        if volume < 0.0 {
            corners.iter_mut().for_each(|t| t.swap(1, 2));
        }
        is_simple(&corners).then_some(Self { corners, volume: volume.abs() })
    }
}

/// Whether the surface of a mesh is closed. Its edges are those between positions: the seams of textures double vertices.
pub fn is_closed(mesh: &Mesh) -> bool {
    let bits = |vertex: u32| mesh.positions()[vertex as usize].to_array().map(|x| (x + 0.0).to_bits());
    let edge = |from: [u32; 3], to: [u32; 3]| {
        [from, to].as_flattened().iter().fold(0, |hash, word| mixed(hash ^ u64::from(*word)))
    };
    mesh.is_closed(bits, edge)
}

/// Whether parallel rays enter a surface once before they leave it. They run along the shortest side of its box.
fn is_simple(corners: &[[DVec3; 3]]) -> bool {
    let all = || corners.iter().flatten();
    let low = all().fold(DVec3::INFINITY, |a, b| a.min(*b));
    let high = all().fold(DVec3::NEG_INFINITY, |a, b| a.max(*b));
    let size = high - low;
    let along = size.min_position();
    let (across, down) = ((along + 1) % 3, (along + 2) % 3);
    // Off the lines that modelled meshes are made of, diagonals as well.
    let offset = |axis: usize| if axis == across { 0.437 } else { 0.271 };
    let ray = |k: usize, axis: usize| low[axis] + size[axis] * (k as f64 + offset(axis)) / RAYS as f64;
    let first = |x: f64, axis: usize| {
        let place = (x - low[axis]) / size[axis] * RAYS as f64 - offset(axis);
        place.ceil().max(0.0) as usize
    };

    // For each ray, where it meets the surface, and whether it enters there.
    let mut crossings: Vec<Vec<(f64, bool)>> = vec![Vec::new(); RAYS * RAYS];
    for [a, b, c] in corners {
        let normal = (*b - *a).cross(*c - *a);
        let (min, max) = (a.min(*b).min(*c), a.max(*b).max(*c));
        if normal[along] == 0.0 {
            continue;
        }
        for j in (first(min[down], down)..RAYS).take_while(|j| ray(*j, down) <= max[down]) {
            for i in (first(min[across], across)..RAYS).take_while(|i| ray(*i, across) <= max[across]) {
                let (x, y) = (ray(i, across), ray(j, down));
                let side = |p: &DVec3, q: &DVec3| {
                    (q[across] - p[across]) * (y - p[down]) - (q[down] - p[down]) * (x - p[across])
                };
                let sides = [side(a, b), side(b, c), side(c, a)];
                if sides.iter().any(|s| *s < 0.0) && sides.iter().any(|s| *s > 0.0) {
                    continue;
                }
                let rise = normal[across] * (x - a[across]) + normal[down] * (y - a[down]);
                crossings[j * RAYS + i].push((a[along] - rise / normal[along], normal[along] < 0.0));
            }
        }
    }

    let (mut inside, mut otherwise) = (0.0, 0.0);
    for ray in &mut crossings {
        ray.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut winding = 0;
        for pair in ray.windows(2) {
            winding += if pair[0].1 { 1 } else { -1 };
            let length = pair[1].0 - pair[0].0;
            match winding {
                0 => {}
                1 => inside += length,
                _ => otherwise += length,
            }
        }
    }
    otherwise <= TWICE * inside
}
