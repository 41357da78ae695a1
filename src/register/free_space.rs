//! Free space of a sensor: the volume between the sensor and the surfaces that it observed.

use glam::Vec3;

use crate::geometry::cloud::Bounds;

/// Bins along an edge of the octahedral map of directions, each about 3° wide.
const BINS: usize = 64;

/// Relative tolerance of the range of a surface.
const SLACK: f32 = 0.1;

/// A point is hidden if its range exceeds that of the nearest surface in its direction by more than this factor.
const HIDDEN: f32 = 1.5;

/// Maximum fraction of hidden points of a cloud; edges and motion of the sensor cause some.
const MAX_HIDDEN: f32 = 0.3;

/// Maximum distance of the sensor from the centre of its cloud, in box diagonals.
const MAX_AWAY: f32 = 1.0;

/// Units of work of a point.
pub(super) const SEEN: f64 = 5e-5;

/// The range of the nearest surface in every direction from a viewpoint.
#[derive(Debug, Clone)]
pub struct FreeSpace {
    eye: Vec3,
    /// Range per bin of directions; infinite if nothing was observed.
    ranges: Vec<f32>,
    slack: f32,
}

impl FreeSpace {
    /// The free space of `points` observed from `eye`, with the tolerance `slack`. `None` if the viewpoint is
    /// implausible: too far away, or with too many points hidden by others.
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

    /// Whether `point` is in free space: the sensor observed a surface behind it.
    pub fn contradicts(&self, point: Vec3) -> bool {
        let (bin, range) = self.bin(point);
        let seen = self.ranges[bin];
        seen.is_finite() && range < (1.0 - SLACK) * seen - self.slack
    }

    /// The bin of the direction (octahedral map) and the range of a point.
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
