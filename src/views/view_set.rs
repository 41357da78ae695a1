//! Views with known camera poses: hypotheses of every view, scored and refined on the evidence of all.

use super::common_size::{DEPTH_ERROR, SILHOUETTE_ERROR, SizeEvidence, mean};
use super::joint::{Joint, JointScore, JointView};
use super::world_pose::{PlacedCamera, WorldPose};
use crate::geometry::rotations::angle_between;
use crate::precise::drawing::pose::CropPose;
use crate::precise::drawing::render::Canvas;
use crate::precise::scoring::score::Score;
use crate::precise::search::cascade::{Cascade, Stage};
use crate::precise::search::problem::{EQUAL_MAX_RAD, EQUIVALENT_MAX_SCORE_LOSS, FACING_CAMERA, Search};
use crate::precise::search::ranking::Candidate;
use crate::precise::search::recipe::{FINE, JOINT, JOINT_POLISH, JOINT_RANKING};
use crate::precise::search::refine::Refiner;

/// Share of a view's own best score below which a pose contradicts the view, and the one that a view adds at least, so that
/// one wrong view does not move the others. The second is low: errors of the camera poses cost all views a little, and
/// must not be worth more than a pose that fits only one view.
const CONTRADICTION: f32 = 0.35;
const FLOOR: f32 = 0.25;
/// Score per view below the best pose at which a turn of it is not ranked.
const NEAR: f32 = 0.3;

/// A view that takes part.
#[derive(Clone, Copy)]
pub struct Part<'a> {
    /// Its index in the input.
    pub index: usize,
    /// Its search.
    pub search: &'a Search,
    /// Its camera.
    pub camera: PlacedCamera,
    /// The best pose that a search of this view alone has found.
    pub own: Option<CropPose>,
}

/// A world pose and its score in all views.
pub type Ranked = Candidate<WorldPose, JointScore>;

/// The views on whose evidence poses are refined.
#[derive(Clone)]
pub struct ViewSet<'a> {
    /// Those that take part.
    pub parts: Vec<Part<'a>>,
    /// Whether the size of the object is fixed.
    pub lock_scale: bool,
    /// Number of poses that were rendered in each.
    pub renders: usize,
}

impl Part<'_> {
    /// A pose in this view, with its total score in all of them; `None` if the view does not show it.
    pub fn candidate(&self, ranked: &Ranked) -> Option<Candidate> {
        let score = Score { total: ranked.score.total, ..Score::default() };
        Some(Candidate { pose: self.camera.see(&ranked.pose)?, score, converged: ranked.converged, renders: 0 })
    }

    /// Whether the view, with this score, contradicts the pose.
    pub fn contradicts(&self, score: f32) -> bool {
        let own = self.own.map_or(0.0, |own| self.search.score(&own).total);
        score <= CONTRADICTION * own
    }
}

impl Cascade for ViewSet<'_> {
    type Pose = WorldPose;
    type Score = JointScore;

    fn refined(&mut self, grid: usize, steps: usize, poses: &[WorldPose]) -> Vec<Ranked> {
        let mut joint = self.level(grid);
        let refined: Vec<Ranked> = match steps {
            0 => poses.iter().map(|pose| Candidate::of(*pose, joint.score(pose))).collect(),
            _ => poses.iter().map(|pose| joint.refine(*pose, steps)).collect(),
        };
        self.renders += refined.iter().map(|summit| summit.renders).sum::<usize>();
        refined
    }
}

impl<'a> ViewSet<'a> {
    /// The best poses for all views, best first, with their scores on the fine grid.
    pub fn join(&mut self, hypotheses: Vec<WorldPose>) -> Vec<Ranked> {
        let mut kept = self.cascade(&JOINT, hypotheses);
        if let Some(best) = kept.first().cloned() {
            let mut turned = self.cascade(&JOINT[1..], self.turns(&best.pose));
            let least = best.score.total - NEAR * self.parts.len() as f32;
            turned.retain(|turned| turned.score.total > least);
            kept.extend(turned);
        }
        self.rank(&kept)
    }

    /// Refines poses on the fine grid, and the best of them on the finest.
    pub fn rank(&mut self, poses: &[Ranked]) -> Vec<Ranked> {
        let mut ranked = self.cascade(&[JOINT_RANKING], poses.iter().map(|ranked| ranked.pose).collect());
        if let Some(best) = ranked.first_mut() {
            best.pose = self.polished(&JOINT_POLISH, best.pose);
        }
        ranked
    }

    /// A pose after one more stage.
    pub fn polished(&mut self, stage: &Stage, pose: WorldPose) -> WorldPose {
        self.cascade(core::slice::from_ref(stage), vec![pose]).first().map_or(pose, |polished| polished.pose)
    }

    /// The equivalent of a pose whose rotation is nearest to that of a mesh that faces the first camera; see [`Search::canonical`].
    pub fn canonical(&mut self, pose: &WorldPose) -> Option<WorldPose> {
        let part = *self.parts.first()?;
        let nearest = |pose: &WorldPose| {
            let seen = part.camera.see(pose)?;
            Some(part.camera.place(&part.search.nearest(&seen, FACING_CAMERA)))
        };
        let turned = nearest(pose)?;
        if angle_between(turned.rotation, pose.rotation) < EQUAL_MAX_RAD {
            return None;
        }

        let equivalent = nearest(&self.polished(&JOINT_POLISH, turned))?;
        let mut joint = self.level(FINE);
        let loss = joint.score(pose).total - joint.score(&equivalent).total;
        (loss < EQUIVALENT_MAX_SCORE_LOSS * self.parts.len() as f32).then_some(equivalent)
    }

    /// The joint objective on the fine grids at a free size, for the final numbers.
    pub fn on_fine_grids(&self) -> Joint<'a> {
        Joint { lock_scale: false, ..self.on_grids(FINE) }
    }

    fn on_grids(&self, index: usize) -> Joint<'a> {
        let objective = |part: &Part<'a>| {
            let mut objective = part.search.objective(index);
            // What the finest grid counts as an error of the depth is less than that of camera poses.
            objective.scoring = part.search.settings.scoring(&part.search.observation, index.min(FINE));
            objective
        };
        let views =
            self.parts.iter().map(|part| JointView { objective: objective(part), camera: part.camera, floor: 0.0 });
        Joint::new(views.collect(), self.lock_scale)
    }

    /// The joint objective on the grids with this index, to which every view adds a minimum.
    pub fn level(&self, index: usize) -> Joint<'a> {
        let mut joint = self.on_grids(index);
        if self.parts.len() > 1 {
            for (i, part) in self.parts.iter().enumerate() {
                let own = part.own.map_or(0.0, |own| joint.score(&part.camera.place(&own)).views[i].total);
                joint.views[i].floor = FLOOR * own;
            }
        }
        joint
    }

    /// The pose at the size on which silhouettes and depths agree best, and the standard deviation of that size.
    pub fn fused_size(&mut self, pose: WorldPose) -> Option<(WorldPose, f64)> {
        let mut joint = self.on_fine_grids();
        let (size, moved) = SizeEvidence::fused(&mut joint, &pose, [SILHOUETTE_ERROR, DEPTH_ERROR])?;
        // Each view by itself, where its own evidence puts the object: that does not depend on errors of the camera poses.
        let mut canvas = Canvas::default();
        let (mut views, mut apart) = (Vec::new(), 0.0);
        for view in &joint.views {
            let Some(seen) = view.camera.see(&moved) else { continue };
            let alone =
                Refiner { objective: view.objective, lock_scale: true }.refine(&mut canvas, seen, JOINT_RANKING.steps);
            self.renders += alone.renders;
            apart += view.camera.place(&alone.pose).center.distance_squared(moved.center);
            views.extend(SizeEvidence::at(view.objective, &alone.pose, SILHOUETTE_ERROR));
        }
        // Errors of the cameras are errors of the distances between the sides that they see.
        let apart = (apart / joint.views.len().max(1) as f64).sqrt() * libm::exp(-moved.log_scale);
        let size = size.with_error(apart);
        let (log_scale, sd) = match mean(views.into_iter()) {
            Some((log_scale, sd)) => mean([size, SizeEvidence { log_scale, sd, ..size }].into_iter())?,
            None => (size.log_scale, size.sd),
        };
        joint.lock_scale = true;
        let refined = joint.refine(WorldPose { log_scale, ..moved }, JOINT_RANKING.steps);
        self.renders += refined.renders;
        // Not less than either: both see the same images.
        Some((refined.pose, sd.max(size.sd.min(core::f64::consts::SQRT_2 * sd))))
    }

    /// The half and quarter turns of a pose, about the axes of the mesh and the first line of sight.
    fn turns(&self, pose: &WorldPose) -> Vec<WorldPose> {
        let seen = self.parts.iter().find_map(|part| Some((part, part.camera.see(pose)?)));
        let Some((part, seen)) = seen else { return Vec::new() };
        part.search.mesh.turns.of(&seen).iter().map(|turned| part.camera.place(turned)).collect()
    }
}
