//! A kd-tree over 3D points: nearest, k nearest, within a radius.
//!
//! A median-split tree of bounding boxes with leaves of sixteen points, stored in leaf order. On surface points it is
//! as fast as the established crates, at a thirtieth of their WebAssembly size. Ties in distance go to the smaller
//! index, so that results do not depend on the structure of the tree.

use glam::Vec3;
use wide::f32x4;

use super::cloud::Bounds;
use super::kd_nodes::{Division, Node, Query};
use super::order::{pack, select_smallest};
use sim3align_runtime::counts;
use sim3align_runtime::scheduler::Scheduler;

/// Points of a leaf whose distances are computed at once.
const LANES: usize = 4;

/// Points per joint search of [`GroupSearch`].
const GROUP_SIZE: usize = 12;

/// Units of work of a point of a node that is made.
const DIVIDED: f64 = 3e-5;

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

impl KdTree {
    /// A tree over the points.
    pub fn new(points: &[Vec3]) -> Self {
        let mut division = Division::new(points);
        while division.advance().is_some() {}
        Self::of(points, division)
    }

    /// [`KdTree::new`], yielding.
    pub async fn paused(points: &[Vec3], scheduler: &Scheduler) -> Self {
        let mut division = Division::new(points);
        while let Some(count) = division.advance() {
            scheduler.yield_after(DIVIDED * count as f64).await;
        }
        Self::of(points, division)
    }

    fn of(points: &[Vec3], Division { order, nodes, .. }: Division) -> Self {
        counts::add(|| counts::Counts { sorted: points.len() as u64, ..Default::default() });
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

    /// The indices of the points in the order of the leaves: those that follow each other are close.
    pub fn indices(&self) -> impl Iterator<Item = u32> {
        self.points.iter().map(|(_, index)| *index)
    }

    /// The points in small groups of nearby ones.
    pub fn groups(&self) -> impl Iterator<Item = &[(Vec3, u32)]> {
        let mut groups = vec![self.points.as_slice()];
        core::iter::from_fn(move || {
            let mut group = groups.pop()?;
            while group.len() > GROUP_SIZE {
                // Halved in the same way as the tree.
                let (left, right) = group.split_at(group.len() / 2);
                groups.push(right);
                group = left;
            }
            Some(group)
        })
    }

    fn visit(&self, query: Vec3, collector: &mut impl Collector) {
        counts::add(|| counts::Counts { queries: 1, ..Default::default() });
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

/// Searches for the neighbours of the points of groups: several times faster than one [`KdTree::k_nearest`] per point, because
/// nearby points share a search.
pub struct GroupSearch<'a> {
    tree: &'a KdTree,
    points: &'a [Vec3],
    k: usize,
    found: Vec<Neighbor>,
    near: Vec<(Vec3, u32)>,
    keys: Vec<u64>,
}

impl<'a> GroupSearch<'a> {
    /// A search for the `k` nearest neighbours; the tree was built from the points.
    pub fn new(tree: &'a KdTree, points: &'a [Vec3], k: usize) -> Self {
        Self { tree, points, k, found: Vec::new(), near: Vec::new(), keys: Vec::new() }
    }

    /// Calls `visit` for every point of a group with its index and its nearest neighbours, itself included. These are keys of
    /// squared distance and index (see [`pack`]), in an unspecified but reproducible order.
    pub fn visit(&mut self, group: &[(Vec3, u32)], visit: &mut impl FnMut(u32, &[u64])) {
        let Self { tree, points, k, found, near, keys } = self;
        let members = || group.iter().map(|(point, _)| *point);
        let Some(center) = Bounds::of(&members().collect::<Vec<_>>()).map(|b| b.center()) else { return };
        let spread = members().map(|q| q.distance(center)).fold(0.0, f32::max);
        // The centre has k neighbours within its reach r. By the triangle inequality, a point q at distance d from
        // the centre has k neighbours within r + d, all of which are within r + 2 d of the centre.
        tree.k_nearest(center, *k, found);
        let reach = found.last().filter(|_| found.len() == *k).map_or(f32::INFINITY, |n| n.distance_squared.sqrt());
        if let [(_, index)] = group {
            keys.clear();
            keys.extend(found.iter().map(|n| pack(n.distance_squared, n.index)));
            return visit(*index, keys);
        }
        // Of points that coincide with the centre, there may be many more.
        if spread > 0.0 || reach > 0.0 {
            tree.within(center, (reach + 2.0 * spread) * (1.0 + ROUNDING), found);
        }
        near.clear();
        near.extend(found.iter().filter_map(|n| Some((*points.get(n.index as usize)?, n.index))));
        for &(query, index) in group {
            let enough = (reach + query.distance(center)) * (1.0 + ROUNDING);
            let limit = enough * enough;
            // Writes every key and overwrites the rejected ones: half are rejected at random, so that a branch
            // would be mispredicted.
            keys.resize(near.len(), 0);
            let mut count = 0;
            for &(point, index) in near.iter() {
                let distance_squared = point.distance_squared(query);
                keys[count] = pack(distance_squared, index);
                count += usize::from(distance_squared <= limit);
            }
            keys.truncate(count);
            select_smallest(keys, *k);
            keys.truncate(*k);
            visit(index, keys);
        }
    }
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
