//! Moves the vertices of a surface around Gaussians onto the sheet that they form, and colours them.

use glam::{Mat3, Vec3};

use super::density::{each_node, kernel, widened_inverse};
use super::lattice::Lattice;
use super::region::Blob;
use sim3align_geometry::surface_colors::Rgb;

/// Rounds of the fit. In the first, vertices come from beside the sheet; the others follow its curvature.
const ROUNDS: usize = 3;

/// Number of Gaussians in the rounds before the last, at most about: these need no precision.
const MAX_COARSE: usize = 60_000;

/// Standard deviation, in spacings, by which Gaussians are widened for their weight at a vertex, and standard deviations
/// that they then reach.
const WIDENING: f32 = 0.7;
const REACH: f32 = 3.0;

/// Thickness, in spacings, that is added to each Gaussian: flatter ones do not count more.
const THICKNESS: f32 = 0.3;

/// Longest step of a vertex in a round, in spacings.
const MAX_STEP: f32 = 1.5;

/// Support of a vertex by Gaussians, as a share of the mean, below which it follows its neighbours.
const LEAST_SUPPORT: f32 = 0.25;

const NONE: u32 = u32::MAX;

/// Share of the mean precision at a vertex that keeps it in place: it hardly moves along a flat sheet.
const DAMPING: f32 = 0.3;

/// Sums over the Gaussians at a vertex.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    /// Gradient and Hessian of half the squared distance to the Gaussians.
    gradient: Vec3,
    hessian: Mat3,
    color: Vec3,
    weight: f32,
}

impl Sums {
    /// The step towards where the distance is smallest.
    fn step(&self) -> Vec3 {
        let Mat3 { x_axis, y_axis, z_axis } = self.hessian;
        let damping = DAMPING / 3.0 * (x_axis.x + y_axis.y + z_axis.z);
        if damping > 0.0 {
            let damped = self.hessian + Mat3::from_diagonal(Vec3::splat(damping));
            (damped.inverse() * -self.gradient).clamp_length_max(MAX_STEP)
        } else {
            Vec3::ZERO
        }
    }
}

/// Moves each vertex to where the weighted sum of squared Mahalanobis distances to the Gaussians around it is smallest: flat
/// Gaussians are planes there, which meet in edges and corners, and round ones points. Returns the colours of the vertices.
pub(super) fn fit(lattice: &Lattice, blobs: &[Blob], vertices: &mut [Vec3], triangles: &[[u32; 3]]) -> Vec<Rgb> {
    let mut sums = vec![Sums::default(); vertices.len()];
    // The vertices nearest to each node, as lists.
    let mut first_of = vec![NONE; lattice.len()];
    let mut next_of = vec![NONE; vertices.len()];
    for round in 1..=ROUNDS {
        first_of.fill(NONE);
        for (i, vertex) in vertices.iter().enumerate() {
            let node = lattice.nearest(*vertex);
            next_of[i] = first_of[node];
            first_of[node] = i as u32;
        }
        sums.fill(Sums::default());
        let stride = if round == ROUNDS { 1 } else { blobs.len().div_ceil(MAX_COARSE).max(1) };
        for blob in blobs.iter().step_by(stride) {
            let near = widened_inverse(&blob.covariance, WIDENING);
            let precision = widened_inverse(&blob.covariance, THICKNESS);
            let color = Vec3::from_array(blob.color.map(f32::from));
            // A vertex is up to √3 / 2 from its node.
            each_node(lattice, blob.center, &near, REACH + 0.87 / WIDENING, |node, _| {
                let mut vertex = first_of[node];
                while let Some(&position) = vertices.get(vertex as usize) {
                    let i = vertex as usize;
                    let from_center = position - blob.center;
                    let weight = blob.opacity * kernel(from_center.dot(near * from_center), REACH);
                    if weight > 0.0 {
                        let sums = &mut sums[i];
                        let weighted = precision * weight;
                        sums.gradient += weighted * from_center;
                        sums.hessian += weighted;
                        sums.color += color * weight;
                        sums.weight += weight;
                    }
                    vertex = next_of[i];
                }
            });
        }
        vertices.iter_mut().zip(&sums).for_each(|(vertex, sums)| *vertex += sums.step());
        settle(vertices, &mut sums, triangles);
    }
    let color = |sums: &Sums| (sums.color / sums.weight.max(f32::MIN_POSITIVE)).to_array().map(|x| (x + 0.5) as u8);
    sums.iter().map(color).collect()
}

/// Moves vertices with little support, over closed holes and at single Gaussians beside the sheet, to the mean of their
/// neighbours, and gives them the colours of these.
fn settle(vertices: &mut [Vec3], sums: &mut [Sums], triangles: &[[u32; 3]]) {
    let total: f64 = sums.iter().map(|sums| f64::from(sums.weight)).sum();
    let least = LEAST_SUPPORT * (total / sums.len() as f64) as f32;
    let mut around = vec![(Vec3::ZERO, 0.0, Sums::default()); vertices.len()];
    for &[a, b, c] in triangles {
        for (of, others) in [(a, [b, c]), (b, [c, a]), (c, [a, b])].map(|(of, others)| (of as usize, others)) {
            if sums[of].weight < least {
                let (positions, count, colors) = &mut around[of];
                for other in others.map(|other| other as usize) {
                    *positions += vertices[other];
                    *count += 1.0;
                    colors.color += sums[other].color;
                    colors.weight += sums[other].weight;
                }
            }
        }
    }
    for ((vertex, sums), (positions, count, colors)) in vertices.iter_mut().zip(sums).zip(around) {
        if count > 0.0 {
            (*vertex, *sums) = (positions / count, colors);
        }
    }
}
