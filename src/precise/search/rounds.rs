//! Rounds: a search as lists of independent tasks.
//!
//! The results of a round, in the order of its tasks, determine the next round; ties are broken by that order.

use std::borrow::Cow;

use glam::DQuat;

use super::problem::Search;
use super::ranking::{Candidate, best_of, distinct_up_to};
use super::recipe::{FINE, MIN_ROTATIONS, ROUNDS, Round, Task};
use super::tasks::{RoundTasks, TaskResult};
use crate::geometry::rotations::super_fibonacci;
use crate::geometry::similarity::Similarity;
use crate::precise::drawing::pose::CropPose;
use crate::precise::observation::box_fits::{BoxFit, UNCUT};
use crate::scheduler::{Boxed, Scheduler, boxed};

/// Score below the best pose at which a refined turn of it is not ranked.
const TURN_MAX_SCORE_LOSS: f32 = 0.3;
/// The same, where several poses are turned: after an unsure search, whose best pose is more often wrong.
const TURN_MAX_SCORE_LOSS_UNSURE: f32 = 0.5;

/// Rotation from the best pose from which on a pose is elsewhere, radians.
pub const RIVAL_MIN_ANGLE_RAD: f64 = 0.5;
/// Lead over all poses elsewhere from which on the best pose has no rival. Of 660 sure searches, the 11 with a rival led by
/// at most 0.08, and 8 % by less than this.
const DECISIVE_SCORE_LEAD: f32 = 0.15;

/// Score below the best pose down to which ranked poses are polished, and their maximum number.
const CLOSE_MAX_SCORE_LOSS: f32 = 0.05;
const MAX_CLOSE: usize = 6;
/// Gain of score on the finest grid for which another pose than the first of the ranking is taken.
const MIN_DETAIL_GAIN: f32 = 0.02;

/// The best of this many rotations are followed by the next search.
const KEPT_QUOTIENT: usize = 4;

/// Rotation by which a search may refine a pose of another one, radians.
const SAME_POSE_MAX_RAD: f64 = 0.25;

/// Rotations after which the work of a round on the rotation grid is known.
const PROBED_ROTATIONS: usize = 16;

/// The work of a round on the rotation grid, where it is more than its allowance.
struct BudgetExceeded {
    estimated_work: u64,
}

/// A running search.
pub struct Rounds {
    /// The search.
    pub search: Search,
    /// Candidates of the ranking round, best first; empty until it has ended.
    pub candidates: Vec<Candidate>,
    /// Index of the current round.
    index: usize,
    /// The rotations of the first round, if they are not those of the rotation grid.
    rotations: Vec<DQuat>,
    /// Sizes and positions tried for each rotation.
    box_fits: Vec<BoxFit>,
    /// Initial poses of the tasks of the round; the rotations of the first round need no list.
    poses: Vec<CropPose>,
    /// Candidates from other sources than the rotation grid, which precede those of the grid.
    extra_poses: Vec<CropPose>,
    /// The best candidate of the last round, if any.
    best: Vec<Candidate>,
    /// Candidates of the ranking round other than turns of the best one.
    unturned_poses: Vec<CropPose>,
    /// The best pose of each rotation of the first round, best first.
    best_per_rotation: Vec<Candidate>,
    /// See [`Self::is_contested`].
    score_lead: Option<f32>,
}

impl Rounds {
    /// Starts with the rotation grid or, if the search is not `global`, only with the neighbourhood of `initial`.
    pub fn new(mut search: Search, initial: Option<CropPose>, global: bool) -> Self {
        let around = initial.map_or_else(Vec::new, |pose| search.around(pose));
        let box_fits = if global { search.box_fits() } else { vec![BoxFit::IDENTITY] };
        let is_searched = |round: &Round| !global && round.task.is_on_rotation_grid();
        let index = search.settings.rounds.iter().take_while(|round| is_searched(round)).count();
        Self {
            candidates: Vec::new(),
            index,
            rotations: Vec::new(),
            box_fits,
            poses: if global { Vec::new() } else { around.clone() },
            extra_poses: around,
            best: Vec::new(),
            unturned_poses: Vec::new(),
            best_per_rotation: Vec::new(),
            score_lead: None,
            search,
        }
    }

    /// Starts with these rotations instead of the rotation grid.
    pub fn from_rotations(search: Search, rotations: Vec<DQuat>) -> Self {
        let mut rounds = Self::new(search, None, true);
        rounds.rotations = rotations;
        rounds
    }

    /// Leaves out the sizes and positions by which something hides a part of the object, or the border cuts it: they are several
    /// times as many as the others, and few objects need them. Returns whether there were any.
    pub fn assume_uncut(&mut self) -> bool {
        let is_cut = self.box_fits.len() > UNCUT;
        self.box_fits.truncate(UNCUT);
        is_cut
    }

    /// The search from its beginning, with all sizes and positions. Without its candidates: refined already, they would hide that a
    /// pose elsewhere comes close.
    pub fn with_cuts(self) -> Self {
        Self::new(self.search, None, true)
    }

    /// A search that has ended with these candidates.
    pub fn finished(search: Search, candidates: Vec<Candidate>) -> Self {
        let mut rounds = Self::new(search, None, false);
        (rounds.candidates, rounds.index) = (candidates, ROUNDS);
        rounds
    }

    /// Puts the candidate that is nearest to the best one of another search first, unless it is first. Returns whether the
    /// order has changed.
    pub fn move_to_front(&mut self, others: &[Candidate]) -> bool {
        let Some(best) = others.first() else { return false };
        let angle = |candidate: &Candidate| candidate.pose.rotation.angle_between(best.pose.rotation);
        let near = self.candidates.iter().position(|candidate| angle(candidate) < SAME_POSE_MAX_RAD);
        if let Some(place) = near.filter(|place| *place > 0) {
            self.candidates[..=place].rotate_right(1);
            return true;
        }
        false
    }

    /// Keeps the rotations of the grid whose nearest rotation in the first round of `previous` was among its best.
    pub fn keep_promising_rotations(&mut self, previous: &Self) {
        let kept = previous.best_per_rotation.len() / KEPT_QUOTIENT;
        let is_promising = |rotation: &DQuat| {
            let (mut nearest, mut most) = (0, 0.0);
            for (i, best_per_rotation) in previous.best_per_rotation.iter().enumerate() {
                let cosine = best_per_rotation.pose.rotation.dot(*rotation).abs();
                if cosine > most {
                    (nearest, most) = (i, cosine);
                }
            }
            nearest < kept
        };
        let count = self.search.settings.rotations();
        self.rotations = (0..count).map(|i| super_fibonacci(i, count)).filter(is_promising).collect();
    }

    /// Adds poses that another search has refined to the candidates of the grid.
    pub fn add_candidates(&mut self, candidates: &[Candidate]) {
        self.add_poses(poses_of(candidates));
    }

    /// Adds poses from another source to those of the first refinement.
    pub fn add_poses(&mut self, poses: impl IntoIterator<Item = CropPose>) {
        let list = if self.is_on_rotation_grid() { &mut self.extra_poses } else { &mut self.poses };
        list.extend(poses);
    }

    /// The work of the current round that its inputs may ask for; see [`TaskResult::work`].
    fn allowed(&self, round: Round) -> u64 {
        let settings = &self.search.settings;
        let per_task = match round.task {
            Task::Rotate => self.box_fits.len(),
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
            let results = loop {
                match self.run_tasks(round, allowance, scheduler).await {
                    Ok(results) => break results,
                    Err(BudgetExceeded { estimated_work }) => round = self.rotate_less(estimated_work, allowance),
                }
            };
            self.end_round(round, results);
        })
    }

    /// The results of the tasks of a round, in order, of as many as its allowance is enough for.
    async fn run_tasks(
        &self,
        round: Round,
        allowance: u64,
        scheduler: &Scheduler,
    ) -> Result<Vec<Candidate>, BudgetExceeded> {
        let search = &self.search;
        let tasks = RoundTasks {
            view: search.view,
            effort: search.settings.effort,
            has_scene_term: search.has_scene_term(),
            task: round.task,
            grid: round.grid,
            work: round.work,
            box_fits: self.box_fits.len(),
            best: self.best.first().map(|best| best.score.total),
            rotations: Cow::Borrowed(&self.rotations),
            poses: Cow::Borrowed(&self.poses),
        };
        let count = tasks.count();
        let (mut work, mut done, mut exceeded) = (0, 0, None);
        let ends = |result: &TaskResult| {
            work += result.work;
            done += 1;
            if round.task != Task::Rotate {
                // The poses are sorted, so that the best ones have had their turn.
                return work > allowance;
            }
            let all = work * count as u64 / done as u64;
            if done == PROBED_ROTATIONS && all > allowance && count > MIN_ROTATIONS {
                exceeded = Some(BudgetExceeded { estimated_work: all });
            }
            exceeded.is_some()
        };
        let results = scheduler.run_tasks(&mut tasks.on(search), ends).await;
        exceeded.map_or_else(|| Ok(results.into_iter().flat_map(|result| result.candidates).collect()), Err)
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
    fn end_round(&mut self, round: Round, results: Vec<Candidate>) {
        self.search.renders += results.iter().map(|result| result.renders).sum::<usize>();
        if round.task == Task::Rotate {
            self.best_per_rotation = self.best_of_each_rotation(&results);
        }
        if round.task == Task::Refine && self.score_lead.is_none() {
            self.score_lead = Some(self.lead_over_rivals(&results));
        }

        let previous_best = core::mem::replace(&mut self.best, best_of(&results, 1));
        self.poses = match round.task {
            Task::Turn => self.end_turns(round, results, &previous_best),
            Task::Fit if !self.candidates.is_empty() => self.end_polish(results),
            Task::Fit => self.end_ranking(round, results),
            // The last round of a search that is not ranked.
            _ if round.keep == 0 => self.end_ranking(round, results),
            _ => poses_of(&self.kept(round, results)),
        };

        self.index += 1;
        if self.task() == Some(Task::Turn) {
            let turned = self.search.turned(&self.poses, &self.box_fits);
            self.unturned_poses = core::mem::replace(&mut self.poses, turned);
        }
        if round.task == Task::Place {
            self.poses.splice(0..0, core::mem::take(&mut self.extra_poses));
        }
    }

    /// The best pose of each rotation, best first.
    fn best_of_each_rotation(&self, results: &[Candidate]) -> Vec<Candidate> {
        let mut best = Vec::new();
        for of_rotation in results.chunks(self.box_fits.len()) {
            best.extend(best_of(of_rotation, 1));
        }
        best_of(&best, results.len())
    }

    /// The lead of the best pose over all that are elsewhere, when the candidates of the rotation grid are first refined.
    fn lead_over_rivals(&self, results: &[Candidate]) -> f32 {
        if self.best.is_empty() {
            // Around an initial pose alone, nothing is known of poses elsewhere.
            return 0.0;
        }
        match *distinct_up_to(&self.search.equivalence, results.to_vec(), 2, RIVAL_MIN_ANGLE_RAD) {
            [best, rival] => best.score.total - rival.score.total,
            _ => f32::INFINITY,
        }
    }

    /// The best results of a round, of which none is close to a better one.
    fn kept(&self, round: Round, results: Vec<Candidate>) -> Vec<Candidate> {
        if round.apart > 0.0 {
            distinct_up_to(&self.search.equivalence, results, round.keep, round.apart)
        } else {
            best_of(&results, round.keep)
        }
    }

    /// Ends a round of turns: those that are about as good as the best pose join the poses that were turned.
    fn end_turns(&mut self, round: Round, results: Vec<Candidate>, previous_best: &[Candidate]) -> Vec<CropPose> {
        // Of the same grid, so that their scores are comparable.
        self.best = best_of(&[previous_best, self.best.as_slice()].concat(), 1);
        let max_loss = if self.search.settings.turned > 1 { TURN_MAX_SCORE_LOSS_UNSURE } else { TURN_MAX_SCORE_LOSS };
        let min_score = previous_best.first().map_or(0.0, |best| best.score.total) - max_loss;
        let turns = results.into_iter().filter(|turn| turn.score.total > min_score).collect();

        let mut poses = core::mem::take(&mut self.unturned_poses);
        poses.extend(poses_of(&self.kept(round, turns)));
        poses
    }

    /// Ends the round that ranks the candidates; the best ones are polished next.
    fn end_ranking(&mut self, round: Round, results: Vec<Candidate>) -> Vec<CropPose> {
        self.candidates = self.kept(Round { keep: usize::MAX, ..round }, results);
        // A search for rivals polishes none.
        let Some(best) = self.candidates.first().filter(|_| round.keep > 0) else { return Vec::new() };
        let is_close = |candidate: &&Candidate| candidate.score.total > best.score.total - CLOSE_MAX_SCORE_LOSS;
        let close = self.candidates.iter().take(MAX_CLOSE).take_while(is_close).count();
        poses_of(&self.candidates[..round.keep.max(close).min(self.candidates.len())])
    }

    /// Ends the last round: of the polished poses, that which explains the details best comes first. All keep the scores of the
    /// ranking, because scores of different grids are not comparable.
    fn end_polish(&mut self, results: Vec<Candidate>) -> Vec<CropPose> {
        let (mut best, mut most) = (0, f32::NEG_INFINITY);
        for (k, (candidate, polished)) in self.candidates.iter_mut().zip(results).enumerate() {
            candidate.pose = polished.pose;
            candidate.converged |= polished.converged;
            let lead = if k == 0 { MIN_DETAIL_GAIN } else { 0.0 };
            if polished.score.total + lead > most {
                (best, most) = (k, polished.score.total + lead);
            }
        }
        self.candidates.get_mut(..=best).into_iter().for_each(|ahead| ahead.rotate_right(1));
        Vec::new()
    }

    /// Whether a pose elsewhere came close to the best one when the candidates of the rotation grid were first refined, or
    /// there were none.
    pub fn is_contested(&self) -> bool {
        self.score_lead.is_none_or(|score_lead| score_lead < DECISIVE_SCORE_LEAD)
    }

    /// The best pose so far, and its score on the grid of its round: scores of different grids are not comparable.
    pub fn best(&self) -> Option<(Similarity, f64)> {
        // The order is final after the ranking.
        let best = self.candidates.first().or(self.best.first())?;
        Some((best.pose.similarity(&self.search.mesh.frame), f64::from(best.score.total)))
    }
}

#[inline(never)]
fn poses_of(candidates: &[Candidate]) -> Vec<CropPose> {
    candidates.iter().map(|candidate| candidate.pose).collect()
}
