//! The tasks of a round as data, which the thread of the search and its helpers run alike.

use std::borrow::Cow;

use glam::{DQuat, DVec2};

use super::coarse::Coarse;
use super::problem::Search;
use super::ranking::Candidate;
use super::recipe::Task;
use super::refine::Refiner;
use crate::geometry::rotations::super_fibonacci;
use crate::helpers::{Tasks, put};
use crate::precise::drawing::pose::CropPose;
use crate::precise::drawing::render::Canvas;
use crate::precise::observation::box_fits::BoxFit;
use crate::precise::scoring::score::Score;
use crate::report::Effort;

/// Score below the best pose at which a turn of it is not refined.
const TURN_MAX_SCORE_LOSS: f32 = 0.8;

/// The tasks of a round.
#[derive(Debug, Clone, PartialEq)]
pub struct RoundTasks<'a> {
    /// The view of the search.
    pub view: usize,
    /// Its effort, on which its grids depend.
    pub effort: Effort,
    /// Whether the score has a scene term.
    pub has_scene_term: bool,
    /// Kind of the tasks.
    pub task: Task,
    /// Index of the grid.
    pub grid: usize,
    /// See [`Round`](super::recipe::Round).
    pub work: usize,
    /// Number of sizes and positions tried for each rotation.
    pub box_fits: usize,
    /// The score of the best candidate of the last round, if any.
    pub best: Option<f32>,
    /// The rotations of [`Task::Rotate`], if they are not those of the rotation grid.
    pub rotations: Cow<'a, [DQuat]>,
    /// Initial poses of the other tasks.
    pub poses: Cow<'a, [CropPose]>,
}

/// The result of a task.
pub struct TaskResult {
    /// One pose; for a rotation, one for each anchor.
    pub candidates: Vec<Candidate>,
    /// See [`Canvas::work`].
    pub work: u64,
}

/// The tasks of a round of a search, to be run.
pub struct Run<'a> {
    tasks: &'a RoundTasks<'a>,
    search: &'a Search,
    /// Of [`Task::Rotate`].
    box_fits: Vec<BoxFit>,
    coarse: Coarse<'a>,
    refiner: Refiner<'a>,
    canvas: Canvas,
}

impl RoundTasks<'_> {
    /// Number of tasks.
    pub fn count(&self) -> usize {
        match self.task {
            Task::Rotate if self.rotations.is_empty() => self.work,
            Task::Rotate => self.rotations.len(),
            _ => self.poses.len(),
        }
    }

    /// The tasks on the evidence of their search.
    pub fn on<'a>(&'a self, search: &'a Search) -> Run<'a> {
        let objective = search.objective(self.grid);
        let coarse = Coarse { objective, median_m: search.observation.median_m };
        let refiner = Refiner { objective, lock_scale: search.settings.lock_scale };
        let mut box_fits = if self.task == Task::Rotate { search.box_fits() } else { Vec::new() };
        box_fits.truncate(self.box_fits);
        Run { tasks: self, search, box_fits, coarse, refiner, canvas: Canvas::default() }
    }

    /// Writes the tasks as numbers, without loss.
    pub fn write(&self, message: &mut Vec<f64>) {
        let Self { view, effort, has_scene_term, task, grid, work, box_fits, best, rotations, poses } = self;
        let settings = [*view, *effort as usize, usize::from(*has_scene_term), *task as usize, *grid, *work, *box_fits];
        put(message, &settings.map(|x| x as f64));
        put(message, &[best.map_or(f64::NAN, f64::from)]);
        put(message, &[rotations.len(), poses.len()].map(|x| x as f64));
        for rotation in rotations.iter() {
            put(message, &rotation.to_array());
        }
        for pose in poses.iter() {
            put(message, &pose_numbers(pose));
        }
    }

    /// Reads what [`Self::write`] has written.
    pub fn read(message: &[f64]) -> Option<RoundTasks<'static>> {
        const EFFORTS: [Effort; 3] = [Effort::Fast, Effort::Balanced, Effort::Best];
        const TASKS: [Task; 5] = [Task::Rotate, Task::Place, Task::Refine, Task::Turn, Task::Fit];
        let (&[view, effort, has_scene_term, task, grid, work, box_fits, best, rotations, poses], lists) =
            message.split_first_chunk()?;
        let (rotations, lists) = lists.split_at_checked(4 * rotations as usize)?;
        let (poses, _) = lists.split_at_checked(POSE * poses as usize)?;
        Some(RoundTasks {
            view: view as usize,
            effort: *EFFORTS.iter().find(|known| **known as usize as f64 == effort)?,
            has_scene_term: has_scene_term != 0.0,
            task: *TASKS.iter().find(|known| **known as usize as f64 == task)?,
            grid: grid as usize,
            work: work as usize,
            box_fits: box_fits as usize,
            best: (!best.is_nan()).then_some(best as f32),
            rotations: rotations.as_chunks().0.iter().map(|rotation| DQuat::from_array(*rotation)).collect(),
            poses: poses.as_chunks().0.iter().map(pose_of).collect(),
        })
    }
}

impl Tasks for Run<'_> {
    type Result = TaskResult;

    fn count(&self) -> usize {
        self.tasks.count()
    }

    // Each of its callers would have a copy of the search.
    #[inline(never)]
    fn run(&mut self, task: usize) -> TaskResult {
        let Self { tasks, search, box_fits, coarse, refiner, canvas } = self;
        let RoundTasks { work, rotations, poses, best, .. } = tasks;
        let mut candidates = Vec::new();
        canvas.work = 0;
        match tasks.task {
            Task::Rotate => {
                let rotation = rotations.get(task).copied();
                let rotation = rotation.unwrap_or_else(|| super_fibonacci(task, *work));
                coarse.try_box_fits(canvas, &search.mesh.outermost, rotation, box_fits, &mut candidates);
            }
            Task::Place => candidates.push(coarse.at_its_distance(canvas, poses[task])),
            Task::Turn | Task::Refine => {
                let (mut pose, mut steps) = (poses[task], *work);
                if tasks.task == Task::Turn {
                    let turned = coarse.at_its_distance(canvas, pose);
                    pose = turned.pose;
                    if best.is_some_and(|best| turned.score.total < best - TURN_MAX_SCORE_LOSS) {
                        steps = 0;
                    }
                }
                candidates.push(refiner.refine(canvas, pose, steps));
            }
            Task::Fit => {
                candidates.push(refiner.refine_in_proportion(canvas, poses[task], *work, &search.mesh.surface));
            }
        }
        TaskResult { candidates, work: canvas.work }
    }

    fn write(&self, message: &mut Vec<f64>) {
        self.tasks.write(message);
    }

    fn write_result(TaskResult { candidates, work }: &TaskResult, message: &mut Vec<f64>) {
        put(message, &[candidates.len() as f64, *work as f64]);
        for Candidate { pose, score, renders, converged } in candidates {
            put(message, &pose_numbers(pose));
            put(message, &score_numbers(score).map(f64::from));
            put(message, &[*renders as f64, f64::from(u8::from(*converged))]);
        }
    }

    fn read_result(message: &mut &[f64]) -> Option<TaskResult> {
        let (&[count, work], candidates) = message.split_first_chunk()?;
        let (numbers, rest) = candidates.split_at_checked(CANDIDATE * count as usize)?;
        *message = rest;
        let mut candidates = Vec::with_capacity(count as usize);
        for numbers in numbers.as_chunks::<CANDIDATE>().0 {
            let (pose, numbers) = numbers.split_first_chunk()?;
            let (score, numbers) = numbers.split_first_chunk::<SCORE>()?;
            let &[renders, converged] = numbers.first_chunk()?;
            let (pose, score) = (pose_of(pose), score_of(score.map(|x| x as f32)));
            candidates.push(Candidate { pose, score, renders: renders as usize, converged: converged != 0.0 });
        }
        Some(TaskResult { candidates, work: work as u64 })
    }
}

/// Numbers of a pose, of a score, and of a candidate.
const POSE: usize = 8;
const SCORE: usize = 11;
const CANDIDATE: usize = POSE + SCORE + 2;

fn pose_numbers(CropPose { rotation, size, place, distance }: &CropPose) -> [f64; POSE] {
    let [x, y, z, w] = rotation.to_array();
    [x, y, z, w, *size, place.x, place.y, *distance]
}

fn pose_of(&[x, y, z, w, size, u, v, distance]: &[f64; POSE]) -> CropPose {
    CropPose { rotation: DQuat::from_xyzw(x, y, z, w), size, place: DVec2::new(u, v), distance }
}

fn score_numbers(score: &Score) -> [f32; SCORE] {
    let Score { total, overlap, coverage, depth, normals, outline, hidden, union, counts: [a, b, c] } = *score;
    [total, overlap, coverage, depth, normals, outline, hidden, union, a, b, c]
}

fn score_of(numbers: [f32; SCORE]) -> Score {
    let [total, overlap, coverage, depth, normals, outline, hidden, union, a, b, c] = numbers;
    Score { total, overlap, coverage, depth, normals, outline, hidden, union, counts: [a, b, c] }
}
