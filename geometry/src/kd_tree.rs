//! A kd-tree over 3D points: nearest, k nearest, within a radius.
//!
//! A median-split tree of bounding boxes with leaves of sixteen points, stored in leaf order. On surface points it is
//! as fast as the established crates, at a thirtieth of their WebAssembly size. Ties in distance go to the smaller
//! index, so that results do not depend on the structure of the tree.

use glam::Vec3;
use wide::f32x4;

use super::cloud::Bounds;
use super::order::{halve, pack, select_smallest};

const LEAF_SIZE: usize = 16;

/// Points of a leaf whose distances are computed at once.
const LANES: usize = 4;

/// Points per joint search of [`KdTree::neighborhoods`].
const GROUP_SIZE: usize = 12;

/// Safety factor for the rounding of a sum of f32 distances.
const ROUNDING: f32 = 1e-5;

/// A result of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neighbor {
    /// Index into the points given to [`KdTree::new`].
    pub index: u32,
    /// Squared distance to the query.
    pub distance_squared: f32,
}

impl Neighbor {
    /// Orders by distance, then by index.
    fn key(&self) -> (f32, u32) {
        (self.distance_squared, self.index)
    }
}

/// A median kd-tree. Points must be finite.
#[derive(Debug, Clone)]
pub struct KdTree {
    /// Points in leaf order, with their original indices.
    points: Vec<(Vec3, u32)>,
    /// Their coordinates by axis, followed by zeros to fill the last lanes.
    axes: [Vec<f32>; 3],
    /// Depth-first: an inner node over `n` points is followed by its left child, over ⌊n/2⌋ of them.
    nodes: Vec<Node>,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    /// The boxes around the points of the children: tighter than their cells if the points sample a surface.
    children: TwoBoxes,
    /// The smallest index of each child's points: of points that coincide, a search for the nearest visits no more than it
    /// keeps.
    first: [u32; 2],
    /// The right child; 0 in a leaf.
    right: u32,
}

/// Two boxes: x of both and y of both, and z of both twice.
#[derive(Debug, Clone, Copy)]
struct TwoBoxes {
    min: [f32x4; 2],
    max: [f32x4; 2],
}

impl TwoBoxes {
    const NOTHING: Self = Self { min: [f32x4::ZERO; 2], max: [f32x4::ZERO; 2] };

    fn new([a, b]: [Bounds; 2]) -> Self {
        let lanes = |a: Vec3, b: Vec3| [f32x4::new([a.x, b.x, a.y, b.y]), f32x4::new([a.z, b.z, a.z, b.z])];
        Self { min: lanes(a.min, b.min), max: lanes(a.max, b.max) }
    }

    /// [`Bounds::distance_squared`] of each.
    #[inline(always)]
    fn distances_squared(&self, query: &Query) -> [f32; 2] {
        let squares = |axes: usize| {
            let (below, above) = (self.min[axes] - query.two[axes], query.two[axes] - self.max[axes]);
            let gap = below.fast_max(above).fast_max(f32x4::ZERO);
            (gap * gap).to_array()
        };
        let ([ax, bx, ay, by], [az, bz, ..]) = (squares(0), squares(1));
        [ax + ay + az, bx + by + bz]
    }
}

/// The coordinates of a query: each in all lanes, and as those of [`TwoBoxes`].
struct Query {
    axes: [f32x4; 3],
    two: [f32x4; 2],
}

impl Query {
    fn new(point: Vec3) -> Self {
        let Vec3 { x, y, z } = point;
        Self {
            axes: [f32x4::splat(x), f32x4::splat(y), f32x4::splat(z)],
            two: [f32x4::new([x, x, y, y]), f32x4::splat(z)],
        }
    }
}

impl KdTree {
    /// A tree over the points.
    pub fn new(points: &[Vec3]) -> Self {
        let mut order: Vec<u32> = (0..points.len() as u32).collect();
        let mut nodes = Vec::with_capacity(points.len() / (LEAF_SIZE / 4));
        let lanes: Vec<f32x4> = points.iter().map(|p| f32x4::new([p.x, p.y, p.z, 0.0])).collect();
        build(&lanes, &mut order, &mut nodes);
        let points: Vec<(Vec3, u32)> = order.into_iter().map(|i| (points[i as usize], i)).collect();
        let axis = |axis: usize| points.iter().map(|(p, _)| p[axis]).chain([0.0; LANES - 1]).collect();
        Self { axes: [axis(0), axis(1), axis(2)], points, nodes }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether the tree has no points.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// The point nearest to `query`; `None` in an empty tree.
    pub fn nearest(&self, query: Vec3) -> Option<Neighbor> {
        self.nearest_within(query, f32::INFINITY)
    }

    /// The point nearest to `query` within `radius` (inclusive), or `None`.
    pub fn nearest_within(&self, query: Vec3, radius: f32) -> Option<Neighbor> {
        let mut nearest = Nearest { best: Neighbor { index: u32::MAX, distance_squared: radius * radius } };
        self.visit(query, &mut nearest);
        (nearest.best.index != u32::MAX).then_some(nearest.best)
    }

    /// Replaces `out` with the `k` points nearest to `query`, nearest first; all points if the tree has fewer.
    pub fn k_nearest(&self, query: Vec3, k: usize, out: &mut Vec<Neighbor>) {
        out.clear();
        if k > 0 {
            self.visit(query, &mut KNearest { k, found: out });
        }
    }

    /// Replaces `out` with all points within `radius` (inclusive) of `query`, in an unspecified but reproducible
    /// order.
    pub fn within(&self, query: Vec3, radius: f32, out: &mut Vec<Neighbor>) {
        out.clear();
        self.visit(query, &mut Within { radius_squared: radius * radius, found: out });
    }

    /// Calls `visit` for every point of the tree with its index and its `k` nearest neighbours within `radius`, itself
    /// included. The neighbours are keys of squared distance and index (see [`pack`]), in an unspecified but
    /// reproducible order. `points` must be the points that the tree was built from.
    ///
    /// Several times faster than one [`KdTree::k_nearest`] per point, because nearby points share a search.
    ///
    /// A `stride` above 1 visits about one in `stride` points only, in small groups evenly over the cloud.
    pub fn neighborhoods(
        &self,
        points: &[Vec3],
        k: usize,
        radius: f32,
        stride: usize,
        mut visit: impl FnMut(u32, &[u64]),
    ) {
        let (mut found, mut near, mut keys) = (Vec::new(), Vec::new(), Vec::new());
        let mut groups = vec![self.points.as_slice()];
        let mut number = 0;
        while let Some(group) = groups.pop() {
            if group.len() > GROUP_SIZE {
                // Halved in the same way as the tree.
                let (left, right) = group.split_at(group.len() / 2);
                groups.extend([right, left]);
                continue;
            }
            number += 1;
            if number % stride != 0 {
                continue;
            }
            let members = || group.iter().map(|(point, _)| *point);
            let Some(center) = Bounds::of(&members().collect::<Vec<_>>()).map(|b| b.center()) else { continue };
            let spread = members().map(|q| q.distance(center)).fold(0.0, f32::max);
            // The centre has k neighbours within its reach r. By the triangle inequality, a point q at distance d from
            // the centre has k neighbours within r + d, all of which are within r + 2 d of the centre.
            self.k_nearest(center, k, &mut found);
            let reach = found.last().filter(|_| found.len() == k).map_or(f32::INFINITY, |n| n.distance_squared.sqrt());
            // Of points that coincide with the centre, there may be many more.
            if spread > 0.0 || reach > 0.0 {
                self.within(center, (reach + 2.0 * spread) * (1.0 + ROUNDING), &mut found);
            }
            near.clear();
            near.extend(found.iter().filter_map(|n| Some((*points.get(n.index as usize)?, n.index))));
            for &(query, index) in group {
                let enough = ((reach + query.distance(center)) * (1.0 + ROUNDING)).min(radius);
                let limit = enough * enough;
                // Writes every key and overwrites the rejected ones: half are rejected at random, so that a branch
                // would be mispredicted.
                keys.resize(near.len(), 0);
                let mut count = 0;
                for &(point, index) in &near {
                    let distance_squared = point.distance_squared(query);
                    keys[count] = pack(distance_squared, index);
                    count += usize::from(distance_squared <= limit);
                }
                keys.truncate(count);
                select_smallest(&mut keys, k);
                keys.truncate(k);
                visit(index, &keys);
            }
        }
    }

    fn visit(&self, query: Vec3, collector: &mut impl Collector) {
        self.descend(0, 0, self.points.len(), &Query::new(query), collector);
    }

    /// Visits the subtree over `points[low..high]`.
    fn descend(&self, node: usize, low: usize, high: usize, query: &Query, collector: &mut impl Collector) {
        let Node { children, first, right } = &self.nodes[node];
        if *right == 0 {
            for from in (low..high).step_by(LANES) {
                let distances = self.distances_squared(from, query);
                let mut near = distances.simd_le(f32x4::splat(collector.limit())).to_bitmask();
                near &= (1 << (high - from).min(LANES)) - 1;
                let distances = distances.to_array();
                while near != 0 {
                    let lane = near.trailing_zeros() as usize & (LANES - 1);
                    near &= near - 1;
                    let Some(&(_, index)) = self.points.get(from + lane) else { break };
                    collector.offer(Neighbor { index, distance_squared: distances[lane] });
                }
            }
            return;
        }
        let middle = low + (high - low) / 2;
        let (left, right) = ((node + 1, low, middle), (*right as usize, middle, high));
        let [to_left, to_right] = children.distances_squared(query);
        let to_left = Neighbor { index: first[0], distance_squared: to_left };
        let to_right = Neighbor { index: first[1], distance_squared: to_right };
        let ((near, to_near), (far, to_far)) = if to_left.distance_squared <= to_right.distance_squared {
            ((left, to_left), (right, to_right))
        } else {
            ((right, to_right), (left, to_left))
        };
        if collector.wants(to_near) {
            self.descend(near.0, near.1, near.2, query, collector);
        }
        if collector.wants(to_far) {
            self.descend(far.0, far.1, far.2, query, collector);
        }
    }

    /// The squared distances of the points from the `from`th on, in leaf order.
    #[inline(always)]
    fn distances_squared(&self, from: usize, query: &Query) -> f32x4 {
        let gap = |axis: usize| {
            let four = self.axes[axis].get(from..).and_then(|axis| axis.first_chunk::<LANES>());
            four.map_or(f32x4::ZERO, |four| f32x4::new(*four) - query.axes[axis])
        };
        let (x, y, z) = (gap(0), gap(1), gap(2));
        x * x + y * y + z * z
    }
}

/// Sorts the indices of `points` into leaf order and records the nodes in depth-first order.
/// Returns the box of the points and their smallest index.
fn build(points: &[f32x4], order: &mut [u32], nodes: &mut Vec<Node>) -> (Bounds, u32) {
    let (mut min, mut max) = (f32x4::splat(f32::INFINITY), f32x4::splat(f32::NEG_INFINITY));
    for &i in order.iter() {
        let point = points[i as usize];
        (min, max) = (min.fast_min(point), max.fast_max(point));
    }
    let [min, max] = [min.to_array(), max.to_array()];
    let bounds = Bounds { min: Vec3::new(min[0], min[1], min[2]), max: Vec3::new(max[0], max[1], max[2]) };
    let node = nodes.len();
    nodes.push(Node { children: TwoBoxes::NOTHING, first: [0; 2], right: 0 });
    if order.len() <= LEAF_SIZE {
        return (bounds, order.iter().copied().min().unwrap_or_default());
    }
    let extent = bounds.extent();
    let axis = if extent.x >= extent.y && extent.x >= extent.z {
        0
    } else if extent.y >= extent.z {
        1
    } else {
        2
    };
    halve(order, |i| points[i as usize].as_array()[axis]);
    let (left, right) = order.split_at_mut(order.len() / 2);
    let (left_bounds, left_first) = build(points, left, nodes);
    let right_node = nodes.len() as u32;
    let (right_bounds, right_first) = build(points, right, nodes);
    nodes[node] = Node {
        children: TwoBoxes::new([left_bounds, right_bounds]),
        first: [left_first, right_first],
        right: right_node,
    };
    (bounds, left_first.min(right_first))
}

/// Candidates that a search keeps.
trait Collector {
    fn offer(&mut self, neighbor: Neighbor);
    /// The squared distance beyond which it keeps no neighbour.
    fn limit(&self) -> f32;
    /// Whether it would keep `first`, or any neighbour that sorts after it.
    fn wants(&self, first: Neighbor) -> bool;
}

struct Nearest {
    best: Neighbor,
}

impl Collector for Nearest {
    fn limit(&self) -> f32 {
        self.best.distance_squared
    }

    fn offer(&mut self, neighbor: Neighbor) {
        if self.wants(neighbor) {
            self.best = neighbor;
        }
    }

    fn wants(&self, first: Neighbor) -> bool {
        first.key() < self.best.key()
    }
}

struct KNearest<'a> {
    k: usize,
    found: &'a mut Vec<Neighbor>,
}

impl Collector for KNearest<'_> {
    fn limit(&self) -> f32 {
        self.found.get(self.k - 1).map_or(f32::INFINITY, |last| last.distance_squared)
    }

    fn offer(&mut self, neighbor: Neighbor) {
        if !self.wants(neighbor) {
            return;
        }
        self.found.truncate(self.k - 1);
        let at = self.found.partition_point(|n| n.key() < neighbor.key());
        self.found.insert(at, neighbor);
    }

    fn wants(&self, first: Neighbor) -> bool {
        match self.found.last() {
            Some(last) if self.found.len() == self.k => first.key() < last.key(),
            // A query that is NaN has no neighbours.
            _ => !first.distance_squared.is_nan(),
        }
    }
}

struct Within<'a> {
    radius_squared: f32,
    found: &'a mut Vec<Neighbor>,
}

impl Collector for Within<'_> {
    fn limit(&self) -> f32 {
        self.radius_squared
    }

    fn offer(&mut self, neighbor: Neighbor) {
        if self.wants(neighbor) {
            self.found.push(neighbor);
        }
    }

    fn wants(&self, first: Neighbor) -> bool {
        first.distance_squared <= self.radius_squared
    }
}
