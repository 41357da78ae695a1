//! Nearest point on a triangle mesh: a bounding-volume hierarchy over its triangles.

use glam::{DVec3, Vec3};
use wide::f32x4;

use super::cloud::Bounds;
use super::mesh::Mesh;
use super::order::{index_of, pack, select_smallest};
use super::triangle_block::{BLOCK, TriangleBlock};

/// Children of a node, whose boxes are tested at once.
const CHILDREN: usize = 4;

/// Average number of triangles and boxes that [`TriangleTree::nearest_of_each`] visits per point at most. Surfaces of
/// objects take about sixty; triangles that all overlap take as many as there are.
const MAX_VISITS: usize = 2000;

/// Fewest points that it visits, whatever they cost.
const MIN_POINTS: usize = 64;

/// The result of a nearest-point query.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// Index of the triangle that contains the point.
    pub triangle: u32,
    /// The point on the surface.
    pub point: Vec3,
    /// Squared distance to the query.
    pub distance_squared: f32,
}

/// A tree of bounding boxes over the triangles of a mesh, with four children a node. Degenerate triangles (needles, points)
/// are included.
///
/// Distances to triangles are computed in f64. Ties (in f32) go to the smaller index, so that results do not depend on
/// the structure of the tree.
#[derive(Debug, Clone)]
pub struct TriangleTree {
    /// The triangles in leaf order.
    blocks: Vec<TriangleBlock>,
    /// Their indices in the mesh.
    indices: Vec<u32>,
    /// From the leaves to the root: the children of node `i` are the nodes of the level below, or the blocks, from
    /// [`CHILDREN`] · `i` on.
    levels: Vec<Vec<Boxes>>,
}

/// The boxes of the children of a node, by axis. Those of children that do not exist are infinitely far from any point.
#[derive(Debug, Clone, Copy)]
struct Boxes {
    min: [f32x4; 3],
    max: [f32x4; 3],
}

impl Boxes {
    fn new(children: &[Bounds]) -> Self {
        let child = |i: usize| children.get(i).copied().unwrap_or(Bounds::NOTHING);
        let four: [Bounds; CHILDREN] = core::array::from_fn(child);
        let [a, b, c, d] = four;
        let min = |axis: usize| f32x4::new([a.min[axis], b.min[axis], c.min[axis], d.min[axis]]);
        let max = |axis: usize| f32x4::new([a.max[axis], b.max[axis], c.max[axis], d.max[axis]]);
        Self { min: [min(0), min(1), min(2)], max: [max(0), max(1), max(2)] }
    }

    /// As [`Bounds::distance_squared`].
    #[inline(always)]
    fn distances_squared(&self, point: &[f32x4; 3]) -> f32x4 {
        let gap = |axis: usize| {
            let (below, above) = (self.min[axis] - point[axis], point[axis] - self.max[axis]);
            below.fast_max(above).fast_max(f32x4::ZERO)
        };
        let (x, y, z) = (gap(0), gap(1), gap(2));
        x * x + y * y + z * z
    }
}

/// A search: the query, the best triangle so far, and the hint.
struct Search<'a> {
    query: Vec3,
    /// Its coordinates, each in all lanes.
    lanes: [f32x4; 3],
    best: SurfacePoint,
    hint: &'a mut Hint,
}

impl TriangleTree {
    /// The tree over a mesh's triangles.
    pub fn new(mesh: &Mesh) -> Self {
        let boxes = mesh.triangles().iter().map(|&t| Bounds::of_triangle(&mesh.corners(t)));
        // Halves, so that the sum cannot overflow f32.
        let center = |b: Bounds| b.min * 0.5 + b.max * 0.5;
        let centers: Vec<f32x4> = boxes.map(|b| f32x4::new(center(b).extend(0.0).to_array())).collect();
        let mut indices: Vec<u32> = (0..centers.len() as u32).collect();
        arrange(&centers, &mut indices, &mut Vec::with_capacity(centers.len()));
        let corners = |i: &u32| mesh.corners(mesh.triangles()[*i as usize]);
        let (mut blocks, mut bounds) = (Vec::new(), Vec::new());
        for block in indices.chunks(BLOCK) {
            let triangles: [[Vec3; 3]; BLOCK] = core::array::from_fn(|i| corners(block.get(i).unwrap_or(&block[0])));
            bounds.push(triangles.iter().map(Bounds::of_triangle).fold(Bounds::NOTHING, Bounds::union));
            blocks.push(TriangleBlock::new(&triangles));
        }
        let mut levels = Vec::new();
        while bounds.len() > 1 {
            levels.push(bounds.chunks(CHILDREN).map(Boxes::new).collect());
            let parents = bounds.chunks(CHILDREN);
            bounds = parents.map(|part| part.iter().copied().fold(Bounds::NOTHING, Bounds::union)).collect();
        }
        Self { blocks, indices, levels }
    }

    /// The point of the surface nearest to `query`. `None` only if the query is not finite, or if its squared
    /// distance overflows f32.
    pub fn nearest(&self, query: Vec3) -> Option<SurfacePoint> {
        self.nearest_from(query, &mut Hint::default())
    }

    /// Like [`TriangleTree::nearest`], but faster for a sequence of nearby queries, which share a `hint`.
    pub fn nearest_from(&self, query: Vec3, hint: &mut Hint) -> Option<SurfacePoint> {
        let best = SurfacePoint { triangle: u32::MAX, point: query, distance_squared: f32::MAX };
        let mut search = Search { query, lanes: query.to_array().map(f32x4::splat), best, hint };
        self.offer(search.hint.slot, &mut search);
        self.descend(self.levels.len(), 0, &mut search);
        (search.best.triangle != u32::MAX).then_some(search.best)
    }

    /// Calls `visit` with the index of each of `count` points and the nearest point of the surface to it. Where searches
    /// are costly, because most triangles overlap, it leaves points out, evenly over the list. Returns the cost: the number
    /// of triangles and boxes visited.
    pub fn nearest_of_each(
        &self,
        count: usize,
        point: impl Fn(usize) -> Vec3,
        mut visit: impl FnMut(usize, Option<SurfacePoint>),
    ) -> usize {
        // Consecutive points are usually close to each other, so that each search starts at the previous result.
        let mut hint = Hint::default();
        let (mut index, mut step) = (0, 1);
        while index < count {
            visit(index, self.nearest_from(point(index), &mut hint));
            if hint.visits > MAX_VISITS * (index + count / 16) && MIN_POINTS * step < count {
                step *= 2;
            }
            index += step;
        }
        hint.visits
    }

    /// Replaces the best triangle if this one is nearer.
    fn offer(&self, slot: usize, search: &mut Search) {
        let Some((block, &triangle)) = self.blocks.get(slot / BLOCK).zip(self.indices.get(slot)) else { return };
        let query = search.query.as_dvec3();
        let offset = nearest_offset(block.triangle(slot % BLOCK).map(|p| p.as_dvec3() - query));
        let distance_squared = offset.length_squared() as f32;
        if (distance_squared, triangle) < (search.best.distance_squared, search.best.triangle) {
            search.best = SurfacePoint { triangle, point: (query + offset).as_vec3(), distance_squared };
            search.hint.slot = slot;
        }
    }

    /// Visits a node, or a block at level 0: nearest children first.
    fn descend(&self, level: usize, node: usize, search: &mut Search) {
        search.hint.visits += CHILDREN;
        let below = level.checked_sub(1);
        let distances = match below {
            Some(below) => self.levels[below][node].distances_squared(&search.lanes) * f32x4::splat(1.0 - 1e-6),
            None => self.blocks[node].least_distances(&search.lanes),
        };
        // A distance that is NaN may be smaller.
        let is_far = distances.simd_gt(f32x4::splat(search.best.distance_squared));
        let mut left = !is_far.to_bitmask() & 0xf;
        if left == 0 {
            return;
        }
        let distances = distances.to_array();
        while left != 0 {
            let mut nearest = left.trailing_zeros() as usize;
            let others = left & (left - 1);
            if others != 0 {
                for lane in nearest + 1..CHILDREN {
                    if others >> lane & 1 == 1 && distances[lane] < distances[nearest] {
                        nearest = lane;
                    }
                }
            }
            left &= !(1 << nearest);
            if distances[nearest] > search.best.distance_squared {
                continue;
            }
            match below {
                Some(below) => self.descend(below, CHILDREN * node + nearest, search),
                None => self.offer(BLOCK * node + nearest, search),
            }
        }
    }
}

/// The leaf of the previous result, which the next search visits first.
#[derive(Debug, Clone, Copy, Default)]
pub struct Hint {
    slot: usize,
    /// Triangles and boxes visited by all searches so far.
    visits: usize,
}

/// Sorts the indices so that each node has its children's in turn, every child but the last ones full, and in as small a
/// box as halving at medians gives.
fn arrange(centers: &[f32x4], indices: &mut [u32], keys: &mut Vec<u64>) {
    if indices.len() <= BLOCK {
        return;
    }
    let mut full = BLOCK;
    while full * CHILDREN < indices.len() {
        full *= CHILDREN;
    }
    halve(centers, indices, full, keys);
    indices.chunks_mut(full).for_each(|child| arrange(centers, child, keys));
}

/// Sorts the indices into parts of this size.
fn halve(centers: &[f32x4], indices: &mut [u32], part: usize, keys: &mut Vec<u64>) {
    let parts = indices.len().div_ceil(part);
    if parts < 2 {
        return;
    }
    let (mut low, mut high) = (f32x4::splat(f32::INFINITY), f32x4::splat(f32::NEG_INFINITY));
    for &i in indices.iter() {
        let center = centers[i as usize];
        (low, high) = (low.fast_min(center), high.fast_max(center));
    }
    let spread = (high - low).to_array();
    let axis = (1..3).fold(0, |best, axis| if spread[axis] > spread[best] { axis } else { best });
    keys.clear();
    keys.extend(indices.iter().map(|&i| pack(centers[i as usize].to_array()[axis], i)));
    let middle = parts / 2 * part;
    select_smallest(keys, middle);
    for (index, &key) in indices.iter_mut().zip(keys.iter()) {
        *index = index_of(key);
    }
    let (left, right) = indices.split_at_mut(middle);
    halve(centers, left, part, keys);
    halve(centers, right, part, keys);
}

/// The point of a triangle nearest to the origin.
fn nearest_offset([a, b, c]: [DVec3; 3]) -> DVec3 {
    let (ab, ac) = (b - a, c - a);
    let normal = ab.cross(ac);
    let area_squared = normal.length_squared();
    let longest_squared = ab.length_squared().max(ac.length_squared()).max((c - b).length_squared());
    // The projection of the origin, by the signed areas that it spans with the edges.
    let weights = [normal.dot(b.cross(c)), normal.dot(c.cross(a)), normal.dot(a.cross(b))];
    let inside = area_squared > 0.0 && weights.iter().all(|w| *w >= 0.0);
    let sum: f64 = weights.iter().sum();
    let mut best = None;
    if inside && sum > 0.0 {
        let point = (a * weights[0] + b * weights[1] + c * weights[2]) / sum;
        // The normal of a needle is dominated by rounding. The point is then on the triangle, but may not be nearest.
        if area_squared > 1e-16 * longest_squared * longest_squared {
            return point;
        }
        best = Some(point);
    }
    let edges = [(a, b), (b, c), (c, a)].map(|(p, q)| nearest_on_segment(p, q));
    (edges.into_iter().chain(best)).fold(a, |best, p| if p.length_squared() < best.length_squared() { p } else { best })
}

/// The point of a segment nearest to the origin.
fn nearest_on_segment(p: DVec3, q: DVec3) -> DVec3 {
    let along = q - p;
    let length_squared = along.length_squared();
    let t = -p.dot(along);
    if t <= 0.0 || length_squared == 0.0 {
        p
    } else if t >= length_squared {
        q
    } else {
        p + along * (t / length_squared)
    }
}
