//! Clipping of triangles in camera space, before projection.

use glam::DVec3;

use super::pinhole::Pinhole;

/// Half the width of the guard band, in pixels: the largest distance of a projected vertex from the image origin.
/// With 8 sub-pixel bits this is 2²⁹ units, and twice the area of any triangle inside fits into 61 bits.
pub const GUARD_BAND_PX: f64 = (1 << 21) as f64;

/// A triangle cut by five planes has at most eight corners.
pub const MAX_CORNERS: usize = 8;

/// The region that can be projected: beyond the near plane and within the guard band.
#[derive(Debug, Clone, Copy)]
pub struct ClipVolume {
    /// Inward (unnormalised) normals and offsets: p is inside if n·p ≥ offset for every plane.
    planes: [(DVec3, f64); 5],
}

impl ClipVolume {
    /// The clip volume of a camera whose near plane is at depth `near`.
    pub fn new(camera: &Pinhole, near: f64) -> Self {
        let Pinhole { fx, fy, cx, cy } = *camera;
        let side = |x: f64, y: f64, z: f64| (DVec3::new(x, y, z), 0.0);
        Self {
            planes: [
                (DVec3::Z, near),
                side(fx, 0.0, GUARD_BAND_PX + cx),
                side(-fx, 0.0, GUARD_BAND_PX - cx),
                side(0.0, fy, GUARD_BAND_PX + cy),
                side(0.0, -fy, GUARD_BAND_PX - cy),
            ],
        }
    }

    /// The part of a triangle inside the volume, a convex polygon: its corners are the first `n` entries of the array.
    ///
    /// Intersections are computed from the inside corner to the outside one, whatever the direction of the edge, so
    /// that two triangles that share an edge get the same bits for it and no crack opens between them (Sutherland and
    /// Hodgman 1974).
    pub fn clip(&self, triangle: [DVec3; 3]) -> ([DVec3; MAX_CORNERS], usize) {
        let mut polygon = [DVec3::ZERO; MAX_CORNERS];
        polygon[..3].copy_from_slice(&triangle);
        let mut count = 3;
        for (normal, offset) in self.planes {
            let height = |p: DVec3| normal.dot(p) - offset;
            let (before, n) = (polygon, count);
            count = 0;
            let mut push = |p: DVec3| {
                // Rounding can make a sliver cross a plane more than twice. Such excess corners are dropped.
                if count < MAX_CORNERS {
                    polygon[count] = p;
                    count += 1;
                }
            };
            for i in 0..n {
                let (a, b) = (before[i], before[(i + 1) % n]);
                let (ha, hb) = (height(a), height(b));
                if ha >= 0.0 {
                    push(a);
                }
                if (ha >= 0.0) != (hb >= 0.0) {
                    let (inside, outside, hi, ho) = if ha >= 0.0 { (a, b, ha, hb) } else { (b, a, hb, ha) };
                    push(inside + (outside - inside) * (hi / (hi - ho)));
                }
            }
        }
        (polygon, count)
    }
}
