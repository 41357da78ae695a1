//! The summed objective of several views: scores and normal equations add up.

use super::world_pose::{PlacedCamera, WorldPose};
use crate::geometry::normal_equations::NormalEquations;
use crate::precise::drawing::pose::{CropPose, Step};
use crate::precise::drawing::render::Canvas;
use crate::precise::scoring::objective::Objective;
use crate::precise::scoring::score::Score;
use crate::precise::search::ascent::{Ascent, ascend, limited};
use crate::precise::search::ranking::{Candidate, Total};
use crate::precise::search::refine::Refiner;

/// One view of a joint objective.
#[derive(Clone, Copy)]
pub struct JointView<'a> {
    /// The objective in the view.
    pub objective: Objective<'a>,
    /// The camera of the view.
    pub camera: PlacedCamera,
    /// The score below which the view counts as contradicting, and adds only this constant.
    pub floor: f32,
}

/// The objective over several views. It keeps one canvas per view.
pub struct Joint<'a> {
    /// The views.
    pub views: Vec<JointView<'a>>,
    /// Whether the size of the object is fixed.
    pub lock_scale: bool,
    pub(super) canvases: Vec<Canvas>,
}

/// The score of a world pose.
#[derive(Debug, Clone)]
pub struct JointScore {
    /// The sum over all views, each at least its floor.
    pub total: f32,
    /// The score in each view; zero in views that the pose is behind.
    pub views: Vec<Score>,
}

impl<'a> Joint<'a> {
    /// The objective over these views.
    pub fn new(views: Vec<JointView<'a>>, lock_scale: bool) -> Self {
        let canvases = views.iter().map(|_| Canvas::default()).collect();
        Self { views, lock_scale, canvases }
    }

    /// Refines a pose in at most `iterations` steps.
    pub fn refine(&mut self, pose: WorldPose, iterations: usize) -> Candidate<WorldPose, JointScore> {
        ascend(self, pose, iterations)
    }

    /// Renders a pose in every view and scores it.
    pub fn score(&mut self, pose: &WorldPose) -> JointScore {
        let mut sum = JointScore { total: 0.0, views: Vec::with_capacity(self.views.len()) };
        for (view, canvas) in self.views.iter().zip(&mut self.canvases) {
            let score = view.camera.see(pose).map_or_else(Score::default, |seen| view.objective.score(canvas, &seen));
            sum.total += score.total.max(view.floor);
            sum.views.push(score);
        }
        sum
    }

    /// The last render in a view.
    pub fn canvas(&self, view: usize) -> &Canvas {
        &self.canvases[view]
    }

    /// The quadratic of the sum at the last render, without views at their floor.
    pub fn equations(&self, pose: &WorldPose, score: &JointScore) -> NormalEquations {
        let mut sum = NormalEquations::new();
        for ((view, canvas), score) in self.views.iter().zip(&self.canvases).zip(&score.views) {
            if score.total <= view.floor {
                continue;
            }
            let Some(seen) = view.camera.see(pose) else { continue };
            let refiner = Refiner { objective: view.objective, lock_scale: false };
            let mut map = view.camera.step_map(&seen);
            if self.lock_scale {
                map[3][3] = 0.0;
            }
            sum.add_mapped(&refiner.equations(canvas, score, &seen), &map);
        }
        sum
    }
}

impl Total for JointScore {
    fn total(&self) -> f32 {
        self.total
    }
}

impl Ascent for Joint<'_> {
    type Pose = WorldPose;
    type Score = JointScore;

    fn allowed(&self, mut pose: WorldPose) -> WorldPose {
        let Some(view) = self.views.first() else { return pose };
        let bounded = view.objective.prior.bounded(CropPose {
            rotation: pose.rotation,
            size: pose.log_scale,
            place: glam::DVec2::ZERO,
            distance: 0.0,
        });
        pose.log_scale = bounded.size;
        pose
    }

    fn score(&mut self, pose: &WorldPose) -> JointScore {
        Joint::score(self, pose)
    }

    fn equations(&mut self, pose: &WorldPose, score: &JointScore) -> NormalEquations {
        Joint::equations(self, pose, score)
    }

    fn moved(&self, pose: &WorldPose, step: Step) -> Option<WorldPose> {
        let next = pose.moved(&limited(step));
        next.is_finite().then_some(next)
    }
}
