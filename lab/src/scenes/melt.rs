//! A mesh sampled to a coarse, blurred volume and back: details melt, thin parts thicken, parts become one.

use crate::cases::distortion::box_of;
use crate::prelude::*;

/// Empty cells around the object.
const PAD: usize = 4;
/// Runs through the object that are shorter than this many cells are lengthened to it: the blur would erase them.
const THINNEST_CELLS: f64 = 2.9;
/// Of a volume of 0 and 1, blurred, where the surface is.
const LEVEL: f32 = 0.5;
/// Rays along each axis: two by two a cell, off its middle by these shares of it, so that none meets an edge of a mesh
/// that is as regular as the grid.
const RAYS: [f64; 2] = [0.2437, 0.7411];

/// A grid of cells, and how much of each is filled.
struct Volume {
    origin: DVec3,
    cell: f64,
    size: [usize; 3],
    filled: Vec<f32>,
}

/// The mesh of a volume whose cells' edges are `share` of the object's longest side; blurred by as much (σ). The mesh's
/// parts are closed and face outward.
///
/// # Errors
/// None that a mesh with a volume could cause.
pub fn melted(mesh: &Mesh, share: f64) -> Result<Mesh> {
    let (low, high) = box_of(mesh.positions().iter().map(|p| p.as_dvec3()));
    let cell = share * (high - low).max_element();
    let size = ((high - low) / cell).to_array().map(|n| n as usize + 1 + 2 * PAD);
    let origin = low - DVec3::splat(PAD as f64 * cell);
    let mut volume = Volume { origin, cell, size, filled: vec![0.0; size.iter().product()] };
    for axis in 0..3 {
        volume.fill(mesh, axis);
    }
    for _ in 0..2 {
        (0..3).for_each(|axis| volume.blur(axis));
    }
    volume.surface()
}

impl Volume {
    fn strides(&self) -> [usize; 3] {
        [1, self.size[0], self.size[0] * self.size[1]]
    }

    /// Fills what is inside along the rays of one axis; a cell keeps the largest share that any axis finds.
    fn fill(&mut self, mesh: &Mesh, axis: usize) {
        let strides = self.strides();
        let across = [(axis + 1) % 3, (axis + 2) % 3];
        let mut filled = vec![0.0f32; self.filled.len()];
        for (ray, mut crossings) in self.crossings(mesh, axis).into_iter().enumerate() {
            crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
            let rays = 2 * self.size[across[0]];
            let first = ray % rays / 2 * strides[across[0]] + ray / rays / 2 * strides[across[1]];
            let (mut depth, mut begin) = (0, 0.0);
            for (at, way) in crossings {
                if depth == 0 {
                    begin = at;
                }
                depth += way;
                if depth == 0 {
                    let lacking = 0.5 * (THINNEST_CELLS - (at - begin)).max(0.0);
                    let (from, to) = (begin - lacking, at + lacking);
                    for k in from as usize..=(to as usize).min(self.size[axis] - 1) {
                        let within = to.min(k as f64 + 1.0) - from.max(k as f64);
                        filled[first + k * strides[axis]] += 0.25 * within as f32;
                    }
                }
            }
        }
        self.filled.iter_mut().zip(filled).for_each(|(all, one)| *all = all.max(one.min(1.0)));
    }

    /// Where the surface crosses the rays along an axis, in cells, and whether the ray enters (1) or leaves (−1).
    fn crossings(&self, mesh: &Mesh, axis: usize) -> Vec<Vec<(f64, i32)>> {
        let across = [(axis + 1) % 3, (axis + 2) % 3];
        let rays = across.map(|a| 2 * self.size[a]);
        let mut crossings = vec![Vec::new(); rays[0] * rays[1]];
        let at = |ray: usize| (ray / 2) as f64 + RAYS[ray % 2];
        for triangle in mesh.triangles() {
            let corners = triangle.map(|i| {
                let p = ((mesh.positions()[i as usize].as_dvec3() - self.origin) / self.cell).to_array();
                [p[across[0]], p[across[1]], p[axis]]
            });
            let range = |a: usize| {
                let low = corners.iter().fold(f64::INFINITY, |low, c| low.min(c[a]));
                let high = corners.iter().fold(f64::NEG_INFINITY, |high, c| high.max(c[a]));
                (2.0 * low).max(0.0) as usize..((2.0 * high) as usize + 2).min(rays[a])
            };
            for v in range(1) {
                for u in range(0) {
                    // Twice the areas that the ray makes with the edges: of one sign where it is inside. Each edge is
                    // walked from its smaller index, so that its other triangle finds the same number.
                    let areas = [0, 1, 2].map(|k| {
                        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                        let swapped = triangle[i] > triangle[j];
                        let (a, b) = if swapped { (corners[j], corners[i]) } else { (corners[i], corners[j]) };
                        let area = (a[0] - at(u)) * (b[1] - at(v)) - (a[1] - at(v)) * (b[0] - at(u));
                        if swapped { -area } else { area }
                    });
                    let way = if areas.iter().all(|area| *area > 0.0) {
                        -1
                    } else if areas.iter().all(|area| *area < 0.0) {
                        1
                    } else {
                        continue;
                    };
                    let sum: f64 = areas.iter().sum();
                    let height = areas.iter().zip(&corners).map(|(area, corner)| area * corner[2]).sum::<f64>() / sum;
                    crossings[v * rays[0] + u].push((height, way));
                }
            }
        }
        crossings
    }

    /// (1, 2, 1) / 4 along an axis; twice is a σ of one cell.
    fn blur(&mut self, axis: usize) {
        let stride = self.strides()[axis];
        let from = self.filled.clone();
        let at = |i: Option<usize>| i.and_then(|i| from.get(i)).copied().unwrap_or_default();
        // The rim is empty: what is taken from the next row there is 0.
        for (i, value) in self.filled.iter_mut().enumerate() {
            *value = 0.25 * (at(i.checked_sub(stride)) + at(Some(i + stride))) + 0.5 * from[i];
        }
    }

    /// Surface nets: one vertex, the mean of the crossings along the edges, per cube of eight cells' middles that the
    /// surface passes; one quadrilateral per crossing.
    fn surface(&self) -> Result<Mesh> {
        let strides = self.strides();
        let inside = |i: usize| self.filled[i] > LEVEL;
        let mut vertex_of = vec![u32::MAX; self.filled.len()];
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        let cubes = || {
            let [nx, ny, nz] = self.size.map(|n| n - 1);
            (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])))
        };
        let index = |[x, y, z]: [usize; 3]| x + y * strides[1] + z * strides[2];
        for at in cubes() {
            let (mut sum, mut count) = (DVec3::ZERO, 0.0);
            for axis in 0..3 {
                let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
                for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    let mut corner = at;
                    (corner[b], corner[c]) = (at[b] + i, at[c] + j);
                    let from = index(corner);
                    let [low, high] = [from, from + strides[axis]].map(|k| self.filled[k]);
                    if (low > LEVEL) != (high > LEVEL) {
                        let mut point = corner.map(|x| x as f64 + 0.5);
                        point[axis] += f64::from((LEVEL - low) / (high - low));
                        (sum, count) = (sum + DVec3::from_array(point), count + 1.0);
                    }
                }
            }
            if count > 0.0 {
                vertex_of[index(at)] = positions.len() as u32;
                positions.push((self.origin + sum / count * self.cell).as_vec3());
            }
        }
        for at in cubes() {
            let from = index(at);
            for axis in 0..3 {
                let (b, c) = (strides[(axis + 1) % 3], strides[(axis + 2) % 3]);
                if inside(from) == inside(from + strides[axis]) {
                    continue;
                }
                // The cubes around the edge, by the right hand about the axis.
                let [p, q, r, s] = [from - b - c, from - c, from, from - b].map(|cube| vertex_of[cube]);
                let quadrilateral = if inside(from) { [[p, q, r], [p, r, s]] } else { [[p, r, q], [p, s, r]] };
                triangles.extend(quadrilateral);
            }
        }
        Mesh::new(positions, triangles)
    }
}
