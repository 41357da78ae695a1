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
pub mod pose;
pub mod prior;
pub mod refine;
pub mod render;
pub mod rim;
pub mod score;

use glam::DQuat;

use crate::geometry::decimate::decimate;
use crate::geometry::mesh::Mesh;
use crate::geometry::order;
use crate::geometry::rotations::{angle_between, super_fibonacci};
use crate::stages::observe::Observation;

use anchors::Anchor;
use clean::CleanObservation;
use coarse::{Candidate, Coarse};
use conditioning::Conditioning;
use grid::CropGrid;
use pose::{CropPose, MeshFrame};
use prior::Prior;
use refine::{Refined, Refiner};
use render::{Canvas, Model};
use score::{Score, Scoring, Weights};

/// Work and objective of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SearchSettings {
    /// Rotations of the grid.
    pub rotations: usize,
    /// Distinct candidates refined on the middle grid, and on the fine one.
    pub keep: [usize; 2],
    /// Mask cells of the three grids.
    pub cells: [usize; 3],
    /// Triangles of the mesh on the three grids.
    pub triangles: [usize; 3],
    /// Steps of the two refinements.
    pub iterations: [usize; 2],
    /// Depth error that halves a cell's credit on the three grids, as a share of the observed diagonal.
    pub depth_error: [f64; 3],
    /// The objective.
    pub weights: Weights,
    /// Whether occluders hide the mesh, and cut-off masks let it stick out.
    pub occlusion: bool,
    /// Whether sizes other than the box's are tried.
    pub anchors: bool,
    /// Whether the scale stays as the grid found it.
    pub lock_scale: bool,
}

impl Default for SearchSettings {
    fn default() -> Self {
        Self {
            rotations: 1500,
            keep: [32, 6],
            cells: [500, 900, 3000],
            triangles: [700, 1500, 5000],
            iterations: [12, 12],
            depth_error: [0.12, 0.06, 0.03],
            weights: Weights::default(),
            occlusion: true,
            anchors: true,
            lock_scale: false,
        }
    }
}

/// Rotations nearer than this are one candidate, on the coarse grid and on the middle one; radians.
const DISTINCT: [f64; 2] = [0.21, 0.105];

/// What a rotation of the grid, a step on the middle grid and one on the fine grid cost: milliseconds, as WebAssembly,
/// on a machine of 2020.
const COST_MS: [f64; 3] = [0.06, 0.12, 0.4];
/// Turns tried around a given pose, radians, and how many of them are refined.
const NEIGHBORHOOD: [f64; 2] = [0.17, 0.4];
const NEIGHBORS: usize = 7;

/// A search: the observation and the mesh, prepared.
pub struct Search {
    /// The frame that the poses are from.
    pub frame: MeshFrame,
    /// The mesh in that frame, as the finest grid sees it.
    pub mesh: Mesh,
    /// The cleaned observation.
    pub observation: CleanObservation,
    /// Images drawn so far.
    pub renders: usize,
    settings: SearchSettings,
    prior: Prior,
    /// Coarse, middle and fine.
    models: [Model; 3],
    canvas: Canvas,
}

/// A refined candidate.
#[derive(Debug, Clone, Copy)]
pub struct Found {
    /// The pose.
    pub pose: CropPose,
    /// Its score on the finest grid.
    pub score: Score,
    /// Whether its refinement came to rest.
    pub converged: bool,
}

impl Search {
    /// Cleans the observation and decimates the mesh. `None` where decimation leaves no triangle.
    pub fn new(observation: &Observation, mesh: &Mesh, settings: SearchSettings) -> Option<Self> {
        let frame = MeshFrame::of(mesh);
        let fine = frame.normalized(&decimate(mesh, settings.triangles[2]))?;
        let middle = decimate(&fine, settings.triangles[1]);
        let coarse = decimate(&middle, settings.triangles[0]);
        Some(Self {
            frame,
            observation: CleanObservation::new(observation),
            renders: 0,
            settings,
            prior: Prior::default(),
            models: [&coarse, &middle, &fine].map(Model::new),
            mesh: fine,
            canvas: Canvas::default(),
        })
    }

    /// Takes what is known beforehand into account from now on.
    pub fn assume(&mut self, prior: Prior) {
        self.prior = prior;
    }

    /// The best distinct rotations of the grid.
    pub fn coarse(&mut self) -> Vec<Candidate> {
        let grid = CropGrid::new(&self.observation, self.settings.cells[0]);
        let anchors = if self.settings.anchors {
            anchors::anchors(&grid, self.settings.occlusion)
        } else {
            vec![Anchor::AS_IT_IS]
        };
        let outermost = coarse::outermost(&self.models[2]);
        let stage = self.stage(&grid, &anchors);
        let count = self.settings.rotations;
        let mut canvas = Canvas::default();
        let candidates: Vec<Candidate> =
            (0..count).filter_map(|i| stage.best(&mut canvas, &outermost, super_fibonacci(i, count))).collect();
        self.renders += candidates.len() * anchors.len();
        distinct(candidates, self.settings.keep[0], DISTINCT[0])
    }

    /// A pose and its neighbourhood: turned about every axis, at its own distance and at that of the depths.
    pub fn around(&mut self, pose: CropPose) -> Vec<Candidate> {
        let grid = CropGrid::new(&self.observation, self.settings.cells[0]);
        let stage = self.stage(&grid, &[]);
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

    fn stage<'a>(&'a self, grid: &'a CropGrid, anchors: &'a [Anchor]) -> Coarse<'a> {
        Coarse {
            model: &self.models[0],
            grid,
            scoring: self.settings.scoring(&self.observation, 0),
            anchors,
            median_m: self.observation.median_m,
            prior: self.prior,
        }
    }

    /// The candidates refined on the middle grid, and the best of them on the fine one; best first.
    pub fn refine(&mut self, candidates: Vec<Candidate>) -> Vec<Found> {
        let poses = candidates.into_iter().map(|c| c.pose).collect();
        let middle = self.refine_on(1, poses, self.settings.keep[1]);
        self.refine_on(2, middle.into_iter().map(|f| f.pose).collect(), usize::MAX)
    }

    fn refine_on(&mut self, level: usize, poses: Vec<CropPose>, keep: usize) -> Vec<Found> {
        let grid = CropGrid::new(&self.observation, self.settings.cells[level]);
        let mut canvas = core::mem::take(&mut self.canvas);
        let refiner = self.refiner(&grid, level);
        let iterations = self.settings.iterations[level - 1];
        let refined: Vec<Refined> =
            poses.into_iter().map(|pose| refiner.refine(&mut canvas, pose, iterations)).collect();
        self.renders += refined.iter().map(|r| r.renders).sum::<usize>();
        self.canvas = canvas;
        let found = refined.iter().map(|r| Found { pose: r.pose, score: r.score, converged: r.converged });
        distinct(found.collect(), keep, DISTINCT[1])
    }

    fn refiner<'a>(&'a self, grid: &'a CropGrid, level: usize) -> Refiner<'a> {
        Refiner {
            model: &self.models[level],
            grid,
            scoring: self.settings.scoring(&self.observation, level),
            lock_scale: self.settings.lock_scale,
            prior: self.prior,
        }
    }

    /// The score of any pose on the finest grid.
    pub fn score(&self, pose: &CropPose) -> Score {
        let grid = CropGrid::new(&self.observation, self.settings.cells[2]);
        self.refiner(&grid, 2).score(&mut Canvas::default(), pose)
    }

    /// How firmly the observation holds a pose, and the root mean square of its depth residuals, metres.
    pub fn conditioning(&self, pose: &CropPose) -> (Option<Conditioning>, f64) {
        let grid = CropGrid::new(&self.observation, self.settings.cells[2]);
        let mut refiner = self.refiner(&grid, 2);
        refiner.lock_scale = false;
        let mut canvas = Canvas::default();
        let score = refiner.score(&mut canvas, pose);
        let equations = refiner.equations(&canvas, &score);
        (Conditioning::of(&equations, pose), refiner.depth_rms(&canvas))
    }
}

impl SearchSettings {
    /// Less of everything.
    pub fn fast() -> Self {
        Self {
            rotations: 600,
            keep: [12, 3],
            cells: [250, 700, 2500],
            triangles: [300, 1200, 4000],
            iterations: [10, 10],
            ..Self::default()
        }
    }

    /// More of everything.
    pub fn best() -> Self {
        Self { rotations: 4000, keep: [64, 10], iterations: [20, 20], ..Self::default() }
    }

    /// The search held to a bound of work, counted in milliseconds of a machine of 2020: the rotations and the
    /// candidates shrink, or grow, in proportion.
    pub fn within(self, budget_ms: f64) -> Self {
        let cost = COST_MS[0] * self.rotations as f64
            + COST_MS[1] * (self.keep[0] * self.iterations[0]) as f64
            + COST_MS[2] * (self.keep[1] * self.iterations[1]) as f64;
        let share = (budget_ms / cost).max(0.02).min(20.0);
        let scaled = |count: usize, least: usize| ((count as f64 * share) as usize).max(least);
        Self { rotations: scaled(self.rotations, 60), keep: [scaled(self.keep[0], 3), scaled(self.keep[1], 2)], ..self }
    }

    fn scoring(&self, clean: &CleanObservation, level: usize) -> Scoring {
        let mut weights = self.weights;
        // Outlines mean little on cells that are as wide as the errors of the rotation grid.
        weights.outline *= [0.0, 0.5, 1.0][level];
        let occluder_m = 0.02 * clean.diagonal_m + 0.005 * clean.median_m;
        Scoring {
            weights,
            depth_m: (self.depth_error[level] * clean.diagonal_m) as f32,
            occluder_m: if self.occlusion { occluder_m as f32 } else { f32::INFINITY },
            outline_cells: 2.0,
        }
    }
}

/// A pose with a score.
trait Scored: Copy {
    fn rotation(&self) -> DQuat;
    fn total(&self) -> f32;
}

impl Scored for Candidate {
    fn rotation(&self) -> DQuat {
        self.pose.rotation
    }

    fn total(&self) -> f32 {
        self.score.total
    }
}

impl Scored for Found {
    fn rotation(&self) -> DQuat {
        self.pose.rotation
    }

    fn total(&self) -> f32 {
        self.score.total
    }
}

/// The best `count` candidates of which no two rotations are nearer than `angle`, best first.
fn distinct<T: Scored>(candidates: Vec<T>, count: usize, angle: f64) -> Vec<T> {
    let mut keys: Vec<u64> = (0..).zip(&candidates).map(|(i, c)| order::pack(-c.total(), i)).collect();
    order::sort(&mut keys);
    let mut kept: Vec<T> = Vec::new();
    for key in keys {
        let candidate = candidates[order::index_of(key) as usize];
        if kept.len() >= count {
            break;
        }
        let turn = |k: &T| angle_between(k.rotation(), candidate.rotation());
        if kept.iter().all(|k| turn(k) > angle) {
            kept.push(candidate);
        }
    }
    kept
}
