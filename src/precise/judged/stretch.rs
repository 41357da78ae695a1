//! Stretch: a mesh in the proportions that the image shows.
//!
//! The result of a search is a similarity. What the search fitted beside it, x = s·R·e^E·p + t with a symmetric E of trace 0
//! (see [`searched::proportions`](crate::precise::searched::proportions)), is refined here from that similarity with the
//! freedom that was asked for, and kept. Directions that the image does not determine stay as the mesh has them: the prior
//! of E is centred at 0.

use glam::{DMat3, DVec3};

use crate::geometry::mesh::Mesh;
use crate::geometry::normal_equations::{NormalEquationsOf, PARAMETERS};
use crate::geometry::similarity::Similarity;
use crate::precise::drawn::equivalence::Equivalence;
use crate::precise::drawn::pose::{CropPose, MeshFrame};
use crate::precise::drawn::render::Canvas;
use crate::precise::options::Proportions as Freedom;
use crate::precise::scored::conditioning::{covariance, deviation, fix_roll};
use crate::precise::searched::ascent::{Ascent, ascend};
use crate::precise::searched::proportions::{InProportion, PROPORTIONS, Proportions, Shapes, Stretched};
use crate::precise::searched::recipe::{FINE, FINEST};
use crate::precise::searched::refine::Refiner;
use crate::precise::searched::search::Search;
use crate::report::{Sim3, Stretch};

/// Standard deviation of each parameter of E.
const DEVIATION: f64 = 0.06;
/// Steps of the refinement, by grid.
const STEPS: [(usize, usize); 2] = [(FINE, 12), (FINEST, 12)];
/// Alternating projections, onto the shapes with the symmetry of the mesh and onto those that were asked for: where the axes
/// of both agree, one is enough.
const PROJECTIONS: usize = 16;

/// The best proportions of a mesh near a pose; `None` if they are not asked for, or the size of the mesh is given, so that
/// it is right.
pub fn stretch(search: &Search, mesh: &Mesh, pose: &CropPose, freedom: Freedom) -> Option<Stretch> {
    if freedom == Freedom::Keep || search.settings.lock_scale || search.prior.scale.is_some_and(|[a, b]| a == b) {
        return None;
    }
    let shapes = shapes(&search.equivalence, freedom);
    let mut canvas = Canvas::default();
    let mut at = Stretched { pose: *pose, proportions: Proportions::default() };
    let mut uncertainty = [0.0; 3];
    for (grid, steps) in STEPS {
        let refiner = Refiner { objective: search.objective(grid), lock_scale: false };
        let mut problem = InProportion::new(&refiner, &mut canvas, shapes);
        at = ascend(&mut problem, at, steps).pose;
        let score = problem.score(&at);
        let mut equations = problem.equations(&at, &score);
        let free_axis = search.equivalence.free_axis(at.pose.rotation);
        free_axis.into_iter().for_each(|axis| fix_roll(&mut equations, axis));
        // log s = size + distance; distance is in units of the size.
        let mut of_scale = [0.0; PARAMETERS];
        (of_scale[3], of_scale[6]) = (1.0, libm::exp(at.pose.size));
        uncertainty = deviations_of_lengths(&equations, &of_scale)?;
    }
    let transform = |frame: &MeshFrame| at.pose.similarity(frame);
    Some(report(mesh, &search.mesh.frame, &at.proportions, transform, uncertainty))
}

/// Number of all parameters: those of the pose, and E.
pub const ALL: usize = PARAMETERS + PROPORTIONS;

/// The proportions that a mesh may have, and which are likely.
pub fn shapes(equivalence: &Equivalence, freedom: Freedom) -> Shapes {
    Shapes::new(DEVIATION, free(equivalence, freedom))
}

/// The standard deviations of the logarithms of the lengths along the axes of the mesh, from the quadratic in all parameters.
/// `of_scale` is the change of log s with each parameter of the pose. `None` if the evidence constrains nothing.
pub fn deviations_of_lengths(equations: &NormalEquationsOf<ALL>, of_scale: &[f64; PARAMETERS]) -> Option<[f64; 3]> {
    let covariance = covariance(equations)?;
    Some([0, 1, 2].map(|axis| {
        let change = change_of_length(of_scale, axis);
        let row = |row: &[f64; ALL]| row.iter().zip(&change).map(|(a, b)| a * b).sum::<f64>();
        deviation(covariance.iter().zip(&change).map(|(of_row, by)| by * row(of_row)).sum())
    }))
}

/// The projection to the parameters of E that are free: those of shapes that have the symmetry of the mesh and, for
/// [`Freedom::Axes`], are stretched along its axes only.
fn free(equivalence: &Equivalence, freedom: Freedom) -> [[f64; PROPORTIONS]; PROPORTIONS] {
    let straight = |e: DMat3| DMat3::from_diagonal(DVec3::new(e.x_axis.x, e.y_axis.y, e.z_axis.z));
    let mut free = [[0.0; PROPORTIONS]; PROPORTIONS];
    for k in 0..PROPORTIONS {
        let mut unit = [0.0; PROPORTIONS];
        unit[k] = 1.0;
        let mut e = Proportions::new(unit).exponent();
        for _ in 0..PROJECTIONS {
            e = equivalence.mean(&e);
            if freedom == Freedom::Axes {
                e = straight(e);
            }
        }
        for (row, x) in free.iter_mut().zip(Proportions::of_matrix(&e).parameters()) {
            row[k] = x;
        }
    }
    free
}

/// The change of the logarithm of a length along an axis of the mesh, with each parameter: log s + E_ii.
fn change_of_length(of_scale: &[f64; PARAMETERS], axis: usize) -> [f64; ALL] {
    let mut change = [0.0; ALL];
    change[..PARAMETERS].copy_from_slice(of_scale);
    let mut along = DMat3::ZERO;
    along.col_mut(axis)[axis] = 1.0;
    let third = DMat3::from_diagonal(DVec3::splat(1.0 / 3.0));
    change[PARAMETERS..].copy_from_slice(&Proportions::of_matrix(&(along - third)).parameters());
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
