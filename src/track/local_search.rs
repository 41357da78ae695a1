//! The evidence of a frame near expected poses, and the pose that fits it best.

use glam::Vec3;

use super::detection::Lead;
use super::evidence::{Evidence, TrackedMesh, of_mask, of_pose};
use crate::evidence::frame::Frame;
use crate::geometry::pinhole::Pinhole;
use crate::precise::drawing::pose::CropPose;
use crate::precise::drawing::render::Canvas;
use crate::precise::scoring::score::Score;
use crate::precise::search::cascade::Cascade;
use crate::precise::search::problem::Search;
use crate::precise::search::ranking::Candidate;
use crate::precise::search::recipe::{FINE, TRACKED};
use crate::precise::search::refine::Refiner;

/// Most times that the mask of a frame without one is predicted, and how far a pose may be from that of its mask for the next
/// mask to be the last one: relative to the diagonal of the object, about half of what a predicted mask grows.
const MAX_MASK_PREDICTIONS: usize = 3;
const SETTLED_MASK_DISTANCE: f64 = 0.04;

/// The pose found in a frame.
pub struct FramePose {
    /// The pose.
    pub candidate: Candidate,
    /// The evidence.
    pub evidence: Evidence,
    /// The lead over other poses, if all rotations were searched.
    pub lead: Option<Lead>,
    /// Share of the silhouette that is seen; 1 with a mask, which states what is seen.
    pub visible: f32,
    /// Whether the mask was predicted.
    pub is_predicted: bool,
}

impl FramePose {
    /// The share of the object that the frame shows: of its vertices, those inside the image, times the share of its
    /// silhouette in the image that the mask covers.
    pub fn shown_share(&self, frame: &Frame) -> f32 {
        let pose = &self.candidate.pose;
        let (scale, translation) = pose.scale_translation();
        let Pinhole { fx, fy, cx, cy } = frame.camera;
        let [width, height] = [frame.depth.width() as f64, frame.depth.height() as f64];
        let search = &self.evidence.search;
        let is_inside = |position: &&Vec3| {
            let point = pose.rotation * position.as_dvec3() * scale + translation;
            let (u, v) = (fx * point.x / point.z + cx + 0.5, fy * point.y / point.z + cy + 0.5);
            point.z > 0.0 && u >= 0.0 && v >= 0.0 && u < width && v < height
        };
        let vertices = search.mesh.fine.positions();
        let inside = vertices.iter().filter(is_inside).count() as f32 / vertices.len().max(1) as f32;
        inside * if self.is_predicted { self.visible } else { visible(search, pose) }
    }
}

impl TrackedMesh {
    /// The evidence of a frame where its mask is or, without one, where a pose predicts it; `None` if nothing is seen there.
    pub fn evidence(&self, frame: &Frame, expected: &CropPose) -> Option<Evidence> {
        match frame.mask {
            Some(_) => of_mask(frame, self),
            None => of_pose(frame, expected, self),
        }
        .ok()
        .flatten()
    }

    /// The best pose near the expected ones, of which the first is where the evidence was taken; `wide`: also in their
    /// neighbourhood.
    pub fn around(&self, frame: &Frame, evidence: &Evidence, expected: &[CropPose], wide: bool) -> Option<FramePose> {
        let first = *expected.first()?;
        let has_mask = frame.mask.is_some();
        let mut evidence = evidence.shared();
        let mut poses = expected.to_vec();
        if wide {
            poses.extend(expected.iter().flat_map(|pose| evidence.search.around(*pose)).collect::<Vec<_>>());
        }
        let mut candidate = self.refined(&evidence.search, &poses, !has_mask)?;
        if !has_mask {
            let mut from = first;
            for round in 1..MAX_MASK_PREDICTIONS {
                let is_last =
                    round + 1 == MAX_MASK_PREDICTIONS || apart(&from, &candidate.pose) < SETTLED_MASK_DISTANCE;
                from = candidate.pose;
                evidence = of_pose(frame, &from, self).ok().flatten()?;
                candidate = self.refined(&evidence.search, &[from], !is_last)?;
                if is_last {
                    break;
                }
            }
        }
        let visible = if has_mask { 1.0 } else { visible(&evidence.search, &candidate.pose) };
        Some(FramePose { candidate, evidence, lead: None, visible, is_predicted: !has_mask })
    }

    /// The best of several poses, refined at their size. `by_depth`: the outline is that of another pose, and does not count.
    fn refined(&self, search: &Search, poses: &[CropPose], by_depth: bool) -> Option<Candidate> {
        let stages = if by_depth { &TRACKED[..2] } else { &TRACKED[..] };
        // Only the grids of these stages are made.
        if stages.iter().any(|stage| search.grid(stage.grid).mask_cells == 0) {
            return None;
        }
        AtItsSize { search, by_depth }.cascade(stages, poses.to_vec()).first().copied()
    }
}

/// The distance of two poses: about that of points of the surface, relative to the diagonal of the object.
fn apart(a: &CropPose, b: &CropPose) -> f64 {
    let [x, y, z, size, across, down, distance] = a.step_to(b);
    let length = |sides: [f64; 3]| sides.iter().map(|side| side * side).sum::<f64>().sqrt();
    0.5 * length([x, y, z]) + 0.5 * size.abs() + length([across, down, distance])
}

/// Poses in a frame, refined at the size that they have.
struct AtItsSize<'a> {
    search: &'a Search,
    /// Whether depth alone judges.
    by_depth: bool,
}

impl Cascade for AtItsSize<'_> {
    type Pose = CropPose;
    type Score = Score;

    fn refined(&mut self, grid: usize, steps: usize, poses: &[CropPose]) -> Vec<Candidate> {
        let mut objective = self.search.objective(grid);
        if self.by_depth {
            objective.scoring.weights = objective.scoring.weights.of_depth_alone();
        }
        let (refiner, canvas) = (Refiner { objective, lock_scale: true }, &mut Canvas::default());
        let refined = |pose: &CropPose| match steps {
            0 => Candidate::of(*pose, objective.score(canvas, pose)),
            _ => refiner.refine(canvas, *pose, steps),
        };
        poses.iter().map(refined).collect()
    }
}

/// The measure of a fit: the agreement of silhouette and depth.
pub fn agreement(score: &Score) -> f32 {
    score.overlap * score.depth
}

/// The share of the silhouette, inside the image, that the mask covers.
fn visible(search: &Search, pose: &CropPose) -> f32 {
    let canvas = &mut Canvas::default();
    let objective = search.objective(FINE);
    objective.score(canvas, pose);
    let drawn = canvas.inverse_depth.iter().zip(&search.grid(FINE).mask).filter(|(w, _)| **w > 0.0);
    let (all, seen) = drawn.fold((0u32, 0u32), |(all, seen), (_, mask)| (all + 1, seen + u32::from(*mask)));
    seen as f32 / all.max(1) as f32
}
