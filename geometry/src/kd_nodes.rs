//! The nodes of a kd-tree, and how points are divided among them.

use glam::Vec3;
use wide::f32x4;

use super::cloud::Bounds;
use super::order::halve;

/// Maximum number of points of a leaf.
pub const LEAF_SIZE: usize = 16;

/// A node of the tree.
#[derive(Debug, Clone, Copy)]
pub struct Node {
    /// The boxes around the points of the children: tighter than their cells if the points sample a surface.
    pub children: TwoBoxes,
    /// The smallest index of each child's points: of points that coincide, a search for the nearest visits no more than it
    /// keeps.
    pub first: [u32; 2],
    /// The right child; 0 in a leaf.
    pub right: u32,
}

/// Two boxes: x of both and y of both, and z of both twice.
#[derive(Debug, Clone, Copy)]
pub struct TwoBoxes {
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
    pub fn distances_squared(&self, query: &Query) -> [f32; 2] {
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
pub struct Query {
    /// x, y and z.
    pub axes: [f32x4; 3],
    two: [f32x4; 2],
}

impl Query {
    /// A query for the neighbours of a point.
    pub fn new(point: Vec3) -> Self {
        let Vec3 { x, y, z } = point;
        Self {
            axes: [f32x4::splat(x), f32x4::splat(y), f32x4::splat(z)],
            two: [f32x4::new([x, x, y, y]), f32x4::splat(z)],
        }
    }
}

/// The division of points among nodes.
pub struct Division {
    points: Vec<f32x4>,
    /// The indices of the points, in the end in the order of the leaves.
    pub order: Vec<u32>,
    /// Depth-first: an inner node over `n` points is followed by its left child, over ⌊n/2⌋ of them.
    pub nodes: Vec<Node>,
    /// Ranges of the order with their boxes, and the parents whose right child they are, or no node.
    parts: Vec<(usize, usize, Bounds, usize)>,
}

impl Division {
    /// No node so far.
    pub fn new(points: &[Vec3]) -> Self {
        let order: Vec<u32> = (0..points.len() as u32).collect();
        let points: Vec<f32x4> = points.iter().map(|p| f32x4::new([p.x, p.y, p.z, 0.0])).collect();
        let parts = vec![(0, order.len(), Part::of(&points, &order).bounds, usize::MAX)];
        Self { nodes: Vec::with_capacity(points.len() / (LEAF_SIZE / 4)), points, order, parts }
    }

    /// Makes the next node. The number of its points; `None` if there is no node left.
    pub fn advance(&mut self) -> Option<usize> {
        let (low, high, bounds, right_of) = self.parts.pop()?;
        let number = self.nodes.len();
        if let Some(parent) = self.nodes.get_mut(right_of) {
            parent.right = number as u32;
        }
        let mut node = Node { children: TwoBoxes::NOTHING, first: [0; 2], right: 0 };
        if high - low > LEAF_SIZE {
            let middle = low + (high - low) / 2;
            let [left, right] = halves(&self.points, &mut self.order[low..high], bounds);
            node.children = TwoBoxes::new([left.bounds, right.bounds]);
            node.first = [left.first, right.first];
            self.parts.extend([(middle, high, right.bounds, number), (low, middle, left.bounds, usize::MAX)]);
        }
        self.nodes.push(node);
        Some(high - low)
    }
}

/// Some of the points.
struct Part {
    bounds: Bounds,
    /// The smallest index.
    first: u32,
}

impl Part {
    fn of(points: &[f32x4], order: &[u32]) -> Self {
        let (mut min, mut max) = (f32x4::splat(f32::INFINITY), f32x4::splat(f32::NEG_INFINITY));
        let mut first = u32::MAX;
        for &i in order {
            let point = points[i as usize];
            (min, max, first) = (min.fast_min(point), max.fast_max(point), first.min(i));
        }
        let [min, max] = [min.to_array(), max.to_array()];
        Self {
            bounds: Bounds { min: Vec3::new(min[0], min[1], min[2]), max: Vec3::new(max[0], max[1], max[2]) },
            first,
        }
    }
}

/// Divides the points of a box at their median along its longest edge.
fn halves(points: &[f32x4], order: &mut [u32], bounds: Bounds) -> [Part; 2] {
    let extent = bounds.extent();
    let axis = if extent.x >= extent.y && extent.x >= extent.z {
        0
    } else if extent.y >= extent.z {
        1
    } else {
        2
    };
    halve(order, |i| points[i as usize].as_array()[axis]);
    let (left, right) = order.split_at(order.len() / 2);
    [Part::of(points, left), Part::of(points, right)]
}
