//! Search by rendering: the pose whose picture explains mask, free space and depth best.
//!
//! Coarse to fine on a crop around the mask. A grid of rotations, each with size, place and distance in closed form;
//! the best distinct ones refined over all seven parameters; the best of those refined again where every pixel
//! counts.

pub mod anchors;
pub mod clean;
pub mod coarse;
pub mod grid;
pub mod pose;
pub mod refine;
pub mod render;
pub mod rim;
pub mod score;

use crate::geometry::decimate::decimate;
use crate::geometry::mesh::Mesh;
use crate::geometry::order;
use crate::geometry::rotations::{angle_between, super_fibonacci};
use crate::stages::observe::Observation;

use clean::CleanObservation;
use coarse::{Candidate, Coarse};
use grid::CropGrid;
use pose::{CropPose, MeshFrame};
use refine::Refiner;
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

/// A search: the observation and the mesh, prepared.
pub struct Search {
    /// The frame that the poses are from.
    pub frame: MeshFrame,
    /// The cleaned observation.
    pub observation: CleanObservation,
    /// Images drawn so far.
    pub renders: usize,
    settings: SearchSettings,
    /// Coarse, middle and fine.
    models: [Model; 3],
    canvas: Canvas,
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
            models: [coarse, middle, fine].map(|mesh| Model::new(&mesh)),
            canvas: Canvas::default(),
        })
    }

    /// The best distinct rotations of the grid.
    pub fn coarse(&mut self) -> Vec<Candidate> {
        let settings = &self.settings;
        let grid = CropGrid::new(&self.observation, settings.cells[0]);
        let anchors = if settings.anchors {
            anchors::anchors(&grid, settings.occlusion)
        } else {
            vec![anchors::Anchor { zoom: 1.0, towards: [0.0; 2] }]
        };
        let stage = Coarse {
            model: &self.models[0],
            grid: &grid,
            scoring: settings.scoring(&self.observation, 0),
            anchors: &anchors,
            median_m: self.observation.median_m,
        };
        let outermost = coarse::outermost(&self.models[2]);
        let candidates: Vec<Candidate> = (0..settings.rotations)
            .filter_map(|i| stage.best(&mut self.canvas, &outermost, super_fibonacci(i, settings.rotations)))
            .collect();
        self.renders += candidates.len() * anchors.len();
        distinct(candidates, settings.keep[0], DISTINCT[0])
    }

    /// The candidates refined on the middle grid, and the best of them on the fine one; best first.
    pub fn refine(&mut self, mut candidates: Vec<Candidate>) -> Vec<Candidate> {
        for level in 1..3 {
            let settings = &self.settings;
            let grid = CropGrid::new(&self.observation, settings.cells[level]);
            let refiner = Refiner {
                model: &self.models[level],
                grid: &grid,
                scoring: settings.scoring(&self.observation, level),
                lock_scale: settings.lock_scale,
            };
            for candidate in &mut candidates {
                let (pose, score) = refiner.refine(&mut self.canvas, candidate.pose, settings.iterations[level - 1]);
                *candidate = Candidate { pose, score };
            }
            let keep = if level == 1 { settings.keep[1] } else { usize::MAX };
            candidates = distinct(candidates, keep, DISTINCT[1]);
        }
        candidates
    }

    /// The score of any pose on the finest grid.
    pub fn score(&mut self, pose: &CropPose) -> Score {
        let grid = CropGrid::new(&self.observation, self.settings.cells[2]);
        let scoring = self.settings.scoring(&self.observation, 2);
        Refiner { model: &self.models[2], grid: &grid, scoring, lock_scale: false }.score(&mut self.canvas, pose)
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

/// The best `count` candidates of which no two rotations are nearer than `angle`, best first.
fn distinct(candidates: Vec<Candidate>, count: usize, angle: f64) -> Vec<Candidate> {
    let mut keys: Vec<u64> =
        (0..).zip(&candidates).map(|(i, c)| order::pack(-c.score.total, i)).collect();
    order::sort(&mut keys);
    let mut kept: Vec<Candidate> = Vec::new();
    for key in keys {
        let candidate = candidates[order::index_of(key) as usize];
        if kept.len() >= count {
            break;
        }
        let turn = |k: &Candidate| angle_between(k.pose.rotation, candidate.pose.rotation);
        if kept.iter().all(|k| turn(k) > angle) {
            kept.push(candidate);
        }
    }
    kept
}

