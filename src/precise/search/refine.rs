//! Refinement: Levenberg-Marquardt over all seven parameters, on quadratic bounds of the terms of the score.
//!
//! The terms of the score are sums of robust losses ρ(e) of a residual e. At the present residuals, each loss is bounded from
//! above by a quadratic with curvature ρ′(e)/e (iteratively reweighted least squares). Three things are approximate: depths
//! are residuals along the normal of the mesh, so that their weight contains its squared cosine; the outline and the
//! overlap move along the gradient of the distance to the observed outline; and normals turn where they are, although a
//! curved surface that turns shows another normal there. The score therefore decides whether a step is accepted.

use glam::Vec3;

use super::ascent::{Ascent, ascend, limited};
use super::ranking::Candidate;
use crate::geometry::normal_equations::{NormalEquations, NormalEquationsOf, PARAMETERS};
use crate::precise::drawing::pose::{CropPose, Step};
use crate::precise::drawing::render::Canvas;
use crate::precise::scoring::objective::Objective;
use crate::precise::scoring::score::{Background, Score, is_outline};

/// The problem of a refinement.
pub struct Refiner<'a> {
    /// The objective to maximise.
    pub objective: Objective<'a>,
    /// Whether the size of the object is fixed, which couples the distance and the size in the image.
    pub lock_scale: bool,
}

/// Minimum magnitude of residuals, in units of their scale, because a loss like |e| has no finite curvature at 0.
const MIN_DEPTH_ERROR: f32 = 0.1;
const MIN_OUTLINE_CELLS: f32 = 0.5;
/// 1/d², where d is the distance in cells beyond which the nearest outline is rarely the correct one.
const FAR_OUTLINE: f32 = 1.0 / 9.0;

/// A refinement on one grid, whose last render is on the canvas.
pub(in crate::precise) struct OnGrid<'a, 'c> {
    pub(super) refiner: &'a Refiner<'a>,
    pub(super) canvas: &'c mut Canvas,
}

impl Ascent for OnGrid<'_, '_> {
    type Pose = CropPose;
    type Score = Score;

    fn allowed(&self, pose: CropPose) -> CropPose {
        self.refiner.objective.prior.bounded(pose)
    }

    fn score(&mut self, pose: &CropPose) -> Score {
        self.refiner.objective.score(self.canvas, pose)
    }

    fn equations(&mut self, pose: &CropPose, score: &Score) -> NormalEquations {
        self.refiner.equations(self.canvas, score, pose)
    }

    fn moved(&self, pose: &CropPose, step: Step) -> Option<CropPose> {
        self.refiner.moved(pose, step)
    }
}

impl Refiner<'_> {
    /// Refines `pose` in at most `iterations` steps.
    pub fn refine(&self, canvas: &mut Canvas, pose: CropPose, iterations: usize) -> Candidate {
        ascend::<PARAMETERS, _>(&mut OnGrid { refiner: self, canvas }, pose, iterations)
    }

    /// A pose after a step, limited to the range in which the quadratic is valid; `None` if it is not finite.
    pub(super) fn moved(&self, pose: &CropPose, mut step: Step) -> Option<CropPose> {
        if self.lock_scale {
            // log s = size + distance.
            step[6] = -step[3] / libm::exp(pose.size);
        }
        let step = limited(step);
        let next = pose.moved(&step);
        let is_finite = step.iter().all(|x| x.is_finite()) && self.objective.prior.bounded(next).is_finite();
        is_finite.then_some(next)
    }

    /// The quadratic at the last render, which is of `pose`.
    pub fn equations(&self, canvas: &Canvas, score: &Score, pose: &CropPose) -> NormalEquations {
        let mut equations = NormalEquations::new();
        let turns = self.evidence(canvas, score, &mut |point, gradient, residual, weight| {
            let jacobian = self.jacobian(canvas, point, gradient).map(f64::from);
            equations.add(&jacobian, f64::from(residual), f64::from(weight));
        });
        turns.add_to(&mut equations);
        self.add_scene_term(&mut equations, pose);
        equations
    }

    /// Adds the quadratic of the scene term, if there is one, at `pose`.
    pub(super) fn add_scene_term(&self, equations: &mut NormalEquations, pose: &CropPose) {
        if let Some(scene) = self.objective.scene {
            scene.add_to(equations, pose, self.lock_scale);
        }
    }

    /// The quadratic of the image at the last render: calls `add` with a surface point x, the change of a residual as x moves,
    /// the residual, and its weight, and returns the part of the normals. Compiled once for all numbers of parameters.
    #[inline(never)]
    pub(super) fn evidence(&self, canvas: &Canvas, score: &Score, add: &mut dyn FnMut(Vec3, Vec3, f32, f32)) -> Turns {
        let (grid, weights) = (self.objective.grid, &self.objective.scoring.weights);
        let factor = weights.factor(score, grid);
        let per_cell = |weight: f32, cells: f32| weight * factor / cells.max(1.0);
        let [depth_cells, normal_cells, outline_cells] = score.counts;
        let depth_weight = per_cell(weights.depth, depth_cells);
        let mut turns = Turns { weight: per_cell(weights.normals, normal_cells), ..Turns::default() };
        let outline_weight = per_cell(weights.outline, outline_cells);
        // The score is a product, so the weight of a cell of overlap includes the other factor.
        let overlap_weight = weights.silhouette * weights.agreement(score) / score.union.max(1.0);
        let per_depth = 1.0 / self.objective.scoring.depth_m;
        let half = self.objective.scoring.outline_cells;
        let wants_outline = outline_weight > 0.0 || overlap_weight > 0.0;
        let unknown_weight = grid.unknown_weight(weights.unknown);
        for (v, row) in canvas.rows(grid) {
            for i in row {
                let u = i - v * grid.width;
                let w = canvas.inverse_depth[i];
                if w <= 0.0 {
                    continue;
                }
                let z = 1.0 / w;
                let point = grid.ray(u as f32, v as f32) * z;
                let observed = grid.depth[i];
                if observed > 0.0 {
                    let mut normal = canvas.rotation * self.objective.model.normals[canvas.triangle[i] as usize];
                    if normal.dot(point) > 0.0 {
                        normal = -normal;
                    }
                    let error = (z - observed) * per_depth;
                    let size = error.abs().max(MIN_DEPTH_ERROR);
                    let curvature = 1.0 / (size * (1.0 + error.abs()) * (1.0 + error.abs()));
                    // Along the normal of the mesh: distance to the tangent plane.
                    let gradient = normal * per_depth;
                    let residual = normal.dot(point) * w * error;
                    add(point, gradient, residual, depth_weight * curvature);
                    let seen = grid.normal_at(i);
                    if seen.z != 0.0 {
                        turns.add(normal, seen);
                    }
                }
                if wants_outline && is_outline(canvas, grid.width, grid.height, u, v) {
                    let mut visible = 1.0;
                    if !grid.mask[i] {
                        match self.objective.scoring.background(grid.scene[i], z) {
                            Background::FreeSpace => {}
                            Background::Occluder => continue,
                            Background::Unknown => visible = unknown_weight,
                        }
                    }
                    let d = grid.outline[i];
                    let slope_u = 0.5 * (grid.outline[i + 1] - grid.outline[i - 1]);
                    let slope_v = 0.5 * (grid.outline[i + grid.width] - grid.outline[i - grid.width]);
                    let q = d / half;
                    let curvature = 2.0 / (half * half * (1.0 + q * q) * (1.0 + q * q));
                    let weight = outline_weight * curvature
                        + overlap_weight / (d.abs().max(MIN_OUTLINE_CELLS) * (1.0 + d * d * FAR_OUTLINE));
                    // ∂(u, v)/∂point of the pinhole.
                    let scale = grid.focal as f32 * w;
                    let along = -(slope_u * point.x + slope_v * point.y) * w;
                    let gradient = Vec3::new(slope_u, slope_v, along) * scale;
                    add(point, gradient, d, visible * weight);
                }
            }
        }
        turns
    }

    /// Root mean square of the depth residuals of the last render, without those beyond three times their scale.
    pub fn depth_rms(&self, canvas: &Canvas) -> f64 {
        let (mut sum, mut count) = (0.0f64, 0u32);
        for (w, observed) in canvas.inverse_depth.iter().zip(&self.objective.grid.depth) {
            let error = 1.0 / w - observed;
            if *w > 0.0 && *observed > 0.0 && error.abs() < 3.0 * self.objective.scoring.depth_m {
                sum += f64::from(error * error);
                count += 1;
            }
        }
        (sum / f64::from(count.max(1))).sqrt()
    }

    /// The change, with each parameter of the pose, of a residual that changes by `gradient`·δx as the surface point moves by
    /// δx.
    #[inline]
    pub(super) fn jacobian(&self, canvas: &Canvas, point: Vec3, gradient: Vec3) -> [f32; PARAMETERS] {
        let arm = point - canvas.translation;
        let turn = arm.cross(gradient);
        let (size, distance) = (arm.dot(gradient), point.dot(gradient));
        let (size, distance) = if self.lock_scale {
            (size - distance, 0.0)
        } else {
            (size, distance * canvas.scale / canvas.translation.z)
        };
        let place = gradient * canvas.scale;
        [turn.x, turn.y, turn.z, size, place.x, place.y, distance]
    }
}

/// Σ ½|n − n′|² over pairs of normals, as a quadratic in the rotation of n only.
#[derive(Default)]
pub(super) struct Turns {
    outer: [[f32; 3]; 3],
    gradient: Vec3,
    count: f32,
    weight: f32,
}

impl Turns {
    #[inline]
    fn add(&mut self, normal: Vec3, seen: Vec3) {
        for (row, x) in self.outer.iter_mut().zip(normal.to_array()) {
            for (entry, y) in row.iter_mut().zip(normal.to_array()) {
                *entry += x * y;
            }
        }
        self.gradient += seen.cross(normal);
        self.count += 1.0;
    }

    /// With JᵀJ = 1 − n nᵀ, and Jᵀr = n′ × n.
    pub(super) fn add_to<const N: usize>(&self, equations: &mut NormalEquationsOf<N>) {
        let weight = self.weight;
        let mut block = self.outer.map(|row| row.map(|x| f64::from(-x * weight)));
        for (i, row) in block.iter_mut().enumerate() {
            row[i] += f64::from(self.count * weight);
        }
        equations.add_block(&block, (self.gradient * weight).to_array().map(f64::from));
    }
}
