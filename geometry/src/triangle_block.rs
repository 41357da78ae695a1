//! Four triangles, whose distances to a point are estimated at once.

use glam::Vec3;
use wide::f32x4;

/// Number of triangles of a block.
pub const BLOCK: usize = 4;

/// How much a triangle's distance may exceed its estimate: relative to the squared distance, and to the squares of the
/// edges and of the distance to a corner. Rounding of the estimate is 10⁻⁶ of the distances; where it puts a point inside a
/// needle outside of it, the distance to the edges exceeds that to the triangle by at most a thousandth of its length.
const TOLERANCE: [f32; 2] = [2e-3, 1e-5];

/// Squared area, in mesh units⁴, below which there is no estimate: products of f32 lose their precision.
const NO_AREA: f32 = 1e-30;

/// The corners of four triangles, by corner and axis.
#[derive(Debug, Clone, Copy)]
pub struct TriangleBlock {
    corners: [[f32x4; 3]; 3],
}

impl TriangleBlock {
    /// The block of four triangles, whose corners are x, y, z and any number.
    pub fn new(triangles: &[[f32x4; 3]; BLOCK]) -> Self {
        let [i, j, k, l] = triangles;
        Self {
            corners: [
                by_axis([i[0], j[0], k[0], l[0]]),
                by_axis([i[1], j[1], k[1], l[1]]),
                by_axis([i[2], j[2], k[2], l[2]]),
            ],
        }
    }

    /// The corners of one of the triangles.
    pub fn triangle(&self, lane: usize) -> [Vec3; 3] {
        let [a, b, c] = &self.corners;
        let corner = |[x, y, z]: &[f32x4; 3]| Vec3::new(x.to_array()[lane], y.to_array()[lane], z.to_array()[lane]);
        [corner(a), corner(b), corner(c)]
    }

    /// A lower bound of each triangle's squared distance to `query`, close to it except for triangles without area.
    /// Negative where there is none.
    #[inline]
    pub fn least_distances(&self, query: &[f32x4; 3]) -> f32x4 {
        let [a, b, c] = &self.corners;
        let (a, b, c) = (minus(*a, *query), minus(*b, *query), minus(*c, *query));
        let (ab, ac, bc) = (minus(b, a), minus(c, a), minus(c, b));
        let (bb, cc, aa) = (dot(ab, ab), dot(ac, ac), dot(a, a));
        let (bc_squared, between) = (dot(bc, bc), dot(ab, ac));
        let (along_ab, along_ac, along_bc) = (-dot(ab, a), -dot(ac, a), -dot(bc, b));
        // The barycentric weights of the projection, times the squared area.
        let area = bb * cc - between * between;
        let weight_b = cc * along_ab - between * along_ac;
        let weight_c = bb * along_ac - between * along_ab;
        let outside =
            weight_b.simd_lt(f32x4::ZERO) | weight_c.simd_lt(f32x4::ZERO) | (weight_b + weight_c).simd_gt(area);
        let normal = cross(ab, ac);
        let height = dot(normal, a);
        let to_plane = height * (height / dot(normal, normal));
        let to_edges = to_segment(a, ab, along_ab, bb)
            .fast_min(to_segment(a, ac, along_ac, cc))
            .fast_min(to_segment(b, bc, along_bc, bc_squared));
        let distance = outside.bitselect(to_edges, to_plane);
        let least = distance * f32x4::splat(1.0 - TOLERANCE[0]) - (aa + bb + cc) * f32x4::splat(TOLERANCE[1]);
        // An overflow of a weight puts no point outside that is inside, where the distance to the plane is a bound. That of
        // a distance is none.
        let is_known = area.simd_gt(f32x4::splat(NO_AREA)) & least.simd_lt(f32x4::splat(f32::MAX));
        is_known.bitselect(least, f32x4::splat(-1.0))
    }
}

/// The coordinates of four points by axis.
#[inline(always)]
pub fn by_axis(points: [f32x4; BLOCK]) -> [f32x4; 3] {
    let [x, y, z, _] = f32x4::transpose(points);
    [x, y, z]
}

/// The squared distance of the origin to segments from `start`.
#[inline(always)]
fn to_segment(start: [f32x4; 3], edge: [f32x4; 3], along: f32x4, length_squared: f32x4) -> f32x4 {
    let share = (along / length_squared).fast_max(f32x4::ZERO).fast_min(f32x4::ONE);
    let along = |axis: usize| start[axis] + edge[axis] * share;
    let nearest = [along(0), along(1), along(2)];
    dot(nearest, nearest)
}

#[inline(always)]
fn minus(a: [f32x4; 3], b: [f32x4; 3]) -> [f32x4; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn dot(a: [f32x4; 3], b: [f32x4; 3]) -> f32x4 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn cross(a: [f32x4; 3], b: [f32x4; 3]) -> [f32x4; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
