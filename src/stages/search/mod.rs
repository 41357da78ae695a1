//! Search by rendering: the pose whose picture explains mask, free space and depth best.
//!
//! Coarse to fine on a crop around the mask. A grid of rotations, each with size, place and distance in closed form;
//! the best distinct ones refined over all seven parameters; the best of those refined again where every pixel
//! counts.

pub mod anchors;
pub mod clean;
pub mod coarse;
pub mod conditioning;
pub mod grid;
pub mod objective;
pub mod pose;
pub mod prior;
pub mod ranking;
pub mod refine;
pub mod render;
pub mod rim;
pub mod score;
pub mod settings;

use crate::geometry::decimate::decimate;
use crate::geometry::mesh::Mesh;
use crate::geometry::rotations::super_fibonacci;
use crate::stages::observe::Observation;

use anchors::Anchor;
use clean::CleanObservation;
use coarse::{Candidate, Coarse};
use conditioning::Conditioning;
use grid::CropGrid;
use objective::Objective;
use pose::{CropPose, MeshFrame};
use prior::Prior;
use ranking::{best_of, distinct};
use refine::Refiner;
use render::{Canvas, Model};
use score::Score;
use settings::{COARSE, FINE, FINEST, LEVELS, MIDDLE, SIEVE};

pub use settings::SearchSettings;

/// Rotations nearer than this are one candidate, on the coarse grid and on the middle one; radians.
const DISTINCT: [f64; 2] = [0.21, 0.105];

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
    settings: SearchSettings,
    prior: Prior,
    /// The mesh on each grid.
    models: [Model; LEVELS],
    /// The fine grid, on which poses are compared in the end.
    fine: CropGrid,
}

/// A refined candidate.
#[derive(Debug, Clone, Copy)]
pub struct Found {
    /// The pose.
    pub pose: CropPose,
    /// Its score on the fine grid.
    pub score: Score,
    /// Whether its refinement came to rest.
    pub converged: bool,
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

    /// The best distinct rotations of the grid.
    pub fn coarse(&mut self) -> Vec<Candidate> {
        let settings = &self.settings;
        let [sieve, coarse] = [SIEVE, COARSE].map(|level| CropGrid::new(&self.observation, settings.cells[level]));
        let anchors =
            if settings.anchors { anchors::anchors(&coarse, settings.occlusion) } else { vec![Anchor::AS_IT_IS] };
        let outermost = coarse::outermost(&self.models[FINE]);
        let count = settings.rotations;
        let mut canvas = Canvas::default();

        let stage = self.stage(SIEVE, &sieve);
        let mut candidates = Vec::with_capacity(count * anchors.len());
        for i in 0..count {
            stage.try_anchors(&mut canvas, &outermost, super_fibonacci(i, count), &anchors, &mut candidates);
        }
        let mut renders = candidates.len();
        let stage = self.stage(COARSE, &coarse);
        let promising = best_of(&candidates, settings.keep[0]);
        let candidates: Vec<Candidate> =
            promising.into_iter().map(|c| stage.at_its_distance(&mut canvas, c.pose)).collect();
        renders += candidates.len();
        self.renders += renders;
        distinct(candidates, self.settings.keep[1], DISTINCT[0])
    }

    /// A pose and its neighbourhood: turned about every axis, at its own distance and at that of the depths.
    pub fn around(&mut self, pose: CropPose) -> Vec<Candidate> {
        let grid = CropGrid::new(&self.observation, self.settings.cells[COARSE]);
        let stage = self.stage(COARSE, &grid);
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
        let mut kept = vec![Candidate { pose, score: Score::default() }];
        kept.extend(distinct(near, NEIGHBORS, 0.5 * NEIGHBORHOOD[0]));
        kept
    }

    fn stage<'a>(&'a self, level: usize, grid: &'a CropGrid) -> Coarse<'a> {
        Coarse { objective: self.objective(level, grid), median_m: self.observation.median_m }
    }

    fn objective<'a>(&'a self, level: usize, grid: &'a CropGrid) -> Objective<'a> {
        let scoring = self.settings.scoring(&self.observation, level);
        Objective { model: &self.models[level], grid, scoring, prior: self.prior }
    }

    /// The candidates refined on the middle grid, and the best of them on the fine one; best first.
    pub fn refine(&mut self, candidates: Vec<Candidate>) -> Vec<Found> {
        let poses = candidates.into_iter().map(|c| c.pose).collect();
        let (keep, iterations) = (self.settings.keep, self.settings.iterations);
        let [middle, finest] = [MIDDLE, FINEST].map(|l| CropGrid::new(&self.observation, self.settings.cells[l]));
        let (mut canvas, mut renders) = (Canvas::default(), 0);
        let mut refine_on = |level, grid, poses: Vec<CropPose>, iterations, keep| {
            let refiner = Refiner { objective: self.objective(level, grid), lock_scale: self.settings.lock_scale };
            let mut found = Vec::with_capacity(poses.len());
            for pose in poses {
                let refined = refiner.refine(&mut canvas, pose, iterations);
                renders += refined.renders;
                found.push(Found { pose: refined.pose, score: refined.score, converged: refined.converged });
            }
            distinct(found, keep, DISTINCT[1])
        };
        let begun = refine_on(MIDDLE, &middle, poses, iterations[0], keep[2]);
        let advanced = refine_on(MIDDLE, &middle, poses_of(&begun), iterations[1], keep[3]);
        let mut found = refine_on(FINE, &self.fine, poses_of(&advanced), iterations[2], usize::MAX);
        // The scores stay those of the fine grid: scores of different grids do not compare.
        for best in found.iter_mut().take(keep[4]) {
            for polished in refine_on(FINEST, &finest, vec![best.pose], iterations[3], 1) {
                best.pose = polished.pose;
            }
        }
        self.renders += renders;
        found
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

fn poses_of(found: &[Found]) -> Vec<CropPose> {
    found.iter().map(|f| f.pose).collect()
}
