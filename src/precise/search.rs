//! A search: the observation and the mesh, prepared for drawing on every grid.

use crate::evidence::observation::Observation;
use crate::geometry::decimate::decimate;
use crate::geometry::mesh::Mesh;

use super::clean::CleanObservation;
use super::coarse::{Candidate, Coarse};
use super::conditioning::Conditioning;
use super::grid::CropGrid;
use super::objective::Objective;
use super::pose::{CropPose, MeshFrame};
use super::prior::Prior;
use super::ranking::distinct;
use super::refine::{Refined, Refiner};
use super::render::{Canvas, Model};
use super::score::Score;
use super::settings::{COARSE, FINE, FINEST, LEVELS, MIDDLE, SIEVE, SearchSettings};

/// Turns tried around a given pose, radians, and how many of them are refined.
const NEIGHBORHOOD: [f64; 2] = [0.17, 0.4];
const NEIGHBORS: usize = 7;

/// A search: the observation and the mesh, prepared.
pub struct Search {
    /// The frame that the poses are from.
    pub frame: MeshFrame,
    /// The mesh in that frame, as the fine grid sees it.
    pub mesh: Mesh,
    /// The cleaned observation.
    pub observation: CleanObservation,
    /// Images drawn so far.
    pub renders: usize,
    pub(super) settings: SearchSettings,
    prior: Prior,
    /// The mesh on each grid.
    pub(super) models: [Model; LEVELS],
    /// The fine grid, on which poses are compared in the end.
    pub(super) fine: CropGrid,
}

/// A candidate, as far as it has come.
#[derive(Debug, Clone, Copy)]
pub struct Found {
    /// The pose.
    pub pose: CropPose,
    /// Its score, in the end on the fine grid.
    pub score: Score,
    /// Whether its refinement came to rest.
    pub converged: bool,
    /// Images drawn for it.
    pub renders: usize,
}

impl From<Candidate> for Found {
    fn from(Candidate { pose, score }: Candidate) -> Self {
        Self { pose, score, converged: false, renders: 1 }
    }
}

impl From<Refined> for Found {
    fn from(Refined { pose, score, renders, converged }: Refined) -> Self {
        Self { pose, score, converged, renders }
    }
}

impl Search {
    /// Cleans the observation and decimates the mesh. `None` where decimation leaves no triangle.
    pub fn new(observation: &Observation, mesh: &Mesh, settings: SearchSettings) -> Option<Self> {
        let frame = MeshFrame::of(mesh);
        let finest = frame.normalized(&decimate(mesh, settings.triangles[FINEST]))?;
        let fine = decimate(&finest, settings.triangles[FINE]);
        let middle = decimate(&fine, settings.triangles[MIDDLE]);
        let coarse = decimate(&middle, settings.triangles[COARSE]);
        let sieve = decimate(&coarse, settings.triangles[SIEVE]);
        let observation = CleanObservation::new(observation);
        Some(Self {
            frame,
            fine: CropGrid::new(&observation, settings.cells[FINE]),
            observation,
            renders: 0,
            settings,
            prior: Prior::default(),
            models: [&sieve, &coarse, &middle, &fine, &finest].map(Model::new),
            mesh: fine,
        })
    }

    /// Takes what is known beforehand into account from now on.
    pub fn assume(&mut self, prior: Prior) {
        self.prior = prior;
    }

    /// A pose and its neighbourhood: turned about every axis, at its own distance and at that of the depths.
    pub(super) fn around(&mut self, pose: CropPose) -> Vec<CropPose> {
        let grid = self.grid(COARSE);
        let stage = Coarse { objective: self.objective(COARSE, &grid), median_m: self.observation.median_m };
        let mut canvas = Canvas::default();
        let mut near: Vec<Candidate> = Vec::new();
        for angle in [0.0, NEIGHBORHOOD[0], NEIGHBORHOOD[1]] {
            for axis in 0..6 {
                let mut step = [0.0; 7];
                step[axis / 2] = if axis % 2 == 0 { angle } else { -angle };
                near.push(stage.at_its_distance(&mut canvas, pose.moved(&step)));
            }
        }
        self.renders += near.len();
        let mut poses = vec![pose];
        poses.extend(distinct(near, NEIGHBORS, 0.5 * NEIGHBORHOOD[0]).iter().map(|c| c.pose));
        poses
    }

    /// The evidence on one of the grids; see also `fine`.
    pub(super) fn grid(&self, level: usize) -> CropGrid {
        CropGrid::new(&self.observation, self.settings.cells[level])
    }

    pub(super) fn objective<'a>(&'a self, level: usize, grid: &'a CropGrid) -> Objective<'a> {
        let scoring = self.settings.scoring(&self.observation, level);
        Objective { model: &self.models[level], grid, scoring, prior: self.prior }
    }

    /// Whether a pose stands at a bound of the scale that leaves a choice.
    pub fn is_held(&self, pose: &CropPose) -> bool {
        self.prior.holds(pose)
    }

    /// The score of any pose on the fine grid.
    pub fn score(&self, pose: &CropPose) -> Score {
        self.objective(FINE, &self.fine).score(&mut Canvas::default(), pose)
    }

    /// How firmly the observation holds a pose, and the root mean square of its depth residuals, metres.
    pub fn conditioning(&self, pose: &CropPose) -> (Option<Conditioning>, f64) {
        let refiner = Refiner { objective: self.objective(FINE, &self.fine), lock_scale: false };
        let mut canvas = Canvas::default();
        let score = refiner.objective.score(&mut canvas, pose);
        let equations = refiner.equations(&canvas, &score);
        (Conditioning::of(&equations, pose), refiner.depth_rms(&canvas))
    }
}
