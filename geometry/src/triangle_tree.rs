//! Nearest point on a triangle mesh: a bounding-volume hierarchy over its triangles.

use glam::{DVec3, Vec3};

use super::cloud::Bounds;
use super::mesh::Mesh;
use super::order::halve;

const LEAF_SIZE: usize = 4;

/// Average number of triangles and nodes that [`TriangleTree::nearest_of_each`] visits per point at most. Surfaces of
/// objects take about forty; triangles that all overlap take as many as there are.
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

/// A median-split tree of bounding boxes over the triangles of a mesh. Degenerate triangles (needles, points) are
/// included.
///
/// Distances to triangles are computed in f64. Ties (in f32) go to the smaller index, so that results do not depend on
/// the structure of the tree.
#[derive(Debug, Clone)]
pub struct TriangleTree {
    /// Corners in leaf order, with the triangles' own indices.
    triangles: Vec<([Vec3; 3], u32)>,
    /// Depth-first: an inner node is followed by its left child.
    nodes: Vec<Node>,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    bounds: Bounds,
    /// The right child; 0 in a leaf.
    right: u32,
}

impl TriangleTree {
    /// The tree over a mesh's triangles.
    pub fn new(mesh: &Mesh) -> Self {
        let triangles: Vec<[Vec3; 3]> = mesh.triangles().iter().map(|&t| mesh.corners(t)).collect();
        // A third of each corner, so that the sum cannot overflow f32.
        let centers: Vec<Vec3> = triangles.iter().map(|[a, b, c]| a / 3.0 + b / 3.0 + c / 3.0).collect();
        let mut order: Vec<u32> = (0..triangles.len() as u32).collect();
        let mut nodes = Vec::with_capacity(triangles.len());
        build(&triangles, &centers, &mut order, &mut nodes);
        Self { triangles: order.into_iter().map(|i| (triangles[i as usize], i)).collect(), nodes }
    }

    /// The point of the surface nearest to `query`. `None` only if the query is not finite, or if its squared
    /// distance overflows f32.
    pub fn nearest(&self, query: Vec3) -> Option<SurfacePoint> {
        self.nearest_from(query, &mut Hint::default())
    }

    /// Like [`TriangleTree::nearest`], but faster for a sequence of nearby queries, which share a `hint`.
    pub fn nearest_from(&self, query: Vec3, hint: &mut Hint) -> Option<SurfacePoint> {
        let none = SurfacePoint { triangle: u32::MAX, point: query, distance_squared: f32::MAX };
        let mut best = (none, *hint);
        self.offer(hint.slot, query, &mut best);
        self.descend(0, 0, self.triangles.len(), query, &mut best);
        *hint = best.1;
        (best.0.triangle != u32::MAX).then_some(best.0)
    }

    /// Calls `visit` with the index of each of `count` points and the nearest point of the surface to it. Where searches
    /// are costly, because most triangles overlap, it leaves points out, evenly over the list. Returns the cost: the number
    /// of triangles and nodes visited.
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
    fn offer(&self, slot: usize, query: Vec3, (best, hint): &mut (SurfacePoint, Hint)) {
        let Some((corners, triangle)) = self.triangles.get(slot) else { return };
        let offset = nearest_offset(corners.map(|p| p.as_dvec3() - query.as_dvec3()));
        let distance_squared = offset.length_squared() as f32;
        if (distance_squared, *triangle) < (best.distance_squared, best.triangle) {
            let point = (query.as_dvec3() + offset).as_vec3();
            *best = SurfacePoint { triangle: *triangle, point, distance_squared };
            hint.slot = slot;
        }
    }

    fn descend(&self, node: usize, low: usize, high: usize, query: Vec3, best: &mut (SurfacePoint, Hint)) {
        let right = self.nodes[node].right as usize;
        best.1.visits += 1;
        if right == 0 {
            best.1.visits += high - low;
            for slot in low..high {
                let bounds = Bounds::of_triangle(&self.triangles[slot].0);
                if may_hold(bounds.distance_squared(query), &best.0) {
                    self.offer(slot, query, best);
                }
            }
            return;
        }
        let middle = low + (high - low) / 2;
        let mut children = [(node + 1, low, middle), (right, middle, high)]
            .map(|child| (self.nodes[child.0].bounds.distance_squared(query), child));
        if children[1].0 < children[0].0 {
            children.swap(0, 1);
        }
        for (distance_squared, (node, low, high)) in children {
            if may_hold(distance_squared, &best.0) {
                self.descend(node, low, high, query, best);
            }
        }
    }
}

/// The leaf of the previous result, which the next search visits first.
#[derive(Debug, Clone, Copy, Default)]
pub struct Hint {
    slot: usize,
    /// Triangles and nodes visited by all searches so far.
    visits: usize,
}

/// Whether a box at this distance may contain a better result. The tolerance covers the rounding of the distance, so
/// that ties are not lost.
fn may_hold(distance_squared: f32, best: &SurfacePoint) -> bool {
    distance_squared * (1.0 - 1e-6) <= best.distance_squared
}

/// Sorts the triangle indices into leaf order. Halving bounds the depth by the logarithm of their number.
fn build(triangles: &[[Vec3; 3]], centers: &[Vec3], order: &mut [u32], nodes: &mut Vec<Node>) -> Bounds {
    let node = nodes.len();
    nodes.push(Node { bounds: Bounds::NOTHING, right: 0 });
    let bounds = if order.len() <= LEAF_SIZE {
        order.iter().map(|&i| Bounds::of_triangle(&triangles[i as usize])).fold(Bounds::NOTHING, Bounds::union)
    } else {
        let center = |i: u32| centers[i as usize];
        let spread = (order.iter().map(|&i| Bounds { min: center(i), max: center(i) }))
            .fold(Bounds::NOTHING, Bounds::union)
            .extent();
        let axis = (1..3).fold(0, |best, axis| if spread[axis] > spread[best] { axis } else { best });
        halve(order, |i| center(i)[axis]);
        let (left, right) = order.split_at_mut(order.len() / 2);
        let left = build(triangles, centers, left, nodes);
        nodes[node].right = nodes.len() as u32;
        left.union(build(triangles, centers, right, nodes))
    };
    nodes[node].bounds = bounds;
    bounds
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
