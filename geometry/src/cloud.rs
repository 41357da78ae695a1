//! Point clouds and their boxes.

use glam::Vec3;

/// Points, with a unit normal each or with none.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Cloud {
    /// Positions.
    pub points: Vec<Vec3>,
    /// One unit normal per point, or empty. A zero vector is a point whose normal is unknown.
    pub normals: Vec<Vec3>,
}

impl Cloud {
    /// Points without normals.
    pub fn from_points(points: Vec<Vec3>) -> Self {
        Self { points, normals: Vec::new() }
    }

    /// How many points.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether there is no point.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// The cloud of the points at `indices`, in that order. Indices that do not exist are passed over.
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

/// An axis-aligned box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// The corner with the smallest coordinates.
    pub min: Vec3,
    /// The corner with the largest coordinates.
    pub max: Vec3,
}

impl Bounds {
    /// The smallest box around the points; `None` for no points.
    pub fn of(points: &[Vec3]) -> Option<Self> {
        let (&first, rest) = points.split_first()?;
        Some(rest.iter().fold(Self { min: first, max: first }, |b, &p| Self { min: b.min.min(p), max: b.max.max(p) }))
    }

    /// The box around nothing; the smallest box around it and another is the other.
    pub const NOTHING: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The smallest box around both.
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The squared distance of a point to the box, 0 inside. Never more than that of the point to any point of the
    /// box as `Vec3::distance_squared` rounds it: both round the same way in every step.
    // Inlined whatever the compiler thinks it costs: searches do little else. `f32::max` is a call in WebAssembly.
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

    /// The middle of the box.
    pub fn center(&self) -> Vec3 {
        (self.min + self.max) * 0.5
    }

    /// The box's edges.
    pub fn extent(&self) -> Vec3 {
        self.max - self.min
    }

    /// The length of the box diagonal, ‖extent‖ in the paper's scale initialisation (§3.1).
    pub fn diagonal(&self) -> f32 {
        self.extent().length()
    }
}
