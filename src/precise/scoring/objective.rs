//! The objective: scores poses on one grid.

use glam::Mat3;

use super::prior::Prior;
use super::scene_term::SceneTerm;
use super::score::{Score, Scoring};
use crate::precise::drawing::equivalence::Equivalence;
use crate::precise::drawing::pose::CropPose;
use crate::precise::drawing::render::{Canvas, Model};
use crate::precise::observation::grid::CropGrid;

/// The objective on one grid.
#[derive(Clone, Copy)]
pub struct Objective<'a> {
    /// The mesh.
    pub model: &'a Model,
    /// The evidence.
    pub grid: &'a CropGrid,
    /// The weights of the terms.
    pub scoring: Scoring,
    /// The prior.
    pub prior: Prior,
    /// The equivalent poses of the mesh.
    pub equivalence: &'a Equivalence,
    /// The scene around the object, if known.
    pub scene: Option<&'a SceneTerm>,
}

impl Objective<'_> {
    /// Renders a pose and scores it.
    pub fn score(&self, canvas: &mut Canvas, pose: &CropPose) -> Score {
        self.score_stretched(canvas, pose, &Mat3::IDENTITY)
    }

    /// Renders a pose of the mesh in other proportions and scores it.
    pub fn score_stretched(&self, canvas: &mut Canvas, pose: &CropPose, stretch: &Mat3) -> Score {
        canvas.draw_stretched(self.model, pose, stretch, self.grid);
        let mut score = self.scoring.score(canvas, self.model, self.grid, 1.0);
        score.total += self.prior.score(pose, self.equivalence);
        if let Some(scene) = self.scene {
            score.total += scene.score(canvas, self.grid, pose);
        }
        score
    }
}
