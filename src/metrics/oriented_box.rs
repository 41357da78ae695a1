//! Overlap of two boxes in any orientation.

use nalgebra::Vector3;

use crate::geometry::cloud::Bounds;
use crate::geometry::similarity::{Similarity, vector3};

/// Distances to a plane below this fraction of the boxes' sizes count as 0.
const COPLANAR: f64 = 1e-9;

/// A box in any orientation: three perpendicular half axes about a centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrientedBox {
    /// The centre.
    pub center: Vector3<f64>,
    /// Half the edges, perpendicular to each other.
    pub half_axes: [Vector3<f64>; 3],
}

impl OrientedBox {
    /// The box of `bounds` after a transform.
    pub fn of(bounds: &Bounds, transform: &Similarity) -> Self {
        let (low, high) = (vector3(bounds.min), vector3(bounds.max));
        let half = (high - low) * (0.5 * transform.scale);
        let axis = |i: usize| transform.rotation.matrix().column(i) * half[i];
        Self { center: transform.apply(low.lerp(&high, 0.5)), half_axes: [axis(0), axis(1), axis(2)] }
    }

    /// The volume.
    pub fn volume(&self) -> f64 {
        let [a, b, c] = &self.half_axes;
        8.0 * a.cross(b).dot(c).abs()
    }

    /// Volume of the intersection over volume of the union, 0 to 1; 0 if both are flat.
    pub fn iou(&self, other: &Self) -> f64 {
        let (one, two) = (self.volume(), other.volume());
        // The faces of a flat box do not enclose it.
        let shared = self.intersection(other).min(one).min(two).max(0.0);
        if one + two > 0.0 { shared / (one + two - shared) } else { 0.0 }
    }

    /// The volume of the intersection, exact up to rounding; both boxes have a volume above 0.
    ///
    /// The surface of the intersection consists of the parts of the faces of each box inside the other. By the divergence
    /// theorem, its volume is a third of the sum of their areas times the distances of their planes from any point.
    pub fn intersection(&self, other: &Self) -> f64 {
        let size = |b: &Self| b.half_axes.iter().map(|axis| axis.norm()).sum::<f64>();
        let near = COPLANAR * (size(self) + size(other));
        let mut volume = 0.0;
        for (owner, clipper, is_second) in [(self, other, false), (other, self, true)] {
            for face in owner.faces() {
                // A face that both boxes share is counted once.
                let is_shared = |plane: &Face| {
                    face.normal.dot(&plane.normal) > 0.0 && face.corners.iter().all(|c| plane.height(c).abs() <= near)
                };
                if is_second && clipper.faces().iter().any(is_shared) {
                    continue;
                }
                let mut polygon = face.corners.to_vec();
                for plane in clipper.faces() {
                    polygon = plane.clipped(&polygon, near);
                }
                volume += area(&polygon, &face.normal) * (face.corners[0] - self.center).dot(&face.normal) / 3.0;
            }
        }
        volume
    }

    fn faces(&self) -> [Face; 6] {
        core::array::from_fn(|i| {
            let [a, b, c] = [0, 1, 2].map(|k| self.half_axes[(i + k) % 3]);
            let out = if i < 3 { a } else { -a };
            let corners = [b + c, c - b, -b - c, b - c].map(|offset| self.center + out + offset);
            let normal = b.cross(&c) * if b.cross(&c).dot(&out) < 0.0 { -1.0 } else { 1.0 };
            Face { corners, normal: normal.try_normalize(0.0).unwrap_or_else(Vector3::zeros) }
        })
    }
}

/// A face of a box.
struct Face {
    corners: [Vector3<f64>; 4],
    /// Points outwards.
    normal: Vector3<f64>,
}

impl Face {
    /// Distance from the plane, positive outside.
    fn height(&self, point: &Vector3<f64>) -> f64 {
        (point - self.corners[0]).dot(&self.normal)
    }

    /// The part of a convex polygon that is not outside (Sutherland and Hodgman). Points at most `near` outside are kept.
    fn clipped(&self, polygon: &[Vector3<f64>], near: f64) -> Vec<Vector3<f64>> {
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for (i, to) in polygon.iter().enumerate() {
            let from = &polygon[if i == 0 { polygon.len() } else { i } - 1];
            let (before, after) = (self.height(from), self.height(to));
            if (before > near) != (after > near) {
                // Both may be a little outside.
                kept.push(from.lerp(to, (before / (before - after)).clamp(0.0, 1.0)));
            }
            if after <= near {
                kept.push(*to);
            }
        }
        kept
    }
}

/// The area of a plane polygon.
fn area(polygon: &[Vector3<f64>], normal: &Vector3<f64>) -> f64 {
    let Some(first) = polygon.first() else { return 0.0 };
    let twice: f64 = polygon.windows(2).map(|edge| (edge[0] - first).cross(&(edge[1] - first)).dot(normal)).sum();
    0.5 * twice.abs()
}
