//! Rounds: a search as lists of tasks that do not depend on one another.
//!
//! The outcomes of a round's tasks, in their order, determine the next round; ties are broken by that order. So a search
//! can pause after any task without changing a bit of its result.

use super::anchors::{Anchor, anchors};
use super::coarse::Coarse;
use super::grid::CropGrid;
use super::pose::CropPose;
use super::ranking::{best_of, distinct};
use super::recipe::{COARSE, FINE, FIRST_REFINEMENT, RANKING, Round, Task};
use super::refine::Refiner;
use super::render::Canvas;
use super::search::{Found, Search};
use crate::geometry::rotations::super_fibonacci;
use crate::geometry::similarity::Similarity;

/// A search under way.
pub struct Rounds {
    /// What is searched.
    pub search: Search,
    /// Candidates of the ranking round, best first; empty before it has ended.
    pub found: Vec<Found>,
    /// Index of the present round.
    index: usize,
    /// The grid of the present round, unless that is the search's own fine grid.
    grid: CropGrid,
    /// Sizes and places that are tried for each rotation.
    anchors: Vec<Anchor>,
    /// Poses that the round's tasks begin at; the rotations of the first round need no list.
    poses: Vec<CropPose>,
    /// Outcomes of the round's tasks that are done, in their order, and how many tasks those are.
    outcomes: Vec<Found>,
    tasks_done: usize,
    /// Candidates that the grid of rotations did not find: one list goes before its own, the other after.
    others: [Vec<CropPose>; 2],
    /// The best of the last round, if it found any.
    best: Vec<Found>,
}

impl Rounds {
    /// Begins at the grid of rotations or, where the search is not `global`, with the surroundings of `initial` alone.
    pub fn new(mut search: Search, initial: Option<CropPose>, global: bool) -> Self {
        let around = initial.map_or_else(Vec::new, |pose| search.around(pose));
        let anchors = if global && search.settings.anchors {
            anchors(&search.grid(COARSE), search.settings.occlusion)
        } else {
            vec![Anchor::AS_IT_IS]
        };
        let index = if global { 0 } else { FIRST_REFINEMENT };
        Self {
            found: Vec::new(),
            index,
            grid: search.grid(search.settings.rounds[index].grid),
            anchors,
            poses: if global { Vec::new() } else { around.clone() },
            outcomes: Vec::new(),
            tasks_done: 0,
            others: [around, Vec::new()],
            best: Vec::new(),
            search,
        }
    }

    /// Adds the surroundings of a pose that was found otherwise to the candidates of the grid.
    pub fn join(&mut self, pose: CropPose) {
        self.others[1] = self.search.around(pose);
    }

    /// The present round; `None` when the search is over.
    pub fn round(&self) -> Option<Round> {
        let round = self.search.settings.rounds.get(self.index).copied();
        // Poses that were found otherwise join after the rounds on the grid of rotations, which may find none.
        round.filter(|_| self.index < FIRST_REFINEMENT || self.tasks() > 0)
    }

    /// Number of tasks of the present round.
    fn tasks(&self) -> usize {
        if self.index == 0 { self.search.settings.rotations() } else { self.poses.len() }
    }

    /// Does tasks of the present round until all are done, or until `pause` returns true, which is asked after each; then
    /// begins the next round. Returns whether the round has ended.
    pub fn run(&mut self, pause: &mut dyn FnMut() -> bool) -> bool {
        let Some(round) = self.round() else { return true };
        let search = &self.search;
        let grid = if round.grid == FINE { &search.fine } else { &self.grid };
        let objective = search.objective(round.grid, grid);
        let coarse = Coarse { objective, median_m: search.observation.median_m };
        let refiner = Refiner { objective, lock_scale: search.settings.lock_scale };
        let mut canvas = Canvas::default();
        let mut tried = Vec::new();
        while self.tasks_done < self.tasks() {
            let task = self.tasks_done;
            match round.task {
                Task::Rotate => {
                    let rotation = super_fibonacci(task, round.work);
                    coarse.try_anchors(&mut canvas, &search.mesh.outermost, rotation, &self.anchors, &mut tried);
                    self.outcomes.extend(tried.drain(..).map(Found::from));
                }
                Task::Place => self.outcomes.push(coarse.at_its_distance(&mut canvas, self.poses[task]).into()),
                Task::Refine => self.outcomes.push(refiner.refine(&mut canvas, self.poses[task], round.work).into()),
            }
            self.tasks_done += 1;
            if pause() && self.tasks_done < self.tasks() {
                return false;
            }
        }
        self.end_round(round);
        true
    }

    /// Chooses the poses of the next round.
    fn end_round(&mut self, round: Round) {
        let outcomes = core::mem::take(&mut self.outcomes);
        self.tasks_done = 0;
        self.search.renders += outcomes.iter().map(|f| f.renders).sum::<usize>();
        self.best = best_of(&outcomes, 1);
        match self.index {
            RANKING => {
                self.found = distinct(outcomes, usize::MAX, round.apart);
                self.poses = poses_of(&self.found[..round.keep.min(self.found.len())]);
            }
            index if index > RANKING => {
                // The scores stay those of the ranking: scores of different grids do not compare.
                for (best, polished) in self.found.iter_mut().zip(outcomes) {
                    best.pose = polished.pose;
                }
                self.poses = Vec::new();
            }
            _ => {
                let kept = if round.apart > 0.0 {
                    distinct(outcomes, round.keep, round.apart)
                } else {
                    best_of(&outcomes, round.keep)
                };
                self.poses = poses_of(&kept);
            }
        }
        self.index += 1;
        if self.index == FIRST_REFINEMENT {
            let [before, after] = core::mem::take(&mut self.others);
            self.poses = [before, core::mem::take(&mut self.poses), after].concat();
        }
        if let Some(next) = self.search.settings.rounds.get(self.index)
            && next.grid != round.grid
            && next.grid != FINE
        {
            self.grid = self.search.grid(next.grid);
        }
    }

    /// The best pose so far, and its score on the grid of its round: scores of different grids do not compare.
    pub fn best(&self) -> Option<(Similarity, f64)> {
        // After the ranking, the order is final.
        let best = self.found.first().or(self.best.first())?;
        Some((best.pose.similarity(&self.search.mesh.frame), f64::from(best.score.total)))
    }
}

fn poses_of(found: &[Found]) -> Vec<CropPose> {
    found.iter().map(|f| f.pose).collect()
}
