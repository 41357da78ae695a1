//! Stretch: a mesh in the proportions that the image shows.
//!
//! The result of a search is a similarity. What the search fitted beside it, x = s·R·e^E·p + t with a symmetric E of trace 0
//! (see [`search::proportions`](crate::precise::search::proportions)), is refined here from that similarity with the
//! freedom that was asked for, and kept. Lengths that it changes by no more than their deviation stay as the
//! similarity has them.

use glam::{DMat3, DVec3};

use crate::geometry::mesh::Mesh;
use crate::geometry::normal_equations::{NormalEquationsOf, PARAMETERS};
use crate::geometry::similarity::Similarity;
use crate::geometry::symmetric_eigen::{SymmetricEigen, outer};
use crate::precise::drawing::equivalence::Equivalence;
use crate::precise::drawing::pose::{CropPose, MeshFrame};
use crate::precise::drawing::render::Canvas;
use crate::precise::options::Proportions as Freedom;
use crate::precise::scoring::conditioning::{covariance, deviation, fix_roll, gradient_of_scale};
use crate::precise::search::ascent::{Ascent, ascend};
use crate::precise::search::problem::Search;
use crate::precise::search::proportions::{InProportion, PROPORTIONS, Proportions, Shapes, Stretched};
use crate::precise::search::ranking::Total;
use crate::precise::search::recipe::{FINE, FINEST};
use crate::precise::search::refine::Refiner;
use crate::report::{Sim3, Stretch};

/// Standard deviation of each parameter of E.
const DEVIATION: f64 = 0.06;
/// The part of the deviations of lengths and stretches that does not follow from the score: the surfaces of generated meshes
/// are a per cent off in shape, which shows as a stretch; and the factor of the other, which counts neither that the residuals
/// of neighbouring pixels are alike, nor that the score has other maxima. From errors of generated, rendered and real objects.
const MIN_SHAPE_SD: f64 = 0.015;
const INFLATION: f64 = 1.5;
/// Grids of the refinement.
pub const GRIDS: [usize; 2] = [FINE, FINEST];
/// Steps of the refinement from the first start, and from each of the others.
pub const STEPS: [usize; 2] = [12, 6];
/// Distances of the other starts in each direction of E, by grid.
pub const REACHES: [[f64; 2]; 2] = [[0.04, 0.02], [0.02, 0.01]];
/// Number of the first parameters of E, which stretch along the axes.
const AXIAL_PARAMETERS: usize = 2;
/// Share of a direction that has to be free.
const MIN_FREE_SHARE: f64 = 0.1;
/// Square of the length below which a direction is no other than those before it.
const MIN_SQUARED_LENGTH: f64 = 1e-6;

/// The best proportions of a mesh near a pose; `None` if they are not asked for, or the size of the mesh is given, so that
/// it is right.
pub fn stretch(search: &Search, mesh: &Mesh, pose: &CropPose, freedom: Freedom) -> Option<Stretch> {
    if freedom == Freedom::Keep || search.settings.lock_scale {
        return None;
    }
    let shapes = shapes(&search.equivalence, freedom);
    let mut canvas = Canvas::default();
    let mut at = Stretched { pose: *pose, proportions: Proportions::default() };
    let mut uncertainty = [0.0; 3];
    for (grid, reaches) in GRIDS.into_iter().zip(REACHES) {
        let refiner = Refiner { objective: search.objective(grid), lock_scale: false };
        let mut problem = InProportion::new(&refiner, &mut canvas, shapes);
        at = climb(&mut problem, at, reaches, &shapes, |at, by| Stretched { proportions: at.proportions.by(by), ..at });
        let score = problem.score(&at);
        let mut equations = problem.equations(&at, &score);
        let free_axis = search.equivalence.free_axis(at.pose.rotation);
        free_axis.into_iter().for_each(|axis| fix_roll(&mut equations, axis));
        let of_scale = gradient_of_scale(&at.pose);
        uncertainty = deviations_of_lengths(&equations, &of_scale, &shapes)?;
        if grid == FINEST {
            let log_scale = |pose: &CropPose| pose.size + pose.distance;
            let growth = log_scale(&at.pose) - log_scale(pose);
            let (kept, proportions) = significant(&equations, &of_scale, &shapes, (growth, &at.proportions))?;
            let start = Stretched { pose: CropPose { size: at.pose.size + kept - growth, ..at.pose }, proportions };
            let refiner = Refiner { lock_scale: true, ..refiner };
            at = ascend(&mut InProportion::new(&refiner, &mut canvas, Shapes::FIXED), start, STEPS[0]).pose;
        }
    }
    let transform = |frame: &MeshFrame| at.pose.similarity(frame);
    Some(report(mesh, &search.mesh.frame, &at.proportions, transform, uncertainty))
}

/// Number of all parameters: those of the pose, and E.
pub const ALL: usize = PARAMETERS + PROPORTIONS;

/// The best of the poses to which refinements lead from `at` and from where it is stretched by some per cent: the score of a
/// stretched mesh has many maxima, because the pose and the stretch make up for each other.
pub fn climb<A: Ascent<ALL>>(
    problem: &mut A,
    at: A::Pose,
    reaches: [f64; 2],
    shapes: &Shapes,
    stretched: impl Fn(A::Pose, [f64; PROPORTIONS]) -> A::Pose,
) -> A::Pose {
    let mut best = ascend(problem, at, STEPS[0]);
    for reach in reaches.into_iter().flat_map(|reach| [reach, -reach]) {
        for k in 0..PROPORTIONS {
            let mut by = [0.0; PROPORTIONS];
            by[k] = reach;
            let by = shapes.free(by);
            if by[k] / reach < MIN_FREE_SHARE {
                continue;
            }
            let candidate = ascend(problem, stretched(best.pose, by), STEPS[1]);
            if candidate.score.total() > best.score.total() {
                best = candidate;
            }
        }
    }
    best.pose
}

/// The proportions that a mesh may have, and which are likely.
pub fn shapes(equivalence: &Equivalence, freedom: Freedom) -> Shapes {
    Shapes::new(DEVIATION, free(equivalence, freedom))
}

/// The standard deviations of the logarithms of the lengths along the axes of the mesh, from the quadratic in all parameters.
/// `of_scale` is the change of log s with each parameter of the pose. `None` if the evidence constrains nothing.
pub fn deviations_of_lengths(
    equations: &NormalEquationsOf<ALL>,
    of_scale: &[f64; PARAMETERS],
    shapes: &Shapes,
) -> Option<[f64; 3]> {
    let covariance = covariance(equations)?;
    let along = |axis| deviation_along(&covariance, &change_of_length(of_scale, axis, shapes));
    Some(DVec3::AXES.map(|axis| libm::hypot(along(axis), MIN_SHAPE_SD)))
}

/// The standard deviation of what changes so with each parameter, without the [`MIN_SHAPE_SD`].
fn deviation_along(covariance: &[[f64; ALL]; ALL], change: &[f64; ALL]) -> f64 {
    let row = |row: &[f64; ALL]| row.iter().zip(change).map(|(a, b)| a * b).sum::<f64>();
    INFLATION * deviation(covariance.iter().zip(change).map(|(of_row, by)| by * row(of_row)).sum())
}

/// The part of a fit that the evidence supports. The fit differs from the similarity by `growth` (of log s) and by the E of
/// `proportions`; changes of length along their principal directions are kept if they exceed their deviation, and dropped
/// otherwise. The [`MIN_SHAPE_SD`] is not added to that deviation: it would drop changes that bring lengths nearer to the truth.
pub fn significant(
    equations: &NormalEquationsOf<ALL>,
    of_scale: &[f64; PARAMETERS],
    shapes: &Shapes,
    (growth, proportions): (f64, &Proportions),
) -> Option<(f64, Proportions)> {
    let covariance = covariance(equations)?;
    let even = |x: f64| DMat3::from_diagonal(DVec3::splat(x));
    let principal = SymmetricEigen::of(proportions.exponent() + even(growth));
    let (mut kept, mut sum) = (DMat3::ZERO, 0.0);
    for (value, axis) in principal.values.into_iter().zip(principal.vectors) {
        if value.abs() > deviation_along(&covariance, &change_of_length(of_scale, axis, shapes)) {
            (kept, sum) = (kept + outer(axis) * value, sum + value);
        }
    }
    let growth = sum / 3.0;
    Some((growth, Proportions::of_matrix(&(kept - even(growth)))))
}

/// Adds to a projection the part of a direction that it does not have.
fn add_direction(free: &mut [[f64; PROPORTIONS]; PROPORTIONS], mut direction: [f64; PROPORTIONS]) {
    let dot = |row: &[f64; PROPORTIONS], x: &[f64; PROPORTIONS]| row.iter().zip(x).map(|(a, b)| a * b).sum::<f64>();
    let known = free.map(|row| dot(&row, &direction));
    direction.iter_mut().zip(known).for_each(|(x, known)| *x -= known);
    let length = dot(&direction, &direction);
    if length > MIN_SQUARED_LENGTH {
        for (row, x) in free.iter_mut().zip(direction) {
            row.iter_mut().zip(direction).for_each(|(entry, y)| *entry += x * y / length);
        }
    }
}

/// The projection to the parameters of E that are free: those of stretches in any direction or, for [`Freedom::Axes`], along
/// the axes of the mesh, averaged over its symmetry. Where the axes of a symmetry are others, the stretches are along those.
fn free(equivalence: &Equivalence, freedom: Freedom) -> [[f64; PROPORTIONS]; PROPORTIONS] {
    let mut free = [[0.0; PROPORTIONS]; PROPORTIONS];
    // All stretches along the axes are combinations of the first two.
    for k in 0..if freedom == Freedom::Axes { AXIAL_PARAMETERS } else { PROPORTIONS } {
        let mut unit = [0.0; PROPORTIONS];
        unit[k] = 1.0;
        let symmetric = equivalence.mean(&Proportions::new(unit).exponent());
        add_direction(&mut free, Proportions::of_matrix(&symmetric).parameters());
    }
    free
}

/// The change of the logarithm of a length in a direction of the mesh, with each parameter: log s + uᵀ·E·u.
fn change_of_length(of_scale: &[f64; PARAMETERS], axis: DVec3, shapes: &Shapes) -> [f64; ALL] {
    let mut change = [0.0; ALL];
    change[..PARAMETERS].copy_from_slice(of_scale);
    let along = outer(axis) - DMat3::from_diagonal(DVec3::splat(1.0 / 3.0));
    change[PARAMETERS..].copy_from_slice(&shapes.free(Proportions::of_matrix(&along).parameters()));
    change
}

/// The report of a mesh with these proportions. `transform` is the similarity of the pose for a mesh in this frame.
pub fn report(
    mesh: &Mesh,
    frame: &MeshFrame,
    proportions: &Proportions,
    transform: impl Fn(&MeshFrame) -> Similarity,
    uncertainty: [f64; 3],
) -> Stretch {
    let stretch = proportions.matrix();
    // x = s·R·S·(p − c) + t in the frame of the mesh.
    let similarity = transform(&MeshFrame { center: stretch * frame.center, ..*frame });
    let points = mesh.positions().iter().map(|p| stretch * p.as_dvec3());
    let (low, high) = points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    Stretch {
        camera_from_stretched: Sim3::from(&similarity),
        stretch: stretch.to_cols_array_2d(),
        size_m: ((high - low) * similarity.scale).to_array(),
        uncertainty,
    }
}
