//! Planes in the camera frame.

use glam::{DMat3, DVec3};
use serde::{Deserialize, Serialize};

use crate::geometry::symmetric_eigen::SymmetricEigen;

/// A plane n·x + d = 0 in the camera frame, metres. n is a unit vector that points to the side of the objects.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Plane {
    /// n.
    pub normal: DVec3,
    /// d, metres.
    pub d: f64,
}

/// The support, or how to find it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum SupportChoice {
    /// It is found in the depth map.
    #[default]
    Auto,
    /// The plane.
    Plane(Plane),
    /// There is none.
    None,
}

impl Plane {
    /// The plane with the camera on its positive side; `None` if the normal has no direction.
    pub fn new(normal: DVec3, d: f64) -> Option<Self> {
        let length = normal.length();
        let (normal, d) = (normal / length, d / length);
        (normal.is_finite() && d.is_finite()).then_some(if d < 0.0 {
            Self { normal: -normal, d: -d }
        } else {
            Self { normal, d }
        })
    }

    /// The plane through three points; `None` if they are in a line.
    pub fn through([a, b, c]: [DVec3; 3]) -> Option<Self> {
        let normal = (b - a).cross(c - a);
        let sides = (b - a).length() * (c - a).length();
        if normal.length() < 1e-3 * sides {
            return None;
        }
        Self::new(normal, -normal.dot(a))
    }

    /// The plane with the least weighted squares of distances.
    pub fn fitted(points: impl Iterator<Item = (DVec3, f64)> + Clone) -> Option<Self> {
        let (mut total, mut sum) = (0.0, DVec3::ZERO);
        for (point, weight) in points.clone() {
            total += weight;
            sum += point * weight;
        }
        if total <= 0.0 {
            return None;
        }
        let center = sum / total;
        let mut spread = DMat3::ZERO;
        for (point, weight) in points {
            let v = point - center;
            spread += DMat3::from_cols(v * v.x, v * v.y, v * v.z) * weight;
        }
        let normal = SymmetricEigen::of(spread).vectors[0];
        Self::new(normal, -normal.dot(center))
    }

    /// The height of a point over the plane, metres.
    pub fn height(&self, point: DVec3) -> f64 {
        self.normal.dot(point) + self.d
    }

    /// The plane at this height over this one.
    pub fn raised(&self, height: f64) -> Self {
        Self { d: self.d - height, ..*self }
    }
}
