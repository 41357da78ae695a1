//! Rounds: a search as lists of tasks that do not depend on one another.
//!
//! What comes of a round's tasks, put in their order, determines the next round; equal scores are told apart by that
//! order. So a round can be done in parts, by anyone and in any order, and no bit of the result tells who did what.

use glam::Vec3;

use super::anchors::{Anchor, anchors};
use super::coarse::{Coarse, outermost};
use super::grid::CropGrid;
use super::pose::CropPose;
use super::ranking::{best_of, distinct};
use super::refine::Refiner;
use super::render::Canvas;
use super::search::{Found, Search};
use super::settings::{COARSE, FINE, FINEST, MIDDLE, SIEVE};
use crate::geometry::rotations::super_fibonacci;
use crate::geometry::similarity::Similarity;

/// Rotations nearer than this are one candidate, on the coarse grid and on the middle one; radians.
const DISTINCT: [f64; 2] = [0.21, 0.105];

/// The grid of each round: every rotation, the promising ones, the four refinements.
const LEVEL: [usize; 6] = [SIEVE, COARSE, MIDDLE, MIDDLE, FINE, FINEST];
/// The first round of the refinement.
const FIRST_REFINEMENT: usize = 2;
/// The round whose scores poses are compared by in the end.
const COMPARED: usize = 4;

/// A search under way.
pub struct Rounds {
    /// What is searched.
    pub search: Search,
    /// The present round, from 0.
    pub round: usize,
    grid: CropGrid,
    /// Sizes and places tried for each rotation, and what the mesh's boxes touch.
    anchors: Vec<Anchor>,
    outermost: Vec<Vec3>,
    /// Where the round's tasks begin; of the first round, whose rotations need no list, nowhere.
    poses: Vec<CropPose>,
    /// Candidates that the grid of rotations did not find: before its own, and after.
    others: [Vec<CropPose>; 2],
    /// What was found, best first, once no task is left.
    pub found: Vec<Found>,
    /// The best of the last round, if it found any.
    best: Vec<Found>,
}

impl Rounds {
    /// Begins at the grid of rotations, or, where the search is not `global`, with the surroundings of `initial` alone.
    pub fn new(mut search: Search, initial: Option<CropPose>, global: bool) -> Self {
        let around = initial.map_or_else(Vec::new, |pose| search.around(pose));
        let anchors = if global && search.settings.anchors {
            anchors(&search.grid(COARSE), search.settings.occlusion)
        } else {
            vec![Anchor::AS_IT_IS]
        };
        let round = if global { 0 } else { FIRST_REFINEMENT };
        Self {
            round,
            grid: search.grid(LEVEL[round]),
            anchors,
            outermost: outermost(&search.models[FINE]),
            poses: if global { Vec::new() } else { around.clone() },
            others: [around, Vec::new()],
            found: Vec::new(),
            best: Vec::new(),
            search,
        }
    }

    /// A pose found otherwise, whose surroundings join the candidates of the grid.
    pub fn join(&mut self, pose: CropPose) {
        self.others[1] = self.search.around(pose);
    }

    /// Whether all that is left is refinement.
    pub fn is_refinement(&self) -> bool {
        self.round >= FIRST_REFINEMENT
    }

    /// How many tasks this round has; 0 when there is nothing left to do.
    pub fn tasks(&self) -> usize {
        if self.round == 0 { self.search.settings.rotations } else { self.poses.len() }
    }

    /// Does a part of this round's tasks: every `parts`-th, the first of them being `part`.
    pub fn run(&self, part: usize, parts: usize) -> Vec<Found> {
        let mut canvas = Canvas::default();
        let level = LEVEL[self.round.min(LEVEL.len() - 1)];
        let grid = if level == FINE { &self.search.fine } else { &self.grid };
        let objective = self.search.objective(level, grid);
        let stage = Coarse { objective, median_m: self.search.observation.median_m };
        let refiner = Refiner { objective, lock_scale: self.search.settings.lock_scale };
        let count = self.search.settings.rotations;
        let (mut tried, mut found) = (Vec::new(), Vec::new());
        for task in (part..self.tasks()).step_by(parts.max(1)) {
            let pose = || self.poses[task];
            match self.round {
                0 => {
                    let rotation = super_fibonacci(task, count);
                    stage.try_anchors(&mut canvas, &self.outermost, rotation, &self.anchors, &mut tried);
                    found.extend(tried.drain(..).map(Found::from));
                }
                1 => found.push(stage.at_its_distance(&mut canvas, pose()).into()),
                round => {
                    let iterations = self.search.settings.iterations[(round - FIRST_REFINEMENT).min(3)];
                    found.push(refiner.refine(&mut canvas, pose(), iterations).into());
                }
            }
        }
        found
    }

    /// Does all of this round's tasks, and begins the next one.
    pub fn step(&mut self) {
        let found = self.run(0, 1);
        self.advance(found);
    }

    /// Takes what came of all tasks, in their order, and begins the next round.
    pub fn advance(&mut self, found: Vec<Found>) {
        self.search.renders += found.iter().map(|f| f.renders).sum::<usize>();
        let best = best_of(&found, 1);
        let keep = self.search.settings.keep;
        self.poses = match self.round {
            0 => poses_of(&best_of(&found, keep[0])),
            1 => {
                let [before, after] = core::mem::take(&mut self.others);
                [before, poses_of(&distinct(found, keep[1], DISTINCT[0])), after].concat()
            }
            2 => poses_of(&distinct(found, keep[2], DISTINCT[1])),
            3 => poses_of(&distinct(found, keep[3], DISTINCT[1])),
            COMPARED => {
                self.found = distinct(found, usize::MAX, DISTINCT[1]);
                poses_of(&self.found[..keep[4].min(self.found.len())])
            }
            _ => {
                // The scores stay those of the fine grid: scores of different grids do not compare.
                for (best, polished) in self.found.iter_mut().zip(found) {
                    best.pose = polished.pose;
                }
                Vec::new()
            }
        };
        self.best = best;
        self.round += 1;
        // The middle grid serves two rounds, and the fine one is the search's own.
        if let Some(level @ (&COARSE | &MIDDLE | &FINEST)) = LEVEL.get(self.round).filter(|_| self.round != 3) {
            self.grid = self.search.grid(*level);
        }
    }

    /// The best pose so far, and its score on the grid of its round: scores of different grids do not compare.
    pub fn best(&self) -> Option<(Similarity, f64)> {
        // Once there is an order for good, its first.
        let best = self.found.first().or(self.best.first())?;
        Some((best.pose.similarity(&self.search.frame), f64::from(best.score.total)))
    }

    /// Draws what was found once more, for all terms of its scores; to be called after every round.
    pub fn complete_scores(&mut self) {
        if self.round == COMPARED + 1 {
            self.found.iter_mut().for_each(|found| found.score = self.search.score(&found.pose));
        }
    }
}

fn poses_of(found: &[Found]) -> Vec<CropPose> {
    found.iter().map(|f| f.pose).collect()
}
