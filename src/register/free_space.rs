//! What a sensor has looked through: between it and the surfaces that it saw there is nothing.

use glam::Vec3;

use crate::geometry::cloud::Bounds;

/// Directions along an edge of the octahedron that they are spread on: bins some 3° wide.
const BINS: usize = 64;

/// Share of the range within which a surface counts as where it was seen.
const SLACK: f32 = 0.1;

/// How far behind the nearest surface of its direction a point may be without counting as hidden by it.
const HIDDEN: f32 = 1.5;

/// Share of a cloud's points that may be hidden from where it was taken: behind edges, and while the sensor moved.
const MAX_HIDDEN: f32 = 0.3;

/// How far a sensor may be from the middle of what it saw, in box diagonals.
const MAX_AWAY: f32 = 1.0;

/// The nearest surface in every direction from a point of view.
#[derive(Debug, Clone)]
pub struct FreeSpace {
    eye: Vec3,
    /// Infinite where nothing was seen.
    ranges: Vec<f32>,
    slack: f32,
}

impl FreeSpace {
    /// What these points say about the space before them, if they can have been seen from `eye`; `None` where too many
    /// would have been hidden by others. `slack` is how far off they may be.
    pub fn seen_from(eye: Vec3, points: &[Vec3], slack: f32) -> Option<Self> {
        let bounds = Bounds::of(points)?;
        if eye.is_nan() || bounds.center().distance(eye) > MAX_AWAY * bounds.diagonal() {
            return None;
        }
        let mut free = Self { eye, ranges: vec![f32::INFINITY; BINS * BINS], slack };
        for &point in points {
            let (bin, range) = free.bin(point);
            free.ranges[bin] = free.ranges[bin].min(range);
        }
        let hidden = |&&point: &&Vec3| {
            let (bin, range) = free.bin(point);
            range > HIDDEN * free.ranges[bin] + slack
        };
        let count = points.iter().filter(hidden).count();
        (count as f32 <= MAX_HIDDEN * points.len() as f32).then_some(free)
    }

    /// Whether the sensor would have seen a surface here, and saw one behind it instead.
    pub fn contradicts(&self, point: Vec3) -> bool {
        let (bin, range) = self.bin(point);
        let seen = self.ranges[bin];
        seen.is_finite() && range < (1.0 - SLACK) * seen - self.slack
    }

    /// Direction, on an octahedron unfolded to a square, and distance.
    fn bin(&self, point: Vec3) -> (usize, f32) {
        let ray = point - self.eye;
        let sum = ray.abs().element_sum();
        if sum <= 0.0 {
            return (0, 0.0);
        }
        let (mut x, mut y) = (ray.x / sum, ray.y / sum);
        if ray.z < 0.0 {
            (x, y) = ((1.0 - y.abs()).copysign(x), (1.0 - x.abs()).copysign(y));
        }
        let cell = |x: f32| (((0.5 * x + 0.5) * BINS as f32) as usize).min(BINS - 1);
        (cell(y) * BINS + cell(x), ray.length())
    }
}
