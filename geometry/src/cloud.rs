//! Point clouds and axis-aligned bounding boxes.

use glam::Vec3;
use wide::f32x4;

use crate::rotations::fibonacci_sphere;

/// Points, optionally with unit normals, in any frame and unit.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Cloud {
    /// Positions.
    pub points: Vec<Vec3>,
    /// One unit normal per point, or empty. A zero vector marks an unknown normal.
    pub normals: Vec<Vec3>,
}

impl Cloud {
    /// Points without normals.
    pub fn from_points(points: Vec<Vec3>) -> Self {
        Self { points, normals: Vec::new() }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether the cloud has no points.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// The cloud of the points at `indices`, in that order. Indices out of range are ignored.
    pub fn select(&self, indices: impl IntoIterator<Item = usize>) -> Self {
        let mut cloud = Self::default();
        for i in indices {
            if let Some(&point) = self.points.get(i) {
                cloud.points.push(point);
                cloud.normals.extend(self.normals.get(i));
            }
        }
        cloud
    }
}

/// An axis-aligned bounding box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// The corner with the smallest coordinates.
    pub min: Vec3,
    /// The corner with the largest coordinates.
    pub max: Vec3,
}

impl Bounds {
    /// The smallest box around the points; `None` for no points.
    #[inline(never)]
    pub fn of(points: &[Vec3]) -> Option<Self> {
        let lanes = |p: &Vec3| f32x4::new([p.x, p.y, p.z, 0.0]);
        let first = lanes(points.first()?);
        let widened = |(min, max): (f32x4, f32x4), p: &Vec3| (min.fast_min(lanes(p)), max.fast_max(lanes(p)));
        let (min, max) = points.iter().fold((first, first), widened);
        let [min, max] = [min, max].map(|corner| Vec3::from_slice(corner.as_array()));
        Some(Self { min, max })
    }

    /// The empty box, the identity of [`Bounds::union`].
    pub const NOTHING: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The smallest box around both.
    // `f32::min` and `f32::max` are function calls in WebAssembly.
    pub fn union(self, other: Self) -> Self {
        let Self { min, max } = other;
        Self {
            min: Vec3::select(self.min.cmplt(min), self.min, min),
            max: Vec3::select(self.max.cmpgt(max), self.max, max),
        }
    }

    /// The squared distance of a point to the box, 0 inside. Never larger than that of the point to any point of the
    /// box as `Vec3::distance_squared` rounds it: both round the same way in every step.
    // Inlined always: it dominates the run time of searches. `f32::max` is a function call in WebAssembly.
    #[inline(always)]
    pub fn distance_squared(&self, point: Vec3) -> f32 {
        let gap = |min: f32, max: f32, x: f32| {
            let (below, above) = (min - x, x - max);
            let gap = if below > above { below } else { above };
            if gap > 0.0 { gap } else { 0.0 }
        };
        let x = gap(self.min.x, self.max.x, point.x);
        let y = gap(self.min.y, self.max.y, point.y);
        let z = gap(self.min.z, self.max.z, point.z);
        x * x + y * y + z * z
    }

    /// The smallest box around a triangle.
    #[inline(always)]
    pub fn of_triangle([a, b, c]: &[Vec3; 3]) -> Self {
        Self { min: a.min(*b).min(*c), max: a.max(*b).max(*c) }
    }

    /// The centre of the box.
    pub fn center(&self) -> Vec3 {
        (self.min + self.max) * 0.5
    }

    /// The lengths of the edges.
    pub fn extent(&self) -> Vec3 {
        self.max - self.min
    }

    /// The length of the box diagonal, ‖extent‖ in the paper's scale initialisation (§3.1).
    pub fn diagonal(&self) -> f32 {
        self.extent().length()
    }
}

/// The index of the point farthest along a direction, the first of equal ones; `None` without points.
pub fn farthest_along(points: &[Vec3], direction: Vec3) -> Option<usize> {
    let mut best: Option<(usize, f32)> = None;
    for (i, point) in points.iter().enumerate() {
        let along = point.dot(direction);
        if best.is_none_or(|(_, most)| along > most) {
            best = Some((i, along));
        }
    }
    best.map(|(i, _)| i)
}

/// The points that are farthest along so many evenly spread directions, each once, in the order of the directions.
pub fn outermost(points: &[Vec3], directions: usize) -> Vec<Vec3> {
    let farthest = |k| farthest_along(points, fibonacci_sphere(k, directions).as_vec3());
    let mut kept: Vec<usize> = (0..directions).filter_map(farthest).collect();
    let mut seen = vec![false; points.len()];
    kept.retain(|&i| !core::mem::replace(&mut seen[i], true));
    kept.iter().map(|&i| points[i]).collect()
}
