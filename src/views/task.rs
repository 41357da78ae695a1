//! An alignment with several views that runs in steps, so that a thread can do other work between them.

use core::borrow::Borrow;
use core::mem::replace;

use super::in_world::in_world;
use super::options::ViewsOptions;
use super::report::ViewsAlignment;
use super::searched_view::SearchedView;
use super::summary::Summary;
use super::unrelated::unrelated;
use super::world_pose::PlacedCamera;
use super::{MAX_VIEWS, View, no_mask};
use crate::error::{Error, ErrorCode, Result};
use crate::evidence::observation::Observation;
use crate::options::Options;
use crate::precise::prepared_mesh::PreparedMesh;
use crate::precise::{self, SearchSettings};
use crate::progress::{Host, Stage, Stopwatch};

/// Progress at the start of each stage, 0 to 1.
const PLAN: &[(Stage, f64)] =
    &[(Stage::Prepare, 0.0), (Stage::Search, 0.05), (Stage::Refine, 0.7), (Stage::Metrics, 0.9)];

/// An alignment of several views in steps.
pub struct ViewsTask<'h, M> {
    views: Vec<View>,
    observations: Vec<Option<Observation>>,
    mesh: M,
    options: ViewsOptions,
    efforts: Vec<SearchSettings>,
    is_known: bool,
    stages: Option<Stopwatch<'h>>,
    state: State,
}

/// The progress of the task.
enum State {
    /// The search with the effort of this index is running in the last of these views; the other list is of the search
    /// before.
    Searching(Vec<SearchedView>, Vec<SearchedView>, usize),
    /// The result is known.
    Found(Box<Summary>),
    /// The result has been returned, or an error.
    Over,
}

impl<'h, 'm, M: Borrow<PreparedMesh<'m>>> ViewsTask<'h, M> {
    /// Creates a task. Validates views and options.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidOption`]; [`ErrorCode::InvalidArgument`] for no view or too many, for camera poses of some views
    /// only, and where masks are missing; and those of [`Frame::check`](crate::evidence::frame::Frame::check) and
    /// [`Observation::new`], whose argument names the view.
    pub fn new(views: Vec<View>, mesh: M, options: ViewsOptions, host: impl Host + 'h) -> Result<Self> {
        options.validate()?;
        if views.is_empty() || views.len() > MAX_VIEWS {
            let found = format!("{} views", views.len());
            return Err(invalid(found, format!("1 to {MAX_VIEWS} views"), "Pass the views that show the object best."));
        }
        let known = views.iter().filter(|view| view.world_from_camera.is_some()).count();
        if known != 0 && known != views.len() {
            return Err(invalid(
                format!("`cameraToWorld` in {known} of {} views", views.len()),
                "camera poses in all views, or in none".into(),
                "Leave out the views whose camera pose is unknown, or all camera poses.",
            ));
        }
        let is_known = known > 0;
        let masked = views.iter().filter(|view| view.frame.mask.is_some()).count();
        if masked == 0 || (!is_known && masked != views.len()) {
            return Err(no_mask());
        }
        let observe = |(k, view): (usize, &View)| {
            view.frame.check().and_then(|()| view.frame.observation()).map_err(|error| {
                let argument = format!("views[{k}].{}", error.argument);
                error.about(argument)
            })
        };
        let observations = views.iter().enumerate().map(observe).collect::<Result<Vec<_>>>()?;
        let efforts = precise::efforts(&options.of_one_view());
        let stages = Some(Stopwatch::new(host, PLAN));
        let state = State::Searching(Vec::new(), Vec::new(), 0);
        Ok(Self { views, observations, mesh, options, efforts, is_known, stages, state })
    }

    /// Continues until the alignment is finished, and returns the result, or until `pause` returns true.
    ///
    /// # Errors
    /// [`ErrorCode::DegenerateMesh`], [`ErrorCode::NoConsensus`]; the task then ends.
    pub fn step(&mut self, pause: &mut dyn FnMut() -> bool) -> Result<Option<ViewsAlignment>> {
        let Some(mut stages) = self.stages.take() else { return Err(over()) };
        loop {
            self.state = match replace(&mut self.state, State::Over) {
                State::Searching(mut views, before, effort) => {
                    if views.last_mut().is_some_and(|view| !view.run(pause)) {
                        self.state = State::Searching(views, before, effort);
                        self.stages = Some(stages);
                        return Ok(None);
                    }
                    let share = precise::share(effort, self.efforts.len());
                    let done = views.len() as f64 / self.views.len() as f64;
                    stages.reach(share.start + (share.end - share.start) * 0.8 * done, None);
                    match self.next_view(&views) {
                        Some(index) => {
                            views.push(self.begin(index, effort, before.get(views.len()), &mut stages)?);
                            State::Searching(views, before, effort)
                        }
                        None => self.combine(views, effort, &mut stages)?,
                    }
                }
                State::Found(summary) => {
                    stages.enter(Stage::Metrics);
                    let alignment = summary.report(self.mesh.borrow(), &self.observations, &self.options, stages)?;
                    return Ok(Some(alignment));
                }
                State::Over => return Err(over()),
            };
            if pause() {
                self.stages = Some(stages);
                return Ok(None);
            }
        }
    }

    /// The next view with a mask.
    fn next_view(&self, searched: &[SearchedView]) -> Option<usize> {
        let from = searched.last().map_or(0, |view| view.index + 1);
        (from..self.views.len()).find(|&index| self.observations[index].is_some())
    }

    fn begin(
        &self,
        index: usize,
        effort: usize,
        previous: Option<&SearchedView>,
        stages: &mut Stopwatch<'h>,
    ) -> Result<SearchedView> {
        let mesh = self.mesh.borrow();
        mesh.check()?;
        let settings = self.efforts.get(effort).ok_or_else(over)?;
        let observation = self.observations[index].as_ref().ok_or_else(no_mask)?;
        let options = self.options.of_one_view();
        SearchedView::begin((index, self.camera(index)), observation, mesh, (&options, settings), previous, stages)
    }

    fn camera(&self, index: usize) -> PlacedCamera {
        self.views[index].world_from_camera.as_ref().map_or(PlacedCamera::AT_ORIGIN, PlacedCamera::of)
    }

    /// The result of all searches; or the next search, if it is not certain.
    fn combine(&self, mut views: Vec<SearchedView>, effort: usize, stages: &mut Stopwatch<'h>) -> Result<State> {
        stages.enter(Stage::Refine);
        let mesh = self.mesh.borrow();
        let summary = if self.is_known {
            in_world(&views, &self.views, mesh)
        } else {
            for view in &mut views {
                view.judge_colors(self.views[view.index].frame.photo.as_deref(), mesh.colors());
            }
            unrelated(&views)
        };
        let is_sure = summary.as_ref().is_ok_and(|summary| summary.is_sure);
        if !is_sure && effort + 1 < self.efforts.len() {
            return Ok(State::Searching(Vec::new(), views, effort + 1));
        }
        Ok(State::Found(Box::new(summary?)))
    }
}

fn invalid(found: String, expected: String, remedy: &'static str) -> Error {
    Error::new(ErrorCode::InvalidArgument, "views", found, expected, remedy)
}

fn over() -> Error {
    Error::new(ErrorCode::Internal, "task", "a finished task", "a running task", "Create another task.")
}
