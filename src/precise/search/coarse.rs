//! Coarse search: every rotation of the grid, with size, position and distance in closed form.

use glam::{DMat3, DQuat, DVec2, Vec3};
use wide::f32x4;

use super::ranking::Candidate;
use crate::geometry::order::median_of_positive;
use crate::precise::drawing::lanes::{LANES, first, four};
use crate::precise::drawing::pose::CropPose;
use crate::precise::drawing::render::Canvas;
use crate::precise::observation::box_fits::BoxFit;
use crate::precise::observation::grid::CropGrid;
use crate::precise::scoring::objective::Objective;

/// Iterations of the fit of a perspective box; each gains an order of magnitude.
const BOX_ROUNDS: usize = 3;

/// The search over rotations on one grid.
pub struct Coarse<'a> {
    /// The objective.
    pub objective: Objective<'a>,
    /// Median depth of the object, metres.
    pub median_m: f64,
}

impl Coarse<'_> {
    /// All poses of a rotation, one per anchor.
    pub fn try_box_fits(
        &self,
        canvas: &mut Canvas,
        outermost: &[Vec3],
        rotation: DQuat,
        box_fits: &[BoxFit],
        candidates: &mut Vec<Candidate>,
    ) {
        let (fitted, sides) = self.fit_box(outermost, rotation);
        let [[left, right], [top, bottom]] = self.objective.grid.bounds;
        let seen = DVec2::new(right - left, bottom - top) / self.objective.grid.focal;
        for anchor in box_fits {
            let zoom = anchor.zoom * anchor.along.map_or(1.0, |axis| seen[axis] / sides[axis]);
            // The side of the box opposite to the cut is where that of the mask is.
            let room = (0.5 * (sides * zoom - seen)).max(DVec2::ZERO);
            let pose = CropPose {
                size: fitted.size + libm::log(zoom),
                place: fitted.place + room * DVec2::from(anchor.towards),
                ..fitted
            };
            candidates.push(self.at_its_distance(canvas, pose));
        }
    }

    /// Renders a pose once, and moves it to the distance that fits the depths; the silhouette does not change.
    pub fn at_its_distance(&self, canvas: &mut Canvas, pose: CropPose) -> Candidate {
        let Objective { model, grid, scoring, prior, equivalence, scene } = &self.objective;
        canvas.draw(model, &pose, grid);
        let ratios = ratios(canvas, grid);
        let stretch = median_of_positive(&ratios).unwrap_or(1.0);
        canvas.ratios = ratios;
        let distant = CropPose { distance: pose.distance + libm::log(f64::from(stretch)), ..pose };
        let pose = prior.bounded(distant);
        // Unlike the silhouette, the scene term depends on the distance.
        if (pose.size - distant.size).abs() > 1e-3 || scene.is_some() {
            return Candidate::of(pose, self.objective.score(canvas, &pose));
        }
        let mut score = scoring.score(canvas, model, grid, stretch);
        score.total += prior.score(&pose, equivalence);
        Candidate::of(pose, score)
    }

    /// Size and position at which the perspective box of the rotated mesh matches that of the mask: equal centres,
    /// equal geometric means of the sides; and the sides of the box of the mesh, as tangents of the angle.
    fn fit_box(&self, outermost: &[Vec3], rotation: DQuat) -> (CropPose, DVec2) {
        let turn = DMat3::from_quat(rotation).as_mat3();
        let turned: Vec<Vec3> = outermost.iter().map(|p| turn * *p).collect();
        let [[left, right], [top, bottom]] = self.objective.grid.bounds;
        let to_ray =
            |u: f64, v: f64| (DVec2::new(u, v) - DVec2::from(self.objective.grid.center)) / self.objective.grid.focal;
        let (low, high) = (to_ray(left, top), to_ray(right, bottom));
        let (wanted_middle, wanted) = (0.5 * (low + high), high - low);
        let (mut size, mut place, mut sides) = (wanted.max_element(), wanted_middle, wanted);
        for _ in 0..BOX_ROUNDS {
            let (scale, offset) = (size as f32, place.as_vec2());
            let (mut low, mut high) = (glam::Vec2::INFINITY, glam::Vec2::NEG_INFINITY);
            for p in &turned {
                let depth = (1.0 + scale * p.z).max(0.2);
                let at = (p.truncate() * scale + offset) / depth;
                (low, high) = (low.min(at), high.max(at));
            }
            let (low, high) = (low.as_dvec2(), high.as_dvec2());
            let drawn = (high - low).max(DVec2::splat(1e-9));
            let ratio = wanted / drawn;
            let growth = (ratio.x * ratio.y).sqrt();
            size *= growth;
            sides = drawn * growth;
            place += wanted_middle - 0.5 * (low + high);
        }
        (CropPose { rotation, size: libm::log(size), place, distance: libm::log(self.median_m) }, sides)
    }
}

/// The ratios of observed and rendered depths, where both are known, and zeros elsewhere, in the canvas's buffer.
fn ratios(canvas: &mut Canvas, grid: &CropGrid) -> Vec<f32x4> {
    let mut ratios = core::mem::take(&mut canvas.ratios);
    ratios.clear();
    for (v, row) in canvas.rows(grid) {
        let end = (v + 1) * grid.width;
        for i in row.step_by(LANES) {
            let mut ratio = four(&canvas.inverse_depth, i) * four(&grid.depth, i);
            if i + LANES > end {
                ratio &= first(end - i);
            }
            let is_known = ratio.simd_gt(f32x4::ZERO);
            if is_known.any() {
                ratios.push(ratio & is_known);
            }
        }
    }
    ratios
}
