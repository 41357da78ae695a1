//! A kd-tree over 3D points: nearest, k nearest, within a radius.
//!
//! A plain median tree with leaves of eight points, points stored in leaf order. It answers as fast as the
//! large crates do on surface points and costs a thirtieth of their bytes in WebAssembly. Ties in distance
//! go to the smaller index, so that an answer never depends on the tree's shape.

use glam::Vec3;

use super::order::halve;

const LEAF_SIZE: usize = 8;

/// A point found, by its index in the slice the tree was built from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neighbor {
    /// Index into the points given to [`KdTree::new`].
    pub index: u32,
    /// Squared distance to the query.
    pub distance_squared: f32,
}

impl Neighbor {
    /// Nearer first; of equally near ones the smaller index first.
    fn key(&self) -> (f32, u32) {
        (self.distance_squared, self.index)
    }
}

/// A median kd-tree. Points must be finite.
#[derive(Debug, Clone)]
pub struct KdTree {
    /// Points in leaf order, with their original indices.
    points: Vec<(Vec3, u32)>,
    /// Splits of the implicit tree in depth-first order: a node over `n` points is followed by its left
    /// subtree; leaves have no entry.
    splits: Vec<Split>,
}

#[derive(Debug, Clone, Copy)]
struct Split {
    axis: u8,
    /// Where the left half ends and the right half begins along `axis`.
    low: f32,
    high: f32,
    /// Index of the right child's split.
    right: u32,
}

impl KdTree {
    /// A tree over the points.
    pub fn new(points: &[Vec3]) -> Self {
        let mut order: Vec<u32> = (0..points.len() as u32).collect();
        let mut splits = Vec::with_capacity(points.len() / (LEAF_SIZE / 2));
        build(points, &mut order, &mut splits);
        Self { points: order.into_iter().map(|i| (points[i as usize], i)).collect(), splits }
    }

    /// How many points the tree holds.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether the tree holds no point.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// The point nearest to `query`; `None` in an empty tree.
    pub fn nearest(&self, query: Vec3) -> Option<Neighbor> {
        self.nearest_within(query, f32::INFINITY)
    }

    /// The point nearest to `query` among those within `radius`, the boundary included.
    pub fn nearest_within(&self, query: Vec3, radius: f32) -> Option<Neighbor> {
        let mut nearest = Nearest { best: Neighbor { index: u32::MAX, distance_squared: radius * radius } };
        self.visit(query, &mut nearest);
        (nearest.best.index != u32::MAX).then_some(nearest.best)
    }

    /// The `k` points nearest to `query`, nearest first, into `out`. Fewer where the tree holds fewer.
    pub fn k_nearest(&self, query: Vec3, k: usize, out: &mut Vec<Neighbor>) {
        out.clear();
        if k > 0 {
            self.visit(query, &mut KNearest { k, found: out });
        }
    }

    /// All points within `radius` of `query`, the boundary included, into `out`, in no particular
    /// (but reproducible) order.
    pub fn within(&self, query: Vec3, radius: f32, out: &mut Vec<Neighbor>) {
        out.clear();
        self.visit(query, &mut Within { radius_squared: radius * radius, found: out });
    }

    fn visit(&self, query: Vec3, collector: &mut impl Collector) {
        self.descend(0, 0, self.points.len(), query, [0.0; 3], collector);
    }

    /// Visits the subtree over `points[low..high]`; `offset` is the query's distance to its box, by axis.
    fn descend(
        &self,
        node: usize,
        low: usize,
        high: usize,
        query: Vec3,
        offset: [f32; 3],
        collector: &mut impl Collector,
    ) {
        if high - low <= LEAF_SIZE {
            for &(point, index) in &self.points[low..high] {
                collector.offer(Neighbor { index, distance_squared: point.distance_squared(query) });
            }
            return;
        }
        let split = self.splits[node];
        let axis = split.axis as usize;
        let middle = low + (high - low) / 2;
        let q = query[axis];
        let (left, right) = ((node + 1, low, middle), (split.right as usize, middle, high));
        let left_first = q - split.low < split.high - q;
        let (near, far) = if left_first { (left, right) } else { (right, left) };
        let gap = if left_first { split.high - q } else { q - split.low };
        self.descend(near.0, near.1, near.2, query, offset, collector);
        let mut offset = offset;
        offset[axis] = offset[axis].max(gap);
        let [x, y, z] = offset;
        if x * x + y * y + z * z <= collector.reach_squared() {
            self.descend(far.0, far.1, far.2, query, offset, collector);
        }
    }
}

/// Sorts the indices of `points` into leaf order and records the splits in depth-first order.
fn build(points: &[Vec3], order: &mut [u32], splits: &mut Vec<Split>) {
    if order.len() <= LEAF_SIZE {
        return;
    }
    let point = |i: u32| points[i as usize];
    let (mut min, mut max) = (point(order[0]), point(order[0]));
    for &i in order.iter() {
        (min, max) = (min.min(point(i)), max.max(point(i)));
    }
    let extent = max - min;
    let axis = if extent.x >= extent.y && extent.x >= extent.z {
        0
    } else if extent.y >= extent.z {
        1
    } else {
        2
    };
    halve(order, |i| point(i)[axis]);
    let (left, right) = order.split_at_mut(order.len() / 2);
    let node = splits.len();
    let low = left.iter().map(|&i| point(i)[axis]).fold(f32::NEG_INFINITY, f32::max);
    let high = right.iter().map(|&i| point(i)[axis]).fold(f32::INFINITY, f32::min);
    splits.push(Split { axis: axis as u8, low, high, right: 0 });
    build(points, left, splits);
    splits[node].right = splits.len() as u32;
    build(points, right, splits);
}

/// What a search keeps of the points it is offered, and how far it still looks.
trait Collector {
    fn offer(&mut self, neighbor: Neighbor);
    fn reach_squared(&self) -> f32;
}

struct Nearest {
    best: Neighbor,
}

impl Collector for Nearest {
    fn offer(&mut self, neighbor: Neighbor) {
        if neighbor.key() < self.best.key() {
            self.best = neighbor;
        }
    }

    fn reach_squared(&self) -> f32 {
        self.best.distance_squared
    }
}

struct KNearest<'a> {
    k: usize,
    found: &'a mut Vec<Neighbor>,
}

impl Collector for KNearest<'_> {
    fn offer(&mut self, neighbor: Neighbor) {
        if self.found.len() == self.k {
            if self.found.last().is_some_and(|last| neighbor.key() >= last.key()) {
                return;
            }
            self.found.pop();
        }
        let at = self.found.partition_point(|n| n.key() < neighbor.key());
        self.found.insert(at, neighbor);
    }

    fn reach_squared(&self) -> f32 {
        match self.found.last() {
            Some(last) if self.found.len() == self.k => last.distance_squared,
            _ => f32::INFINITY,
        }
    }
}

struct Within<'a> {
    radius_squared: f32,
    found: &'a mut Vec<Neighbor>,
}

impl Collector for Within<'_> {
    fn offer(&mut self, neighbor: Neighbor) {
        if neighbor.distance_squared <= self.radius_squared {
            self.found.push(neighbor);
        }
    }

    fn reach_squared(&self) -> f32 {
        self.radius_squared
    }
}
