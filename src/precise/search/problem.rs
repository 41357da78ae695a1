//! A search: the observation and the mesh, prepared for rendering on every grid.

use core::cell::OnceCell;
use std::rc::Rc;

use glam::DQuat;

use super::coarse::Coarse;
use super::ranking::{Candidate, distinct};
use super::recipe::{COARSE, COLORED, FINE, GRIDS, SearchSettings};
use super::refine::Refiner;
use crate::geometry::rotations::angle_between;
use crate::precise::drawing::equivalence::Equivalence;
use crate::precise::drawing::mesh_pyramid::MeshPyramid;
use crate::precise::drawing::pose::CropPose;
use crate::precise::drawing::render::Canvas;
use crate::precise::observation::box_fits::{BoxFit, box_fits};
use crate::precise::observation::clean::CleanObservation;
use crate::precise::observation::grid::CropGrid;
use crate::precise::scoring::conditioning::{Conditioning, DROP, at_known, gradient_of_scale};
use crate::precise::scoring::objective::Objective;
use crate::precise::scoring::prior::Prior;
use crate::precise::scoring::scene_term::SceneTerm;
use crate::precise::scoring::score::Score;
use crate::report::Effort;

/// Rotations tried around a given pose, radians, and the number that are refined.
const NEIGHBOR_TURNS_RAD: [f64; 2] = [0.17, 0.4];
const NEIGHBORS: usize = 7;

/// Number of rolls about each principal axis, and of each half turn followed by a roll, and the minimum rotation between
/// those that are refined, radians.
const ROLLS: usize = 24;
const MIN_TURN_RAD: f64 = 0.3;

/// Rotation of an upright mesh that faces the camera, as glTF has it: +y up, +z to the viewer. Of poses that a symmetry makes
/// equal, the one nearest to it is the result.
pub const FACING_CAMERA: DQuat = DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0);
/// Rotation between two poses below which they are one, radians.
pub const EQUAL_MAX_RAD: f64 = 0.01;
/// Loss of score from which on the image tells an equivalent pose from the best one: symmetries are approximate. Of 36 real
/// objects under noise, the turned pose loses 0 to 0.038, or, where the ends of a can or a box differ a little, 0.058 and more: a
/// limit between them lets no noise decide.
pub const EQUIVALENT_MAX_SCORE_LOSS: f32 = 5.0 * DROP as f32;
/// Steps of the refinement of an equivalent pose.
const EQUIVALENT_STEPS: usize = 8;

/// A search: the observation and the mesh, prepared.
pub struct Search {
    /// The mesh, decimated for every grid.
    pub mesh: Rc<MeshPyramid>,
    /// The cleaned observation.
    pub observation: Rc<CleanObservation>,
    /// The index of its view, where an alignment has several.
    pub view: usize,
    /// Number of renders so far.
    pub renders: usize,
    pub(crate) settings: SearchSettings,
    pub(crate) prior: Prior,
    scene: Option<SceneTerm>,
    /// The equivalent poses of the mesh.
    pub equivalence: Rc<Equivalence>,
    /// The evidence on every grid, on first use.
    grids: Rc<[OnceCell<CropGrid>; GRIDS]>,
}

impl Search {
    /// A search without a prior, a scene term or a symmetry.
    pub fn new(observation: Rc<CleanObservation>, mesh: Rc<MeshPyramid>, settings: SearchSettings) -> Self {
        Self {
            mesh,
            grids: Rc::default(),
            observation,
            view: 0,
            renders: 0,
            settings,
            prior: Prior::default(),
            scene: None,
            equivalence: Rc::default(),
        }
    }

    /// A search for rivals of a pose on the same grids, without the scene term.
    pub(crate) fn for_rivals(&self) -> Self {
        Self {
            mesh: Rc::clone(&self.mesh),
            observation: Rc::clone(&self.observation),
            view: self.view,
            renders: 0,
            settings: self.settings.of_rival_search(),
            prior: self.prior,
            scene: None,
            equivalence: Rc::clone(&self.equivalence),
            grids: Rc::clone(&self.grids),
        }
    }

    /// Sets the prior.
    pub fn assume(&mut self, prior: Prior) {
        self.prior = prior;
    }

    /// Sets the evidence of the scene around the object.
    pub fn set_scene_term(&mut self, scene: SceneTerm) {
        self.scene = Some(scene);
    }

    /// A pose and its neighbourhood: rotated about every axis, at its own distance and at that of the depths.
    pub(crate) fn around(&mut self, pose: CropPose) -> Vec<CropPose> {
        let stage = Coarse { objective: self.objective(COARSE), median_m: self.observation.median_m };
        let mut canvas = Canvas::default();
        let mut near = vec![stage.at_its_distance(&mut canvas, pose)];
        for angle in NEIGHBOR_TURNS_RAD {
            for axis in 0..6 {
                let mut step = [0.0; 7];
                step[axis / 2] = if axis % 2 == 0 { angle } else { -angle };
                near.push(stage.at_its_distance(&mut canvas, pose.moved(&step)));
            }
        }
        self.renders += near.len();
        let mut poses = vec![pose];
        poses.extend(distinct(near, NEIGHBORS, 0.5 * NEIGHBOR_TURNS_RAD[0]).iter().map(|c| c.pose));
        poses
    }

    /// The turns of the best of these poses that should be refined. `anchors` are sizes and positions for the half and quarter
    /// turns: a part that something hides is elsewhere after a turn.
    pub(crate) fn turned(&mut self, poses: &[CropPose], box_fits: &[BoxFit]) -> Vec<CropPose> {
        let Some(best) = poses.first() else { return Vec::new() };
        let mesh = Rc::clone(&self.mesh);
        if self.settings.turned <= 1 {
            return mesh.turns.of(best);
        }
        let rolled = mesh.turns.about_axes(best, ROLLS);
        let turned: Vec<CropPose> =
            poses.iter().take(self.settings.turned).flat_map(|pose| mesh.turns.of(pose)).collect();
        let stage = Coarse { objective: self.objective(COARSE), median_m: self.observation.median_m };
        let mut canvas = Canvas::default();
        let mut tried: Vec<Candidate> =
            rolled.iter().chain(&turned).map(|pose| stage.at_its_distance(&mut canvas, *pose)).collect();
        for pose in turned {
            stage.try_box_fits(&mut canvas, &mesh.outermost, pose.rotation, box_fits, &mut tried);
        }
        self.renders += tried.len();
        let is_new = |turned: &Candidate| {
            poses.iter().all(|pose| angle_between(pose.rotation, turned.pose.rotation) > MIN_TURN_RAD)
        };
        let tried = tried.into_iter().filter(is_new).collect();
        distinct(tried, self.settings.turns(), MIN_TURN_RAD).iter().map(|candidate| candidate.pose).collect()
    }

    /// Sizes and positions tried for each rotation.
    pub fn box_fits(&self) -> Vec<BoxFit> {
        box_fits(self.grid(COARSE))
    }

    /// Makes all grids.
    pub fn make_grids(&self) {
        (0..GRIDS).for_each(|grid| _ = self.grid(grid));
    }

    /// The evidence on the grid with this index.
    pub fn grid(&self, index: usize) -> &CropGrid {
        self.grids[index].get_or_init(|| CropGrid::new(&self.observation, self.settings.grids[index].cells))
    }

    /// The objective on the grid with this index.
    pub fn objective(&self, index: usize) -> Objective<'_> {
        let scoring = self.settings.scoring(&self.observation, index);
        Objective {
            model: &self.mesh.models[index],
            grid: self.grid(index),
            scoring,
            prior: self.prior,
            equivalence: &self.equivalence,
            scene: self.scene.as_ref(),
        }
    }

    /// The effort of the search.
    pub fn effort(&self) -> Effort {
        self.settings.effort
    }

    /// Whether a pose is at a bound of a scale that is not fixed.
    pub fn is_at_bound(&self, pose: &CropPose) -> bool {
        self.prior.is_at_bound(pose)
    }

    /// The score of any pose on the fine grid.
    pub fn score(&self, pose: &CropPose) -> Score {
        self.objective(FINE).score(&mut Canvas::default(), pose)
    }

    /// A pose refined on the finest grid.
    pub fn polished(&self, pose: CropPose) -> CropPose {
        let [_, polish] = COLORED;
        let refiner = Refiner { objective: self.objective(polish.grid), lock_scale: self.settings.lock_scale };
        refiner.refine_in_proportion(&mut Canvas::default(), pose, polish.steps, &self.mesh.surface).pose
    }

    /// The equivalent of a ranked pose whose rotation is nearest to `reference`, so that noise does not choose among them, without
    /// those that the image tells from it; `None` if it is the pose itself.
    pub fn canonical(&self, best: &Candidate, reference: DQuat) -> Option<CropPose> {
        let rotations = self.equivalence.by_nearness(best.pose.rotation, reference).into_iter();
        let is_other = |rotation: &DQuat| angle_between(*rotation, best.pose.rotation) >= EQUAL_MAX_RAD;
        let mut others = rotations.take_while(is_other).map(|rotation| self.mesh.turns.turned(&best.pose, rotation));
        others.find_map(|turned| {
            // Scored as it was in the ranking.
            let refiner = Refiner { objective: self.objective(FINE), lock_scale: self.settings.lock_scale };
            let canvas = &mut Canvas::default();
            let ranked = refiner.refine_in_proportion(canvas, turned, EQUIVALENT_STEPS, &self.mesh.surface);
            let is_equal = best.score.total - ranked.score.total < EQUIVALENT_MAX_SCORE_LOSS;
            // Refinement has turned it a little.
            is_equal.then(|| {
                let polished = self.polished(ranked.pose);
                let rotations = self.equivalence.by_nearness(polished.rotation, reference).into_iter();
                let angle = |rotation: &DQuat| angle_between(*rotation, turned.rotation);
                let nearest = rotations.min_by(|a, b| angle(a).total_cmp(&angle(b)));
                self.mesh.turns.turned(&polished, nearest.unwrap_or(polished.rotation))
            })
        })
    }

    /// The pose, of those that the symmetry of the mesh makes equal, whose rotation is nearest to `reference`.
    pub fn nearest(&self, pose: &CropPose, reference: DQuat) -> CropPose {
        self.mesh.turns.turned(pose, self.equivalence.nearest(pose.rotation, reference))
    }

    /// The part of a score that the image gives.
    pub fn by_image(&self, score: &Score) -> f32 {
        let weights = &self.settings.weights;
        weights.factor(score, self.grid(FINE)) * weights.agreement(score)
    }

    /// The conditioning of a pose by the image alone.
    pub fn conditioning_by_image(&self, pose: &CropPose) -> Option<Conditioning> {
        let objective = Objective { scene: None, ..self.objective(FINE) };
        self.conditioning_by(objective, pose, false).0
    }

    /// Whether the score has a scene term.
    pub fn has_scene_term(&self) -> bool {
        self.scene.is_some()
    }

    /// The conditioning of a pose whose size is free, up to the symmetry of the mesh, and the root mean square of its depth
    /// residuals, metres.
    pub fn conditioning(&self, pose: &CropPose) -> (Option<Conditioning>, f64) {
        self.conditioning_by(self.objective(FINE), pose, false)
    }

    /// The conditioning of a pose, at its size if that is fixed.
    pub fn conditioning_as_fixed(&self, pose: &CropPose) -> Option<Conditioning> {
        self.conditioning_by(self.objective(FINE), pose, self.settings.lock_scale).0
    }

    fn conditioning_by(
        &self,
        objective: Objective<'_>,
        pose: &CropPose,
        is_fixed: bool,
    ) -> (Option<Conditioning>, f64) {
        let refiner = Refiner { objective, lock_scale: false };
        let mut canvas = Canvas::default();
        let score = refiner.objective.score(&mut canvas, pose);
        let depth_rms_m = refiner.depth_rms(&canvas);
        let proportions = (&self.mesh.surface, self.settings.lock_scale);
        let free_axis = self.equivalence.free_axis(pose.rotation);
        let covariance = refiner.covariance(&mut canvas, &score, pose, proportions, free_axis);
        let conditioning = covariance.map(|covariance| match is_fixed {
            true => {
                Conditioning { scale: 0.0, ..Conditioning::new(&at_known(&covariance, &gradient_of_scale(pose)), pose) }
            }
            false => Conditioning::new(&covariance, pose),
        });
        // A sphere has no rotation that could be wrong.
        let upright = |own: Conditioning| match self.equivalence.is_sphere() {
            true => Conditioning { rotation: (0.0, own.rotation.1), ..own },
            false => own,
        };
        (conditioning.map(upright), depth_rms_m)
    }
}
