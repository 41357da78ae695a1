//! Nearest point on a triangle mesh: a bounding-volume hierarchy over its triangles.

use glam::{DVec3, Vec3};
use wide::f32x4;

use super::curve::along_curve;
use super::mesh::Mesh;
use super::order::{index_of, pack, select_smallest};
use super::triangle_block::{BLOCK, TriangleBlock, by_axis};
use sim3align_runtime::counts;

/// Children of a node, whose boxes are tested at once.
const CHILDREN: usize = 4;

/// Average number of triangles and boxes that [`TriangleTree::nearest_of_each`] visits per point at most. Surfaces of
/// objects take about sixty; triangles that all overlap take as many as there are.
const MAX_VISITS: usize = 2000;

/// Number of triangles from which on a tree along a curve, which is built in a fifth of the time, pays for slower searches.
const MANY: usize = 1 << 14;

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

/// A box whose corners are x, y, z and 0: in one piece, because it takes most of the time to build a tree to find them.
#[derive(Debug, Clone, Copy)]
struct Extent {
    min: f32x4,
    max: f32x4,
}

impl Extent {
    const NOTHING: Self = Self { min: f32x4::splat(f32::INFINITY), max: f32x4::splat(f32::NEG_INFINITY) };

    #[inline(always)]
    fn and(self, point: f32x4) -> Self {
        Self { min: self.min.fast_min(point), max: self.max.fast_max(point) }
    }

    #[inline(always)]
    fn union(self, other: Self) -> Self {
        Self { min: self.min.fast_min(other.min), max: self.max.fast_max(other.max) }
    }
}

impl Boxes {
    fn new(children: &[Extent]) -> Self {
        let child = |i: usize| children.get(i).copied().unwrap_or(Extent::NOTHING);
        let (a, b, c, d) = (child(0), child(1), child(2), child(3));
        Self { min: by_axis([a.min, b.min, c.min, d.min]), max: by_axis([a.max, b.max, c.max, d.max]) }
    }

    /// The squared distance of a point to each box, 0 inside.
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
        let corners = |triangle: [u32; 3]| {
            let [a, b, c] = mesh.corners(triangle);
            [f32x4::new([a.x, a.y, a.z, 0.0]), f32x4::new([b.x, b.y, b.z, 0.0]), f32x4::new([c.x, c.y, c.z, 0.0])]
        };
        counts::add(|| counts::Counts { sorted: mesh.triangles().len() as u64, ..Default::default() });
        let half = f32x4::splat(0.5);
        let mut centers = Vec::with_capacity(mesh.triangles().len());
        for &triangle in mesh.triangles() {
            let [a, b, c] = corners(triangle);
            let Extent { min, max } = Extent { min: a, max: a }.and(b).and(c);
            // Halves, so that the sum cannot overflow f32.
            centers.push(min * half + max * half);
        }
        let indices = match centers.len() {
            MANY.. => {
                let centers: Vec<Vec3> = centers.iter().map(|center| Vec3::from_slice(center.as_array())).collect();
                along_curve(&centers)
            }
            count => {
                let mut indices: Vec<u32> = (0..count as u32).collect();
                arrange(&centers, &mut indices, &mut Vec::with_capacity(count));
                indices
            }
        };
        let count = indices.len().div_ceil(BLOCK);
        let (mut blocks, mut extents) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for block in indices.chunks(BLOCK) {
            // The first one fills the places of those that are missing.
            let mut triangles = [corners(mesh.triangles()[block[0] as usize]); BLOCK];
            let mut extent = Extent::NOTHING;
            for (place, &i) in triangles.iter_mut().zip(block) {
                *place = corners(mesh.triangles()[i as usize]);
                extent = extent.and(place[0]).and(place[1]).and(place[2]);
            }
            extents.push(extent);
            blocks.push(TriangleBlock::new(&triangles));
        }
        let mut levels = Vec::new();
        while extents.len() > 1 {
            let count = extents.len().div_ceil(CHILDREN);
            let (mut boxes, mut parents) = (Vec::with_capacity(count), Vec::with_capacity(count));
            for children in extents.chunks(CHILDREN) {
                boxes.push(Boxes::new(children));
                parents.push(children.iter().fold(Extent::NOTHING, |all, child| all.union(*child)));
            }
            levels.push(boxes);
            extents = parents;
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
        // NaN would be in every box, even in those of children that do not exist.
        if !query.is_finite() {
            return None;
        }
        counts::add(|| counts::Counts { queries: 1, ..Default::default() });
        let best = SurfacePoint { triangle: u32::MAX, point: query, distance_squared: f32::MAX };
        let lanes = [f32x4::splat(query.x), f32x4::splat(query.y), f32x4::splat(query.z)];
        let mut search = Search { query, lanes, best, hint };
        self.offer(search.hint.slot, &mut search);
        self.descend(self.levels.len(), 0, &mut search);
        (search.best.triangle != u32::MAX).then_some(search.best)
    }

    /// Calls `visit` with the index of each of `count` points and the nearest point of the surface to it. Where searches
    /// are costly, because most triangles overlap, it leaves points out, evenly over the list. Returns the cost: the number
    /// of triangles and boxes visited. `query` gives a point and, where one is known, a triangle near to it.
    // One instance for all callers.
    #[inline(never)]
    pub fn nearest_of_each(
        &self,
        count: usize,
        query: &dyn Fn(usize) -> (Vec3, Option<u32>),
        visit: &mut dyn FnMut(usize, Option<SurfacePoint>),
    ) -> usize {
        let mut slots = Vec::new();
        // Consecutive points are usually close to each other, so that each search starts at the previous result.
        let mut hint = Hint::default();
        let (mut index, mut step) = (0, 1);
        while index < count {
            let (point, near) = query(index);
            if let Some(triangle) = near {
                if slots.is_empty() {
                    slots.resize(self.indices.len(), 0);
                    self.indices.iter().enumerate().for_each(|(slot, triangle)| slots[*triangle as usize] = slot);
                }
                hint.slot = slots.get(triangle as usize).copied().unwrap_or_default();
            }
            visit(index, self.nearest_from(point, &mut hint));
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
    split(centers, indices, full, keys);
    indices.chunks_mut(full).for_each(|child| arrange(centers, child, keys));
}

/// Sorts the indices into parts of this size.
fn split(centers: &[f32x4], indices: &mut [u32], part: usize, keys: &mut Vec<u64>) {
    let parts = indices.len().div_ceil(part);
    if parts < 2 {
        return;
    }
    let all = indices.iter().fold(Extent::NOTHING, |all, &i| all.and(centers[i as usize]));
    let spread = (all.max - all.min).to_array();
    let axis = (1..3).fold(0, |best, axis| if spread[axis] > spread[best] { axis } else { best });
    keys.clear();
    keys.extend(indices.iter().map(|&i| pack(centers[i as usize].as_array()[axis], i)));
    let middle = parts / 2 * part;
    select_smallest(keys, middle);
    for (index, &key) in indices.iter_mut().zip(keys.iter()) {
        *index = index_of(key);
    }
    let (left, right) = indices.split_at_mut(middle);
    split(centers, left, part, keys);
    split(centers, right, part, keys);
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
