//! The rotational symmetry of a mesh, found on its surface.
//!
//! A rotation is a symmetry if it moves the surface no farther from itself than scanned and generated meshes are off. A
//! symmetry preserves the moments of the surface. Axes are therefore looked for along the principal axes and, in a plane
//! or in space where the moments are about equal, in all directions.

use core::cell::Cell;
use core::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec3, Vec3};
use nalgebra::Vector3;

use super::searchable;
use crate::error::Result;
use crate::geometry::angle::sin_cos;
use crate::geometry::cloud::outermost;
use crate::geometry::mesh::Mesh;
use crate::geometry::order::quantile;
use crate::geometry::rotations::{exp, fibonacci_sphere};
use crate::geometry::surface::{SurfaceMoments, sample_surface};
use crate::geometry::triangle_tree::TriangleTree;

/// How far a surface and its rotated copy may differ, relative to the box diagonal of the mesh.
struct Tolerance {
    /// Mean distance.
    mean: f64,
    /// 95th percentile of the distances, which detects asymmetric parts of some area.
    tail: f64,
    /// Largest distance of an outermost point, which detects small parts that protrude, such as a stem or a spout.
    protrusion: f64,
}

/// About an axis of revolution: a generated pear counts as round, though its flanks have dents and its stem is askew.
const ROUND: Tolerance = Tolerance { mean: 0.015, tail: 0.04, protrusion: 0.07 };
/// About any other axis. On scanned objects, true symmetries have means of 0.1 to 0.8 %, tails of 0.2 to 2.8 % and protrusions of 0.2
/// to 3.1 %. A bottle turned upside down has 1.8, 6.6 and more; a marker, a banana and a teapot turned end to end have tails of
/// 2.1 to 3 %, but protrusions of 5.8 to 8.6 %.
const OTHER: Tolerance = Tolerance { mean: 0.01, tail: 0.03, protrusion: 0.035 };

/// Number of directions along which points are outermost.
const DIRECTIONS: usize = 100;
/// Numbers of points of the surface that are compared: to find the best of many axes, to reject most, and to accept one.
const SAMPLES: [usize; 3] = [24, 64, 256];
/// Mean distance of few points, in units of [`Tolerance::mean`], up to which an axis is worth adjusting.
const NEAR: f64 = 4.0;
/// Steps by which an axis is adjusted, radians, and the number of times that each is repeated.
const ADJUSTMENTS: [f64; 4] = [0.1, 0.05, 0.02, 0.01];
const REPEATS: usize = 4;
/// Ratio of two principal standard deviations from which on a symmetry may exchange their axes.
const EQUAL: f64 = 0.9;
/// Number of axes tried in a plane, and in space.
const IN_PLANE: usize = 18;
const IN_SPACE: usize = 120;
/// Number of these that are looked at closely.
const LIKELY: usize = 3;
/// Angles of no regular polygon with few sides, in turns; the first finds the axis.
const IRREGULAR: [f64; 6] = [0.37, 0.07, 0.13, 0.19, 0.29, 0.43];
/// Orders of finite symmetries. Prisms with more sides are round within the tolerance.
const FOLDS: [u32; 4] = [6, 5, 4, 3];

/// An axis of symmetry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SymmetryAxis {
    /// Direction in the mesh frame, of any length above 0.
    pub axis: Vector3<f64>,
    /// Order of the rotational symmetry; `None` for a surface of revolution.
    pub fold: Option<u32>,
}

/// The axes whose rotations are symmetries of a mesh, the one of the highest order first. The others are perpendicular to
/// it, so that together they generate a group: that of a pyramid, a prism, a cube, a body of revolution or a sphere.
///
/// # Errors
/// [`DegenerateMesh`](crate::error::ErrorCode::DegenerateMesh) for a mesh without area.
pub fn symmetry_axes(mesh: &Mesh) -> Result<Vec<SymmetryAxis>> {
    let moments = SurfaceMoments::of(mesh);
    let finder = Finder {
        samples: sample_surface(mesh, SAMPLES[2], 0)?.points,
        outermost: outermost(mesh.positions(), DIRECTIONS),
        center: moments.centroid,
        tree: TriangleTree::new(&searchable(mesh)),
        diagonal: mesh.diagonal(),
    };
    let eigen = moments.principal_axes();
    let [thin, middle, wide] = eigen.values.map(|v| v.max(0.0).sqrt());
    let [a, b, c] = eigen.vectors;
    // The axes that may have an order above 2, and those of half turns.
    let (higher, halves) = match (thin > EQUAL * middle, middle > EQUAL * wide) {
        (true, true) => {
            let all: Vec<DVec3> = (0..IN_SPACE).map(|k| fibonacci_sphere(k, 2 * IN_SPACE)).collect();
            (all.clone(), all)
        }
        (true, false) => (vec![c], [vec![c], plane(c)].concat()),
        (false, true) => (vec![a], [vec![a], plane(a)].concat()),
        (false, false) => (Vec::new(), vec![a, b, c]),
    };
    let Some((main, fold)) = finder.main_axis(&higher, &halves) else { return Ok(Vec::new()) };
    // The other principal axes, where they are unique and perpendicular to the first.
    let across = if higher.is_empty() {
        [a, b, c].into_iter().filter(|axis| axis.dot(main).abs() < 0.5).collect()
    } else {
        plane(main)
    };
    let mut axes = vec![declared(main, fold)];
    axes.extend(finder.across(main, fold, &across).map(|(axis, fold)| declared(axis, fold)));
    Ok(axes)
}

fn declared(axis: DVec3, fold: Option<u32>) -> SymmetryAxis {
    SymmetryAxis { axis: Vector3::new(axis.x, axis.y, axis.z), fold }
}

/// Directions across an axis, over half a turn.
fn plane(axis: DVec3) -> Vec<DVec3> {
    let (u, v) = axis.any_orthonormal_pair();
    let angles = (0..IN_PLANE).map(|k| sin_cos(PI * k as f64 / IN_PLANE as f64));
    angles.map(|(sin, cos)| u * cos + v * sin).collect()
}

/// A surface that is compared with its rotated copies.
struct Finder {
    samples: Vec<Vec3>,
    outermost: Vec<Vec3>,
    center: DVec3,
    tree: TriangleTree,
    diagonal: f64,
}

impl Finder {
    /// The axis of the highest order; without an order, an axis of revolution.
    fn main_axis(&self, higher: &[DVec3], halves: &[DVec3]) -> Option<(DVec3, Option<u32>)> {
        if let Some(axis) = self.find(higher, TAU * IRREGULAR[0], &ROUND)
            && IRREGULAR.iter().all(|share| self.maps(axis, TAU * share, &ROUND))
        {
            return Some((axis, None));
        }
        let of_order = |fold: u32| Some((self.find(higher, TAU / f64::from(fold), &OTHER)?, Some(fold)));
        FOLDS.into_iter().find_map(of_order).or_else(|| Some((self.find(halves, PI, &OTHER)?, Some(2))))
    }

    /// The symmetry about an axis across the main one, which has this order.
    fn across(&self, main: DVec3, fold: Option<u32>, directions: &[DVec3]) -> Option<(DVec3, Option<u32>)> {
        let angle = if fold.is_none() { TAU * IRREGULAR[0] } else { FRAC_PI_2 };
        let level = |axis: DVec3| (axis - main * axis.dot(main)).normalize_or(axis);
        // A second axis of revolution is that of a sphere, a second one of order 4 that of a cube.
        if fold.is_none_or(|fold| fold == 4)
            && let Some(axis) = self.find(directions, angle, &OTHER)
        {
            return Some((level(axis), fold));
        }
        self.find(directions, PI, &OTHER).map(|axis| (level(axis), Some(2)))
    }

    /// The direction about which a rotation by `angle` maps the surface onto itself, adjusted.
    fn find(&self, directions: &[DVec3], angle: f64, tolerance: &Tolerance) -> Option<DVec3> {
        let rough = |axis: &DVec3| (self.distance(*axis, angle, SAMPLES[0], f64::INFINITY), *axis);
        let mut scored: Vec<(f64, DVec3)> = directions.iter().map(rough).collect();
        scored.sort_by(|a, b| a.0.total_cmp(&b.0));
        let likely = scored.into_iter().take(LIKELY);
        let mut adjusted = likely.filter_map(|(_, axis)| self.adjusted(axis, angle, NEAR * tolerance.mean));
        adjusted.find(|axis| self.maps(*axis, angle, tolerance))
    }

    /// The axis nearby with the smallest distance; `None` if that is more than `most`.
    fn adjusted(&self, mut axis: DVec3, angle: f64, most: f64) -> Option<DVec3> {
        let mut least = self.distance(axis, angle, SAMPLES[1], most);
        if least > most {
            return None;
        }
        for step in ADJUSTMENTS {
            for _ in 0..REPEATS {
                let (u, v) = axis.any_orthonormal_pair();
                let near = [u, v, -u, -v].map(|side| (axis + side * step).normalize());
                let before = least;
                for tilted in near {
                    let distance = self.distance(tilted, angle, SAMPLES[1], least);
                    if distance < least {
                        (least, axis) = (distance, tilted);
                    }
                }
                if least == before {
                    break;
                }
            }
        }
        Some(axis)
    }

    /// Whether a rotation maps the surface onto itself.
    fn maps(&self, axis: DVec3, angle: f64, tolerance: &Tolerance) -> bool {
        // Twice, so that rounding does not matter.
        let distances = self.distances((&self.samples, 1), axis, angle, 2.0 * tolerance.mean);
        let tail = quantile(distances.iter().copied(), 0.95).map_or(f64::INFINITY, f64::from);
        if mean(&distances) > tolerance.mean * self.diagonal || tail > tolerance.tail * self.diagonal {
            return false;
        }

        let distances = self.distances((&self.outermost, 1), axis, angle, f64::INFINITY);
        distances.iter().all(|distance| f64::from(*distance) <= tolerance.protrusion * self.diagonal)
    }

    /// The mean distance of a number of points from the surface after a rotation, relative to the diagonal; infinite, where
    /// it is more than `most`.
    fn distance(&self, axis: DVec3, angle: f64, count: usize, most: f64) -> f64 {
        // The samples are in the order of the triangles: evenly chosen ones are spread over the surface.
        let step = self.samples.len() / count;
        mean(&self.distances((&self.samples[..count * step], step), axis, angle, most)) / self.diagonal
    }

    /// The distances of every `step`-th point from the surface after a rotation. Those after their mean is beyond `most`, relative
    /// to the diagonal, are infinite, and cost nothing.
    fn distances(&self, (points, step): (&[Vec3], usize), axis: DVec3, angle: f64, most: f64) -> Vec<f32> {
        let turn = exp(axis * angle);
        let count = points.len() / step;
        let sum = Cell::new(0.0);
        let turned = |i: usize| match sum.get() / count as f64 / self.diagonal > most {
            // Not a number is near nothing.
            true => (Vec3::NAN, None),
            false => ((turn * (points[i * step].as_dvec3() - self.center) + self.center).as_vec3(), None),
        };
        let mut distances = Vec::with_capacity(count);
        self.tree.nearest_of_each(count, &turned, &mut |_, nearest| {
            let distance = nearest.map_or(f32::INFINITY, |s| s.distance_squared.sqrt());
            sum.set(sum.get() + f64::from(distance));
            distances.push(distance);
        });
        distances
    }
}

fn mean(distances: &[f32]) -> f64 {
    distances.iter().map(|d| f64::from(*d)).sum::<f64>() / distances.len().max(1) as f64
}
