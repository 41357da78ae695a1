//! Stretch: a mesh in the proportions that the image shows.
//!
//! The result of a search is a similarity. What the search fitted beside it, x = s·R·e^E·p + t with a symmetric E of trace 0
//! (see [`searched::proportions`](crate::precise::searched::proportions)), is refined here from that similarity with the
//! freedom that was asked for, and kept. Directions that the image does not determine stay as the mesh has them: the prior
//! of E is centred at 0.

use glam::{DMat3, DVec3};

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
pub fn stretch(search: &Search, pose: &CropPose, freedom: Freedom) -> Option<Stretch> {
    if freedom == Freedom::Keep || search.settings.lock_scale || search.prior.scale.is_some_and(|[a, b]| a == b) {
        return None;
    }
    let shapes = Shapes::new(DEVIATION, free(search, freedom));
    let mut canvas = Canvas::default();
    let mut at = Stretched { pose: *pose, proportions: Proportions::default() };
    let mut variances = [0.0; 3];
    for (grid, steps) in STEPS {
        let refiner = Refiner { objective: search.objective(grid), lock_scale: false };
        let mut problem = InProportion::new(&refiner, &mut canvas, shapes);
        at = ascend(&mut problem, at, steps).pose;
        let score = problem.score(&at);
        let mut equations = problem.equations(&at, &score);
        let free_axis = search.equivalence.free_axis(at.pose.rotation);
        free_axis.into_iter().for_each(|axis| fix_roll(&mut equations, axis));
        let covariance = covariance(&equations)?;
        variances = [0, 1, 2].map(|axis| {
            let change = change_of_length(&at.pose, axis);
            let row = |row: &[f64; ALL]| row.iter().zip(&change).map(|(a, b)| a * b).sum::<f64>();
            covariance.iter().zip(&change).map(|(of_row, by)| by * row(of_row)).sum()
        });
    }
    Some(report(&at, &search.mesh.frame, variances.map(deviation)))
}

/// Number of all parameters: those of the pose, and E.
const ALL: usize = 7 + PROPORTIONS;

/// The projection to the parameters of E that are free: those of shapes that have the symmetry of the mesh and, for
/// [`Freedom::Axes`], are stretched along its axes only.
fn free(search: &Search, freedom: Freedom) -> [[f64; PROPORTIONS]; PROPORTIONS] {
    let straight = |e: DMat3| DMat3::from_diagonal(DVec3::new(e.x_axis.x, e.y_axis.y, e.z_axis.z));
    let mut free = [[0.0; PROPORTIONS]; PROPORTIONS];
    for k in 0..PROPORTIONS {
        let mut unit = [0.0; PROPORTIONS];
        unit[k] = 1.0;
        let mut e = Proportions::new(unit).exponent();
        for _ in 0..PROJECTIONS {
            e = search.equivalence.mean(&e);
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
fn change_of_length(pose: &CropPose, axis: usize) -> [f64; ALL] {
    let mut change = [0.0; ALL];
    // log s = size + distance; distance is in units of the size.
    (change[3], change[6]) = (1.0, libm::exp(pose.size));
    let mut along = DMat3::ZERO;
    along.col_mut(axis)[axis] = 1.0;
    let third = DMat3::from_diagonal(DVec3::splat(1.0 / 3.0));
    change[7..].copy_from_slice(&Proportions::of_matrix(&(along - third)).parameters());
    change
}

fn report(at: &Stretched, frame: &MeshFrame, uncertainty: [f64; 3]) -> Stretch {
    let stretch = at.proportions.matrix();
    // x = s·R·S·(p − c) + t in the frame of the mesh.
    let about_origin = MeshFrame { center: stretch * frame.center, ..*frame };
    Stretch {
        camera_from_stretched: Sim3::from(&at.pose.similarity(&about_origin)),
        stretch: stretch.to_cols_array_2d(),
        uncertainty,
    }
}
