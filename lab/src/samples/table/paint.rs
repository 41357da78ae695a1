//! The colours of the objects, the table and the wall: linear albedos.

use crate::prelude::*;

/// What an object is painted with.
#[derive(Debug, Clone, Copy)]
pub enum Paint {
    /// One glaze, with a pale band below the lid.
    Glazed,
    /// White, with stripes and a row of dots.
    Striped,
    /// Printed cardboard: panels of colour, no two sides alike.
    Carton,
}

/// Weights of the second and third corner, of points that fill the part of a triangle around its first corner.
const NEAR_A_CORNER: [[f64; 2]; 6] =
    [[0.08, 0.08], [0.25, 0.08], [0.08, 0.25], [0.42, 0.08], [0.25, 0.25], [0.08, 0.42]];

const fn linear(red: f64, green: f64, blue: f64) -> Vector3<f64> {
    Vector3::new(red, green, blue)
}

impl Paint {
    /// The albedo at a place in the object's frame (metres, z up), whose bounding box has these corners.
    pub fn at(self, place: &Vector3<f64>, [low, high]: &[Vector3<f64>; 2]) -> Vector3<f64> {
        let share = (place - low).component_div(&(high - low));
        match self {
            Self::Glazed => match share.z {
                z if (0.6..0.68).contains(&z) => linear(0.78, 0.7, 0.52),
                z if z > 0.93 => linear(0.5, 0.22, 0.06),
                _ => linear(0.03, 0.2, 0.19),
            },
            Self::Striped => {
                let around = libm::atan2(place.y, place.x) / TAU * 14.0;
                let across = (around - around.floor() - 0.5).abs();
                match share.z {
                    z if (0.16..0.24).contains(&z) || (0.72..0.8).contains(&z) => linear(0.05, 0.13, 0.42),
                    z if (z - 0.48).abs() < 0.09 && across < 0.26 => linear(0.72, 0.16, 0.07),
                    _ => linear(0.8, 0.78, 0.72),
                }
            }
            Self::Carton => carton(place, &share, low, high),
        }
    }

    /// The albedo of each vertex of a mesh in the object's frame: the mean of the triangles around it, up to half-way to
    /// their other corners. The albedo of the vertex itself would give edges the teeth of the triangles.
    pub fn of_vertices(self, mesh: &Mesh, size: &[Vector3<f64>; 2]) -> Vec<Vector3<f64>> {
        let mut sums = vec![(Vector3::zeros(), 0.0); mesh.positions().len()];
        for &triangle in mesh.triangles() {
            let corners = mesh.corners(triangle).map(vector3);
            let area = (corners[1] - corners[0]).cross(&(corners[2] - corners[0])).norm();
            for k in 0..3 {
                let [own, second, third] = [0, 1, 2].map(|j| corners[(k + j) % 3]);
                let mean = NEAR_A_CORNER
                    .map(|[b, c]| self.at(&(own + (second - own) * b + (third - own) * c), size))
                    .iter()
                    .sum::<Vector3<f64>>()
                    / NEAR_A_CORNER.len() as f64;
                let (sum, weight) = &mut sums[triangle[k] as usize];
                *sum += mean * area;
                *weight += area;
            }
        }
        sums.into_iter().map(|(sum, weight)| sum / f64::max(weight, f64::MIN_POSITIVE)).collect()
    }

    /// How much the surface mirrors the light.
    pub fn gloss(self) -> f64 {
        match self {
            Self::Glazed => 0.5,
            Self::Striped => 0.35,
            Self::Carton => 0.05,
        }
    }
}

/// A box that is wide along x: a disc on its front, a panel on its back, bars on its narrow sides.
fn carton(place: &Vector3<f64>, share: &Vector3<f64>, low: &Vector3<f64>, high: &Vector3<f64>) -> Vector3<f64> {
    let (base, dark, pale) = (linear(0.85, 0.36, 0.05), linear(0.16, 0.03, 0.03), linear(0.86, 0.8, 0.62));
    let centre = 0.5 * (low + high);
    let offset = place - centre;
    let half = 0.5 * (high - low);
    let is_front = offset.y < 0.0;
    let radius = libm::hypot(offset.x, offset.z - 0.22 * half.z) / half.x;
    // The sides are told by where the place is, since vertices of edges belong to two.
    if offset.x.abs() / half.x > 0.97 {
        return if (share.z * 9.0) as i64 % 2 == 0 { pale } else { base };
    }
    if share.z > 0.985 {
        return dark;
    }
    match (is_front, radius) {
        (true, r) if r < 0.5 => pale,
        (true, r) if r < 0.62 => dark,
        _ if is_front && share.z < 0.26 && share.z > 0.1 => dark,
        _ if !is_front && share.z > 0.35 && share.z < 0.8 && share.x > 0.15 && share.x < 0.85 => pale,
        _ => base,
    }
}

/// A table of oak boards.
pub fn table(point: &Vector3<f64>) -> Vector3<f64> {
    let board = (point.y + 10.0) / 0.11;
    let within = board - board.floor();
    let tone = 0.86 + 0.14 * libm::sin(board.floor() * 2.4);
    let bend = 0.006 * libm::sin(9.0 * point.x + 1.7 * board.floor());
    let grain = libm::sin((point.y + bend) * 900.0 + 3.0 * libm::sin(point.x * 5.0 + board.floor()));
    let seam = if within < 0.018 { 0.55 } else { 1.0 };
    linear(0.5, 0.33, 0.19) * (tone * seam * (1.0 + 0.045 * grain))
}

/// A painted wall, darker towards its top.
pub fn wall(point: &Vector3<f64>) -> Vector3<f64> {
    linear(0.42, 0.5, 0.53) * (1.0 - 0.35 * point.z.clamp(0.0, 1.0))
}
