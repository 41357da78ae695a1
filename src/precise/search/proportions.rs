//! Proportions: what a generative model gets wrong of the shape of an object as a whole.
//!
//! Such a mesh is often some percent too wide, too flat or skewed, which no similarity undoes. A similarity fitted to the
//! image then matches the width or the height, whichever explains more of the outline, although the best one for the whole
//! mesh is between them. The proportions are therefore fitted as well, x = s·R·e^E·p + t with a symmetric E of trace 0, and
//! the result is the similarity that is nearest to this map over the whole surface.

use glam::{DMat3, DVec3, Mat3, Vec3};

use super::ascent::{Ascent, ascend};
use super::ranking::Candidate;
use super::refine::{OnGrid, Refiner};
use crate::geometry::normal_equations::{NormalEquations, NormalEquationsOf, PARAMETERS};
use crate::geometry::rotations::exp;
use crate::geometry::surface::SurfaceMoments;
use crate::precise::drawing::pose::{CropPose, Step};
use crate::precise::drawing::render::Canvas;
use crate::precise::scoring::conditioning::{Covariance, DROP, covariance, fix_roll};
use crate::precise::scoring::score::Score;

/// Number of parameters of E.
pub const PROPORTIONS: usize = 5;
/// Number of all parameters.
const ALL_PARAMETERS: usize = PARAMETERS + PROPORTIONS;

/// Standard deviation of each parameter. From 0.02 to 0.1, the errors of the similarity on generated cases are about the same.
const DEVIATION: f64 = 0.03;
/// Maximum magnitude of a parameter.
const MAX_PROPORTION: f64 = 0.25;
/// Iterations that find the nearest similarity: each squares the relative error, which starts at the size of E.
const ITERATIONS: usize = 4;
/// Regularisation of the nearest rotation, relative to the trace: a line leaves its roll open.
const ROLL: f64 = 1e-9;

/// Change of a parameter by which derivatives are measured.
const DERIVATIVE_STEP: f64 = 1e-4;

/// 1/√2 and 1/√6: the parameters are coordinates in an orthonormal basis, so that the squares of all entries of E add up to
/// those of the parameters, whatever the axes of the mesh are.
const ROOT_HALF: f64 = core::f64::consts::FRAC_1_SQRT_2;
const ROOT_SIXTH: f64 = 0.408_248_290_463_863;

/// The admissible E, and their costs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shapes {
    /// Score per square of E: [`DROP`] at one standard deviation.
    cost: f64,
    /// The projection to the parameters that are free; all, if `None`.
    free: Option<[[f64; PROPORTIONS]; PROPORTIONS]>,
}

impl Default for Shapes {
    fn default() -> Self {
        Self { cost: DROP / (DEVIATION * DEVIATION), free: None }
    }
}

impl Shapes {
    /// Those of which `free` is the projection to the free parameters, with this standard deviation.
    pub fn new(deviation: f64, free: [[f64; PROPORTIONS]; PROPORTIONS]) -> Self {
        Self { cost: DROP / (deviation * deviation), free: Some(free) }
    }

    /// All, which are equally likely: the prior is that of a sum.
    pub const ANY: Self = Self { cost: 0.0, free: None };
    /// The one that a mesh has.
    pub const FIXED: Self = Self { cost: 0.0, free: Some([[0.0; PROPORTIONS]; PROPORTIONS]) };

    /// The penalty on the score.
    pub fn cost(&self, Proportions(parameters): &Proportions) -> f64 {
        self.cost * parameters.iter().map(|x| x * x).sum::<f64>()
    }

    /// Adds the quadratic of the penalty. It keeps at 0 the parameters that are not free, on which no residual depends.
    pub fn add_to(&self, Proportions(parameters): &Proportions, equations: &mut NormalEquationsOf<ALL_PARAMETERS>) {
        for (i, x) in parameters.iter().enumerate() {
            let mut jacobian = [0.0; ALL_PARAMETERS];
            jacobian[PARAMETERS + i] = 1.0;
            equations.add(&jacobian, *x, 2.0 * self.cost);
        }
    }

    /// The free part of parameters, or of a change with them.
    pub fn free(&self, parameters: [f64; PROPORTIONS]) -> [f64; PROPORTIONS] {
        let dot = |row: [f64; PROPORTIONS]| row.iter().zip(&parameters).map(|(a, b)| a * b).sum();
        self.free.as_ref().map_or(parameters, |free| free.map(dot))
    }
}

/// The parameters of E.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Proportions([f64; PROPORTIONS]);

impl Proportions {
    /// Coordinates of E in an orthonormal basis of the symmetric matrices of trace 0.
    pub fn new(parameters: [f64; PROPORTIONS]) -> Self {
        Self(parameters)
    }

    /// Its parameters.
    pub fn parameters(&self) -> [f64; PROPORTIONS] {
        self.0
    }

    /// The proportions after a step in all parameters, of which theirs are the last.
    pub fn moved(self, step: &[f64; ALL_PARAMETERS]) -> Self {
        let mut by = [0.0; PROPORTIONS];
        by.copy_from_slice(&step[PARAMETERS..]);
        self.by(by)
    }

    /// The proportions after a change of the parameters.
    pub fn by(mut self, change: [f64; PROPORTIONS]) -> Self {
        for (x, by) in self.0.iter_mut().zip(change) {
            *x = (*x + by).clamp(-MAX_PROPORTION, MAX_PROPORTION);
        }
        self
    }

    /// e^E, in the frame of the mesh.
    pub fn matrix(&self) -> DMat3 {
        let e = self.exponent();
        // Terms of fourth order are below 1e-5 if E is 10 %.
        DMat3::IDENTITY + e + e * e * 0.5 + e * e * e * (1.0 / 6.0)
    }

    /// The change of a residual with each parameter, where it changes by `gradient`·δp as the point `p` moves by δp, both in
    /// the frame of the mesh.
    pub fn jacobian(p: Vec3, gradient: Vec3) -> [f32; PROPORTIONS] {
        let (half, sixth) = (ROOT_HALF as f32, ROOT_SIXTH as f32);
        let straight = p * gradient;
        [
            half * (straight.x - straight.y),
            sixth * (straight.x + straight.y - 2.0 * straight.z),
            half * (p.x * gradient.y + p.y * gradient.x),
            half * (p.x * gradient.z + p.z * gradient.x),
            half * (p.y * gradient.z + p.z * gradient.y),
        ]
    }

    /// The parameters of a symmetric E of trace 0.
    pub fn of_matrix(e: &DMat3) -> Self {
        let (straight, sum) = (e.x_axis.x - e.y_axis.y, e.x_axis.x + e.y_axis.y - 2.0 * e.z_axis.z);
        let across = [e.x_axis.y, e.x_axis.z, e.y_axis.z].map(|x| x / ROOT_HALF);
        Self([ROOT_HALF * straight, ROOT_SIXTH * sum, across[0], across[1], across[2]])
    }

    /// E.
    pub fn exponent(&self) -> DMat3 {
        let [a, b, xy, xz, yz] = self.0;
        let (a, b) = (ROOT_HALF * a, ROOT_SIXTH * b);
        let [xy, xz, yz] = [xy, xz, yz].map(|x| ROOT_HALF * x);
        DMat3::from_cols_array(&[a + b, xy, xz, xy, b - a, yz, xz, yz, -2.0 * b])
    }
}

/// A pose of a mesh with other proportions.
#[derive(Debug, Clone, Copy)]
pub struct Stretched {
    /// R, s and t.
    pub pose: CropPose,
    /// E.
    pub proportions: Proportions,
}

impl Stretched {
    /// The similarity that moves the points of the surface least, in the mean of squares, from where this map has them.
    /// With a locked scale, only its rotation and translation are free.
    pub fn nearest(&self, surface: &SurfaceMoments, lock_scale: bool) -> CropPose {
        let (scale, translation) = self.pose.scale_translation();
        let linear = DMat3::from_quat(self.pose.rotation) * self.proportions.matrix() * scale;
        let (mut rotation, mut nearest) = (self.pose.rotation, scale);
        let trace = |m: &DMat3| m.x_axis.x + m.y_axis.y + m.z_axis.z;
        let spread = trace(&surface.covariance);
        for _ in 0..ITERATIONS {
            // Newton's method on Σ|s·R·q − A·q|², whose best R does not depend on s: ω from the skew part of Rᵀ·A·Σqqᵀ, with
            // the symmetric part as its quadratic, and s from the trace.
            let moved = DMat3::from_quat(rotation).transpose() * linear * surface.covariance;
            if !lock_scale && spread > 0.0 {
                nearest = trace(&moved) / spread;
            }
            let turn = DVec3::new(
                moved.y_axis.z - moved.z_axis.y,
                moved.z_axis.x - moved.x_axis.z,
                moved.x_axis.y - moved.y_axis.x,
            );
            let even = (moved + moved.transpose()) * 0.5;
            let inertia = DMat3::from_diagonal(DVec3::splat((1.0 + ROLL) * trace(&even))) - even;
            let turn = inertia.inverse() * turn;
            if !turn.is_finite() {
                break;
            }
            rotation = (rotation * exp(turn)).normalize();
        }
        let center = surface.centroid;
        CropPose::new(rotation, nearest, linear * center + translation - rotation * center * nearest)
    }
}

/// A refinement of a pose and of the proportions on one grid.
pub(crate) struct InProportion<'a, 'c> {
    on: OnGrid<'a, 'c>,
    shapes: Shapes,
}

impl Ascent<ALL_PARAMETERS> for InProportion<'_, '_> {
    type Pose = Stretched;
    type Score = Score;

    fn allowed(&self, at: Stretched) -> Stretched {
        Stretched { pose: self.on.refiner.objective.prior.bounded(at.pose), ..at }
    }

    fn score(&mut self, at: &Stretched) -> Score {
        let stretch = at.proportions.matrix().as_mat3();
        let mut score = self.on.refiner.objective.score_stretched(self.on.canvas, &at.pose, &stretch);
        score.total -= self.shapes.cost(&at.proportions) as f32;
        score
    }

    fn equations(&mut self, at: &Stretched, score: &Score) -> NormalEquationsOf<ALL_PARAMETERS> {
        let refiner = self.on.refiner;
        let canvas = &*self.on.canvas;
        let to_mesh: Mat3 = canvas.rotation.transpose();
        let mut equations = NormalEquationsOf::new();
        let turns = refiner.evidence(canvas, score, &mut |point, gradient, residual, weight| {
            let mut jacobian = [0.0; ALL_PARAMETERS];
            let arm = to_mesh * (point - canvas.translation);
            let of_pose = refiner.jacobian(canvas, point, gradient);
            let of_proportions = Proportions::jacobian(arm, to_mesh * gradient).map(f64::from);
            let of_proportions = self.shapes.free(of_proportions);
            for (to, from) in jacobian.iter_mut().zip(of_pose.map(f64::from).iter().chain(&of_proportions)) {
                *to = *from;
            }
            equations.add(&jacobian, f64::from(residual), f64::from(weight));
        });
        turns.add_to(&mut equations);
        let mut of_scene = NormalEquations::new();
        refiner.add_scene_term(&mut of_scene, &at.pose);
        equations.add_first(&of_scene);
        self.shapes.add_to(&at.proportions, &mut equations);
        equations
    }

    fn moved(&self, at: &Stretched, step: [f64; ALL_PARAMETERS]) -> Option<Stretched> {
        let mut first: Step = [0.0; PARAMETERS];
        first.copy_from_slice(&step[..PARAMETERS]);
        let pose = self.on.refiner.moved(&at.pose, first)?;
        Some(Stretched { pose, proportions: at.proportions.moved(&step) })
    }
}

impl<'a, 'c> InProportion<'a, 'c> {
    pub(crate) fn new(refiner: &'a Refiner<'a>, canvas: &'c mut Canvas, shapes: Shapes) -> Self {
        Self { on: OnGrid { refiner, canvas }, shapes }
    }
}

impl Refiner<'_> {
    /// The covariance of the similarity that [`Refiner::refine_in_proportion`] results in, at the last render, which was of
    /// `pose`: the proportions are free within their prior, or those of the mesh if `is_exact`. The roll about `free_axis`
    /// (camera frame) is fixed. `None` if the image constrains nothing.
    pub fn covariance(
        &self,
        canvas: &mut Canvas,
        score: &Score,
        pose: &CropPose,
        (surface, is_exact): (&SurfaceMoments, bool),
        free_axis: Option<DVec3>,
    ) -> Option<Covariance> {
        if is_exact {
            let mut equations = self.equations(canvas, score, pose);
            free_axis.into_iter().for_each(|axis| fix_roll(&mut equations, axis));
            return covariance(&equations);
        }
        let stretched = |proportions| Stretched { pose: *pose, proportions };
        let at = stretched(Proportions::default());
        let mut equations = InProportion::new(self, canvas, Shapes::default()).equations(&at, score);
        free_axis.into_iter().for_each(|axis| fix_roll(&mut equations, axis));
        let of_all = covariance(&equations)?;
        // The change of the nearest similarity with each parameter.
        let mut changes = [[0.0; PARAMETERS]; ALL_PARAMETERS];
        for (k, change) in changes.iter_mut().enumerate() {
            match k.checked_sub(PARAMETERS) {
                None => change[k] = 1.0,
                Some(k) => {
                    let mut parameters = [0.0; PROPORTIONS];
                    parameters[k] = DERIVATIVE_STEP;
                    let nearest = stretched(Proportions(parameters)).nearest(surface, false);
                    *change = pose.step_to(&nearest).map(|x| x / DERIVATIVE_STEP);
                }
            }
        }
        let mut of_pose = [[0.0; PARAMETERS]; PARAMETERS];
        for (row, from) in of_all.iter().zip(&changes) {
            for (variance, to) in row.iter().zip(&changes) {
                for (entries, x) in of_pose.iter_mut().zip(from) {
                    entries.iter_mut().zip(to).for_each(|(entry, y)| *entry += x * y * variance);
                }
            }
        }
        Some(of_pose)
    }

    /// Refines `pose` and the proportions of a mesh with this `surface` in at most `iterations` steps. The pose of the result
    /// is the nearest similarity; its score is that of the mesh in its best proportions, minus their penalty. If the scale is
    /// locked, the mesh is that of the object itself, and its proportions are right.
    pub fn refine_in_proportion(
        &self,
        canvas: &mut Canvas,
        pose: CropPose,
        iterations: usize,
        surface: &SurfaceMoments,
    ) -> Candidate {
        if self.lock_scale {
            return self.refine(canvas, pose, iterations);
        }
        let start = Stretched { pose, proportions: Proportions::default() };
        let Candidate { pose, score, renders, converged } =
            ascend(&mut InProportion::new(self, canvas, Shapes::default()), start, iterations);
        // At a bound of the scale, it stays there.
        let is_at_bound = self.objective.prior.is_at_bound(&pose.pose);
        let nearest = self.objective.prior.bounded(pose.nearest(surface, is_at_bound));
        Candidate { pose: if nearest.is_finite() { nearest } else { pose.pose }, score, renders, converged }
    }
}
