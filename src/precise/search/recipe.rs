//! The recipe of the search: grids and rounds for each effort.

use super::cascade::Stage;
use crate::precise::drawing::turns::TURNS;
use crate::precise::observation::clean::CleanObservation;
pub use crate::precise::observation::{COARSE, FINE, FINEST, GRIDS, Grid, MIDDLE, SIEVE};
use crate::precise::scoring::score::{Scoring, Weights};
use crate::report::Effort;

/// Rounds of the search.
pub const ROUNDS: usize = 7;

/// The task of a round for each of its poses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Task {
    /// Renders a rotation of an even grid, at the size and position of the mask's box and of every other anchor.
    Rotate,
    /// Renders the pose, and moves it to the distance that fits the depths.
    Place,
    /// Refines all seven parameters.
    Refine,
    /// Refines a half or quarter turn of the best pose.
    Turn,
    /// Refines all seven parameters and the proportions of the mesh. The scores of the first round of this task rank the
    /// poses, and are those of the result.
    Fit,
}

impl Task {
    /// Whether its poses come from the rotation grid.
    pub fn is_on_rotation_grid(self) -> bool {
        matches!(self, Self::Rotate | Self::Place)
    }
}

/// A round: the same task for many poses, of which the best are kept for the next round.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Round {
    /// The task.
    pub task: Task,
    /// Index of the grid.
    pub grid: usize,
    /// Number of rotations of [`Task::Rotate`], maximum number of steps of the tasks that refine.
    pub work: usize,
    /// Number of poses kept for the next round.
    pub keep: usize,
    /// Of poses whose rotations are closer than this, in radians, only the best is kept; 0 keeps all.
    pub apart: f64,
    /// Progress of the search after the round, 0 to 1; from profiles of real cases.
    pub done: f64,
}

/// The grids of an effort.
#[rustfmt::skip]
const fn grids(effort: Effort) -> [Grid; GRIDS] {
    let q = effort as usize;
    //     mask cells: fast, balanced, best      triangles: fast, balanced, best           depth error        normals       outline
    [
        Grid { cells: [ 120,  150,  150][q], triangles: [ 150,    200,    200][q], depth_error: 0.12, normals: 1.0, outline: 0.0 },
        Grid { cells: [ 400,  500,  500][q], triangles: [ 500,    700,    700][q], depth_error: 0.12, normals: 1.0, outline: 0.0 },
        Grid { cells: [ 700,  900,  900][q], triangles: [1000,   1500,   1500][q], depth_error: 0.06, normals: 1.0, outline: 0.5 },
        Grid { cells: [2000, 3000, 3000][q], triangles: [3000,   5000,   5000][q], depth_error: 0.03, normals: 1.0, outline: 1.0 },
        Grid { cells: [4000, 7000, 7000][q], triangles: [5000, 10_000, 10_000][q], depth_error: 0.01, normals: 2.0, outline: 1.0 },
    ]
}

/// The rounds of an effort.
#[rustfmt::skip]
const fn rounds(effort: Effort) -> [Round; ROUNDS] {
    use Task::{Fit, Place, Refine, Rotate, Turn};
    let q = effort as usize;
    //       task          grid          work: fast, balanced, best   keep: fast, balanced, best  apart         done
    [
        Round { task: Rotate, grid: SIEVE,  work: [600, 1500, 4000][q], keep: [120, 500, 1600][q], apart: 0.0,   done: 0.51 },
        Round { task: Place,  grid: COARSE, work: 1,                    keep: [ 20,  64,  160][q], apart: 0.21,  done: 0.62 },
        Round { task: Refine, grid: MIDDLE, work: [  4,    4,    5][q], keep: [  6,  20,   40][q], apart: 0.105, done: 0.78 },
        Round { task: Refine, grid: MIDDLE, work: [  5,    8,   15][q], keep: [  3,   6,   10][q], apart: 0.105, done: 0.89 },
        Round { task: Turn,   grid: MIDDLE, work: [  4,    5,    8][q], keep: [  3,   3,   16][q], apart: 0.21,  done: 0.92 },
        Round { task: Fit,    grid: FINE,   work: [  8,   12,   20][q], keep: [  1,   1,    2][q], apart: 0.105, done: 0.97 },
        Round { task: Fit,    grid: FINEST, work: [  4,    6,   12][q], keep: 0,                   apart: 0.0,   done: 1.0 },
    ]
}

/// Number of the best poses that are turned, by effort: of one pose, the half and quarter turns; of more, those and the
/// rolls about every axis that explain the image best.
const TURNED: [usize; 3] = [1, 1, 3];
/// Number of turns that are refined where more than one pose is turned.
const ROLLS: usize = 24;

/// Maximum number of steps per turn, and of turns that are ranked, of a search whose work is limited: turns are not scaled.
const LIMITED_TURNS: [usize; 2] = [6, 6];

/// Work and poses kept of the rounds of a search for rivals, which ends with them.
const RIVAL_SEARCH: [[usize; 2]; 4] = [[300, 40], [1, 6], [4, 3], [5, 0]];

/// Hypotheses of several views with known camera poses: every one of them coarsely; then the best, and turns of the best of
/// these.
pub const JOINT: [Stage; 2] =
    [Stage { grid: COARSE, steps: 0, keep: 16, apart: 0.21 }, Stage { grid: MIDDLE, steps: 6, keep: 4, apart: 0.105 }];
/// Their ranking, whose scores are those of the result, and the refinement of the best one.
pub const JOINT_RANKING: Stage = Stage { grid: FINE, steps: 12, keep: usize::MAX, apart: 0.105 };
/// See [`JOINT_RANKING`].
pub const JOINT_POLISH: Stage = Stage::of_one(FINEST, 8);
/// Poses of one view at the size that all views have in common, whose camera poses are not known.
pub const COMMON_SIZE: [Stage; 2] = [Stage::of_one(FINE, 14), Stage::of_one(FINEST, 8)];
/// Poses that are expected of a tracked object, at its size.
pub const TRACKED: [Stage; 3] = [Stage::of_one(MIDDLE, 0), Stage::of_one(MIDDLE, 7), Stage::of_one(FINE, 6)];
/// Lookalikes whose colours are compared, and the pose that colour chooses.
pub const COLORED: [Stage; 2] = [Stage::of_one(MIDDLE, 4), Stage::of_one(FINEST, 6)];

/// Distance between two outlines that halves their agreement, cells.
const OUTLINE_CELLS: f32 = 2.0;
/// Least and most factor by which a work budget scales a search.
const SCALING: [f64; 2] = [0.02, 20.0];

/// Minimum number of rotations of a search whose work is limited.
pub const MIN_ROTATIONS: usize = 60;

/// Confidence from which on a search with little effort is not followed by one with more.
pub const SURE: f64 = 0.93;
/// The same, of a search that assumes that nothing cuts the mask: it leaves out poses that may be better.
pub const SURE_UNCUT: f64 = 0.965;

/// Cost of a rotation, of a step on the middle grid and of one on the fine grid, in units of the work budget: about a
/// millisecond of WebAssembly each on a 2020 laptop.
const COST: [f64; 3] = [0.06, 0.12, 0.4];

/// Cost from which on searches are worth the copies and preparations of helpers.
const LONG: f64 = 150.0;

/// [`SearchSettings::max_load`], and the one with a bound on the work of the search.
const MAX_LOAD: [u64; 2] = [64, 12];

/// Work and objective of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SearchSettings {
    /// The column of the tables.
    pub effort: Effort,
    /// The rounds, in order.
    pub rounds: [Round; ROUNDS],
    /// The grids, coarse to fine.
    pub grids: [Grid; GRIDS],
    /// Weights of the score's terms.
    pub weights: Weights,
    /// Whether refinement keeps the scale of the rotation grid.
    pub lock_scale: bool,
    /// Number of the best poses that are turned.
    pub turned: usize,
    /// Maximum work of a round, relative to the cells of the mask and the triangles of all its renders. Ordinary inputs
    /// take about five times as much, a thin diagonal object fifty times.
    pub max_load: u64,
}

impl From<Effort> for SearchSettings {
    fn from(effort: Effort) -> Self {
        Self {
            effort,
            rounds: rounds(effort),
            grids: grids(effort),
            weights: Weights::default(),
            lock_scale: false,
            turned: TURNED[effort as usize],
            max_load: MAX_LOAD[0],
        }
    }
}

impl SearchSettings {
    /// Number of rotations of the grid.
    pub fn rotations(&self) -> usize {
        self.rounds[0].work
    }

    /// The settings of a search among the poses that one with these settings has found: the same grids, so that scores
    /// are comparable, and the rounds of the least effort or, where that search was unsure, of the next one.
    pub fn again(self, is_sure: bool) -> Self {
        let effort = if is_sure || self.effort == Effort::Fast { Effort::Fast } else { Effort::Balanced };
        Self { rounds: rounds(effort), turned: TURNED[effort as usize], ..self }
    }

    /// The settings of a search for rivals of a pose that another search is sure of: few rotations, refined on the middle grid only.
    pub fn of_rival_search(self) -> Self {
        let mut look = Self { turned: 1, ..self };
        for (round, [work, keep]) in look.rounds.iter_mut().zip(RIVAL_SEARCH) {
            (round.work, round.keep) = (work, keep);
        }
        look
    }

    /// The work of the search, in units of the work budget.
    pub fn cost(&self) -> f64 {
        let [rotate, place, first, second, _, fine, _] = self.rounds;
        self.cost_of_turns()
            + COST[0] * rotate.work as f64
            + COST[1] * (place.keep * first.work + first.keep * second.work) as f64
            + COST[2] * (second.keep * fine.work) as f64
    }

    /// Whether helpers make so many of these searches faster.
    pub fn is_long(&self, searches: usize) -> bool {
        self.cost() * searches as f64 > LONG
    }

    /// Number of turns that are refined.
    pub fn turns(&self) -> usize {
        if self.turned > 1 { ROLLS } else { TURNS }
    }

    /// The part of the work that a budget does not scale.
    fn cost_of_turns(&self) -> f64 {
        let [.., turn, fine, _] = self.rounds;
        COST[1] * (self.turns() * turn.work) as f64 + COST[2] * (turn.keep * fine.work) as f64
    }

    /// The settings with rotations and candidates scaled to a budget of work. Work is counted, not timed, so that results
    /// do not depend on the machine.
    pub fn within(self, budget: f64) -> Self {
        let mut within = Self { max_load: MAX_LOAD[1], turned: 1, ..self };
        for turn in within.rounds.iter_mut().filter(|round| round.task == Task::Turn) {
            (turn.work, turn.keep) = (turn.work.min(LIMITED_TURNS[0]), turn.keep.min(LIMITED_TURNS[1]));
        }
        let turns = within.cost_of_turns();
        let share = ((budget - turns) / (within.cost() - turns)).clamp(SCALING[0], SCALING[1]);
        let scaled = |count: usize, least: usize| ((count as f64 * share) as usize).max(least);
        within.rounds[0].work = scaled(self.rotations(), MIN_ROTATIONS);
        for (round, least) in within.rounds.iter_mut().zip([30, 6, 3, 2]) {
            round.keep = scaled(round.keep, least);
        }
        within
    }

    /// The objective on one of the grids.
    pub fn scoring(&self, clean: &CleanObservation, grid: usize) -> Scoring {
        let Grid { depth_error, normals, outline, .. } = self.grids[grid];
        let mut weights = self.weights;
        weights.normals *= normals;
        weights.outline *= outline;
        Scoring {
            weights,
            depth_m: (depth_error * clean.diagonal_m) as f32,
            occluder_m: clean.occluder_m() as f32,
            outline_cells: OUTLINE_CELLS,
        }
    }
}
