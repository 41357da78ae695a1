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
use score::{Scoring, Weights};

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

/// What the search found, best first.
#[derive(Debug, Clone)]
pub struct Found {
    /// The frame that the poses are from.
    pub frame: MeshFrame,
    /// The finalists, on the fine grid.
    pub candidates: Vec<Candidate>,
    /// The cleaned observation.
    pub observation: CleanObservation,
    /// Images drawn.
    pub renders: usize,
}

/// Searches all rotations.
pub fn search(observation: &Observation, mesh: &Mesh, settings: &SearchSettings) -> Option<Found> {
    let frame = MeshFrame::of(mesh);
    let clean = CleanObservation::new(observation);
    let fine = decimate(mesh, settings.triangles[2]);
    let fine = frame.normalized(&fine)?;
    let middle = decimate(&fine, settings.triangles[1]);
    let coarse = decimate(&middle, settings.triangles[0]);
    let models = [coarse, middle, fine].map(|mesh| Model::new(&mesh));
    let mut canvas = Canvas::default();

    let grid = CropGrid::new(&clean, settings.cells[0]);
    let anchors = if settings.anchors {
        anchors::anchors(&grid, settings.occlusion)
    } else {
        vec![anchors::Anchor { zoom: 1.0, towards: [0.0; 2] }]
    };
    let stage = Coarse {
        model: &models[0],
        grid: &grid,
        scoring: settings.scoring(&clean, 0),
        anchors: &anchors,
        median_m: clean.median_m,
    };
    let outermost = coarse::outermost(&models[2]);
    let candidates: Vec<Candidate> = (0..settings.rotations)
        .filter_map(|i| stage.best(&mut canvas, &outermost, super_fibonacci(i, settings.rotations)))
        .collect();
    let mut candidates = distinct(candidates, settings.keep[0], DISTINCT[0]);

    for level in 1..3 {
        let grid = CropGrid::new(&clean, settings.cells[level]);
        let refiner = Refiner {
            model: &models[level],
            grid: &grid,
            scoring: settings.scoring(&clean, level),
            lock_scale: settings.lock_scale,
        };
        for candidate in &mut candidates {
            let (pose, score) = refiner.refine(&mut canvas, candidate.pose, settings.iterations[level - 1]);
            *candidate = Candidate { pose, score };
        }
        let keep = if level == 1 { settings.keep[1] } else { usize::MAX };
        candidates = distinct(candidates, keep, DISTINCT[1]);
    }
    Some(Found { frame, candidates, observation: clean, renders: 0 })
}

impl SearchSettings {
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

/// The score of any pose on the finest grid, as the search would see it.
pub fn score_of(observation: &Observation, mesh: &Mesh, pose: &CropPose, settings: &SearchSettings) -> Option<score::Score> {
    let frame = MeshFrame::of(mesh);
    let clean = CleanObservation::new(observation);
    let model = Model::new(&frame.normalized(&decimate(mesh, settings.triangles[2]))?);
    let grid = CropGrid::new(&clean, settings.cells[2]);
    let refiner = Refiner { model: &model, grid: &grid, scoring: settings.scoring(&clean, 2), lock_scale: false };
    Some(refiner.score(&mut Canvas::default(), pose))
}
