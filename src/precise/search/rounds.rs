//! Rounds: a search as lists of independent tasks.
//!
//! The results of a round, in the order of its tasks, determine the next round; ties are broken by that order.

use std::borrow::Cow;

use glam::DQuat;

use super::problem::Search;
use super::ranking::{Found, best_of, distinct_up_to};
use super::recipe::{FINE, MIN_ROTATIONS, ROUNDS, Round, Task};
use super::tasks::{Outcome, RoundTasks};
use crate::geometry::rotations::super_fibonacci;
use crate::geometry::similarity::Similarity;
use crate::precise::drawing::pose::CropPose;
use crate::precise::observation::anchors::Anchor;
use crate::scheduler::{Boxed, Scheduler, boxed};

/// Score below the best pose at which a refined turn of it is not ranked.
const NEAR: f32 = 0.3;
/// The same, where several poses are turned: after an unsure search, whose best pose is more often wrong.
const UNSURE: f32 = 0.5;

/// Rotation from the best pose from which on a pose is elsewhere, radians.
pub const ELSEWHERE: f64 = 0.5;
/// Lead over all poses elsewhere from which on the best pose has no rival. Of 660 sure searches, the 11 with a rival led by
/// at most 0.08, and 8 % by less than this.
const DECIDED: f32 = 0.15;

/// The best of this many rotations are followed by the next search.
const HOPEFUL: usize = 4;

/// Rotation by which a search may refine a pose of another one, radians.
const SAME: f64 = 0.25;

/// Rotations after which the work of a round on the rotation grid is known.
const PROBED_ROTATIONS: usize = 16;

/// The work of a round on the rotation grid, where it is more than its allowance.
struct TooLong(u64);

/// A running search.
pub struct Rounds {
    /// The search.
    pub search: Search,
    /// Candidates of the ranking round, best first; empty until it has ended.
    pub found: Vec<Found>,
    /// Index of the current round.
    index: usize,
    /// The rotations of the first round, if they are not those of the rotation grid.
    rotations: Vec<DQuat>,
    /// Sizes and positions tried for each rotation.
    anchors: Vec<Anchor>,
    /// Initial poses of the tasks of the round; the rotations of the first round need no list.
    poses: Vec<CropPose>,
    /// Candidates from other sources than the rotation grid, which precede those of the grid.
    others: Vec<CropPose>,
    /// The best candidate of the last round, if any.
    best: Vec<Found>,
    /// Candidates of the ranking round other than turns of the best one.
    unturned: Vec<CropPose>,
    /// The best pose of each rotation of the first round, best first.
    tried: Vec<Found>,
    /// See [`Self::is_contested`].
    lead: Option<f32>,
}

impl Rounds {
    /// Starts with the rotation grid or, if the search is not `global`, only with the neighbourhood of `initial`.
    pub fn new(mut search: Search, initial: Option<CropPose>, global: bool) -> Self {
        let around = initial.map_or_else(Vec::new, |pose| search.around(pose));
        let anchors = if global { search.anchors() } else { vec![Anchor::AS_IT_IS] };
        let is_searched = |round: &Round| !global && round.task.is_on_rotation_grid();
        let index = search.settings.rounds.iter().take_while(|round| is_searched(round)).count();
        Self {
            found: Vec::new(),
            index,
            rotations: Vec::new(),
            anchors,
            poses: if global { Vec::new() } else { around.clone() },
            others: around,
            best: Vec::new(),
            unturned: Vec::new(),
            tried: Vec::new(),
            lead: None,
            search,
        }
    }

    /// Starts with these rotations instead of the rotation grid.
    pub fn among(search: Search, rotations: Vec<DQuat>) -> Self {
        let mut rounds = Self::new(search, None, true);
        rounds.rotations = rotations;
        rounds
    }

    /// A search that has ended with these candidates.
    pub fn ended(search: Search, found: Vec<Found>) -> Self {
        let mut rounds = Self::new(search, None, false);
        (rounds.found, rounds.index) = (found, ROUNDS);
        rounds
    }

    /// Puts the candidate that is nearest to the best one of another search first, unless it is first. Returns whether the
    /// order has changed.
    pub fn prefer(&mut self, found: &[Found]) -> bool {
        let Some(best) = found.first() else { return false };
        let angle = |f: &Found| f.pose.rotation.angle_between(best.pose.rotation);
        let near = self.found.iter().position(|f| angle(f) < SAME);
        if let Some(place) = near.filter(|place| *place > 0) {
            self.found[..=place].rotate_right(1);
            return true;
        }
        false
    }

    /// Keeps the rotations of the grid whose nearest rotation in the first round of `previous` was among its best.
    pub fn follow(&mut self, previous: &Self) {
        let hopeful = previous.tried.len() / HOPEFUL;
        let is_promising = |rotation: &DQuat| {
            let (mut nearest, mut most) = (0, 0.0);
            for (i, tried) in previous.tried.iter().enumerate() {
                let cosine = tried.pose.rotation.dot(*rotation).abs();
                if cosine > most {
                    (nearest, most) = (i, cosine);
                }
            }
            nearest < hopeful
        };
        let count = self.search.settings.rotations();
        self.rotations = (0..count).map(|i| super_fibonacci(i, count)).filter(is_promising).collect();
    }

    /// Adds poses that another search has refined to the candidates of the grid.
    pub fn resume(&mut self, found: &[Found]) {
        self.propose(poses_of(found));
    }

    /// Adds poses from another source to those of the first refinement.
    pub fn propose(&mut self, poses: impl IntoIterator<Item = CropPose>) {
        let list = if self.is_on_rotation_grid() { &mut self.others } else { &mut self.poses };
        list.extend(poses);
    }

    /// The work of the current round that its inputs may ask for; see [`Outcome::work`].
    fn allowed(&self, round: Round) -> u64 {
        let settings = &self.search.settings;
        let per_task = match round.task {
            Task::Rotate => self.anchors.len(),
            Task::Place => 1,
            Task::Refine | Task::Fit => round.work + 1,
            Task::Turn => round.work + 2,
        };
        let grid = settings.grids[round.grid];
        settings.max_load * (self.tasks() * per_task * (grid.cells + grid.triangles)) as u64
    }

    /// Whether the mask has a cell on the grid of the current round and on the fine one.
    pub fn shows_mask(&self) -> bool {
        let of_round = self.round().map_or(FINE, |round| round.grid);
        [of_round, FINE].into_iter().all(|grid| self.search.grid(grid).mask_cells > 0)
    }

    /// The current round; `None` after the end of the search.
    pub fn round(&self) -> Option<Round> {
        let round = self.search.settings.rounds.get(self.index).copied();
        // Poses from other sources are added after the rounds on the rotation grid, which may find none.
        round.filter(|_| self.is_on_rotation_grid() || self.tasks() > 0)
    }

    fn is_on_rotation_grid(&self) -> bool {
        self.task().is_some_and(Task::is_on_rotation_grid)
    }

    /// The task of the current round.
    fn task(&self) -> Option<Task> {
        self.search.settings.rounds.get(self.index).map(|round| round.task)
    }

    /// The poses with which the current round starts; empty in the first round.
    pub fn poses(&self) -> &[CropPose] {
        &self.poses
    }

    /// Number of tasks of the current round.
    fn tasks(&self) -> usize {
        match self.task() {
            Some(Task::Rotate) if !self.rotations.is_empty() => self.rotations.len(),
            Some(Task::Rotate) => self.search.settings.rotations(),
            _ => self.poses.len(),
        }
    }

    /// Runs the current round, with a yield point after each of its tasks, and begins the next one.
    pub fn run<'a>(&'a mut self, scheduler: &'a Scheduler) -> Boxed<'a, ()> {
        boxed(async move {
            let Some(mut round) = self.round() else { return };
            let allowance = self.allowed(round);
            let outcomes = loop {
                match self.outcomes(round, allowance, scheduler).await {
                    Ok(outcomes) => break outcomes,
                    Err(TooLong(work)) => round = self.rotate_less(work, allowance),
                }
            };
            self.end_round(round, outcomes);
        })
    }

    /// The results of the tasks of a round, in order, of as many as its allowance is enough for.
    async fn outcomes(&self, round: Round, allowance: u64, scheduler: &Scheduler) -> Result<Vec<Found>, TooLong> {
        let search = &self.search;
        let tasks = RoundTasks {
            view: search.view,
            effort: search.settings.effort,
            is_surrounded: search.is_surrounded(),
            task: round.task,
            grid: round.grid,
            work: round.work,
            best: self.best.first().map(|best| best.score.total),
            rotations: Cow::Borrowed(&self.rotations),
            poses: Cow::Borrowed(&self.poses),
        };
        let count = tasks.count();
        let (mut work, mut done, mut too_long) = (0, 0, None);
        let ends = |outcome: &Outcome| {
            work += outcome.work;
            done += 1;
            if round.task != Task::Rotate {
                // The poses are sorted, so that the best ones have had their turn.
                return work > allowance;
            }
            let all = work * count as u64 / done as u64;
            if done == PROBED_ROTATIONS && all > allowance && count > MIN_ROTATIONS {
                too_long = Some(TooLong(all));
            }
            too_long.is_some()
        };
        let outcomes = scheduler.run_tasks(&mut tasks.on(search), ends).await;
        too_long.map_or_else(|| Ok(outcomes.into_iter().flat_map(|outcome| outcome.found).collect()), Err)
    }

    /// Reduces the rotation grid to as many rotations as are allowed if all of them take this much `work`. The first
    /// rotations of a grid are close to one another, so that the round cannot just end early.
    fn rotate_less(&mut self, work: u64, allowance: u64) -> Round {
        let rotations = (self.tasks() as u64 * allowance / work.max(1)) as usize;
        let rotations = rotations.max(MIN_ROTATIONS);
        let list = &self.rotations;
        self.rotations = (0..rotations).filter_map(|i| list.get(i * list.len() / rotations).copied()).collect();
        let round = &mut self.search.settings.rounds[self.index];
        round.work = rotations;
        *round
    }

    /// Selects the poses of the next round.
    fn end_round(&mut self, round: Round, outcomes: Vec<Found>) {
        let equivalence = &self.search.equivalence;
        self.search.renders += outcomes.iter().map(|f| f.renders).sum::<usize>();
        let best = core::mem::replace(&mut self.best, best_of(&outcomes, 1));
        if round.task == Task::Rotate {
            for of_rotation in outcomes.chunks(self.anchors.len()) {
                self.tried.extend(best_of(of_rotation, 1));
            }
            self.tried = best_of(&self.tried, outcomes.len());
        }
        if round.task == Task::Refine && self.lead.is_none() {
            let lead = match distinct_up_to(equivalence, outcomes.clone(), 2, ELSEWHERE).as_slice() {
                // Around an initial pose alone, nothing is known of poses elsewhere.
                _ if best.is_empty() => 0.0,
                [best, other] => best.score.total - other.score.total,
                _ => f32::INFINITY,
            };
            self.lead = Some(lead);
        }
        match round.task {
            Task::Turn => {
                // Of the same grid, so that their scores are comparable.
                self.best = best_of(&[best.as_slice(), self.best.as_slice()].concat(), 1);
                let near = if self.search.settings.turned > 1 { UNSURE } else { NEAR };
                let least = best.first().map_or(0.0, |best| best.score.total) - near;
                let alike = outcomes.into_iter().filter(|turned| turned.score.total > least).collect();
                self.poses = core::mem::take(&mut self.unturned);
                self.poses.extend(poses_of(&distinct_up_to(equivalence, alike, round.keep, round.apart)));
            }
            Task::Fit if self.found.is_empty() => {
                self.found = distinct_up_to(equivalence, outcomes, usize::MAX, round.apart);
                self.poses = poses_of(&self.found[..round.keep.min(self.found.len())]);
            }
            Task::Fit => {
                // Keeps the scores of the ranking, because scores of different grids are not comparable.
                for (best, polished) in self.found.iter_mut().zip(outcomes) {
                    best.pose = polished.pose;
                    best.converged |= polished.converged;
                }
                self.poses = Vec::new();
            }
            // The last round of a search that is not ranked.
            _ if round.keep == 0 => {
                self.found = distinct_up_to(equivalence, outcomes, usize::MAX, round.apart);
                self.poses = Vec::new();
            }
            _ => {
                let kept = if round.apart > 0.0 {
                    distinct_up_to(equivalence, outcomes, round.keep, round.apart)
                } else {
                    best_of(&outcomes, round.keep)
                };
                self.poses = poses_of(&kept);
            }
        }
        self.index += 1;
        if self.task() == Some(Task::Turn) {
            let turned = self.search.turned(&self.poses, &self.anchors);
            self.unturned = core::mem::replace(&mut self.poses, turned);
        }
        if round.task == Task::Place {
            self.poses.splice(0..0, core::mem::take(&mut self.others));
        }
    }

    /// Whether a pose elsewhere came close to the best one when the candidates of the rotation grid were first refined, or
    /// there were none.
    pub fn is_contested(&self) -> bool {
        self.lead.is_none_or(|lead| lead < DECIDED)
    }

    /// The best pose so far, and its score on the grid of its round: scores of different grids are not comparable.
    pub fn best(&self) -> Option<(Similarity, f64)> {
        // The order is final after the ranking.
        let best = self.found.first().or(self.best.first())?;
        Some((best.pose.similarity(&self.search.mesh.frame), f64::from(best.score.total)))
    }
}

fn poses_of(found: &[Found]) -> Vec<CropPose> {
    found.iter().map(|f| f.pose).collect()
}
