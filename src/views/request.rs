//! An alignment with several views, as it runs.

use super::ViewsOptions;
use super::in_world::in_world;
use super::report::ViewsAlignment;
use super::searched_view::SearchedView;
use super::summary::Summary;
use super::unrelated::unrelated;
use super::{MAX_VIEWS, View, no_mask};
use crate::align::search;
use crate::error::{Error, ErrorCode, Result};
use crate::evidence::observation::Observation;
use crate::options::Options;
use crate::precise::drawing::prepared_mesh::PreparedMesh;
use crate::precise::search::efforts;
use crate::precise::search::plate::without_invented_plate;
use crate::progress::{Host, Stage, Stopwatch};
use crate::scheduler::{Boxed, Scheduler, boxed};

/// Progress at the start of each stage, 0 to 1.
const PLAN: &[(Stage, f64)] =
    &[(Stage::Prepare, 0.0), (Stage::Search, 0.05), (Stage::Refine, 0.7), (Stage::Metrics, 0.9)];

/// Views of an object, checked, and the options.
pub struct Request {
    views: Vec<View>,
    /// `None` for a view without a mask, or with an unusable one.
    observations: Vec<Option<Observation>>,
    /// The errors of unusable masks.
    unusable: Vec<Error>,
    options: ViewsOptions,
    has_cameras: bool,
}

impl Request {
    /// Validates views and options.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidOption`]; [`ErrorCode::InvalidArgument`] for no view or too many, for camera poses of some views
    /// only, and where masks are missing; and, with the view in their argument, those of
    /// [`Frame::check`](crate::evidence::frame::Frame::check), and of [`Observation::new`] if no view is usable.
    pub fn new(views: Vec<View>, options: ViewsOptions) -> Result<Self> {
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
        let has_cameras = known > 0;
        let masked = views.iter().filter(|view| view.frame.mask.is_some()).count();
        if masked == 0 || (!has_cameras && masked != views.len()) {
            return Err(no_mask());
        }
        let (mut observations, mut unusable) = (Vec::new(), Vec::new());
        for (index, view) in views.iter().enumerate() {
            view.frame.check().map_err(|error| error.in_view(index))?;
            observations.push(view.frame.observation().unwrap_or_else(|error| {
                unusable.push(error.in_view(index));
                None
            }));
        }
        if observations.iter().all(Option::is_none) {
            return Err(unusable.into_iter().next().unwrap_or_else(no_mask));
        }
        Ok(Self { views, observations, unusable, options, has_cameras })
    }

    /// The options of the search in each view, and the observations.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidOption`].
    pub fn of_each_view(self) -> Result<(search::Request, Vec<Option<Observation>>)> {
        Ok((search::Request::new(self.options.of_one_view())?, self.observations))
    }

    /// Searches in every view with a mask, and combines what they have found, with increasing effort until that is sure.
    ///
    /// # Errors
    /// [`ErrorCode::DegenerateMesh`], [`ErrorCode::NoConsensus`].
    pub fn align<'a>(
        &'a self,
        mesh: &'a PreparedMesh<'_>,
        host: &'a mut dyn Host,
        scheduler: &'a Scheduler,
    ) -> Boxed<'a, Result<ViewsAlignment>> {
        boxed(async move {
            let mut stages = Stopwatch::new(host, PLAN);
            mesh.check()?;
            let options = self.options.of_one_view();
            let efforts = efforts::of(&options);
            let observed = self.observations.iter().flatten();
            let mesh = match efforts.first() {
                Some(first) => without_invented_plate(observed.clone(), mesh, &options, first, scheduler).await,
                None => mesh,
            };
            let mut searched: Vec<SearchedView> = Vec::new();
            let mut unusable = Vec::new();
            let mut summary = Err(no_mask());
            for (effort, settings) in efforts.iter().enumerate() {
                let share = efforts::share(effort, efforts.len());
                let before = core::mem::take(&mut searched);
                unusable.clone_from(&self.unusable);
                if settings.is_long(observed.clone().count()) && mesh.has_one_form(&settings.grids) {
                    scheduler.ask_for_help().await;
                }
                for (index, observation) in self.observations.iter().enumerate() {
                    let Some(observation) = observation else { continue };
                    let (place, previous) =
                        ((index, self.views[index].camera()), before.iter().find(|v| v.index == index));
                    let begun =
                        SearchedView::begin(place, observation, mesh, (&options, settings), previous, &mut stages);
                    let mut view = match begun {
                        Err(error) if error.code == ErrorCode::DegenerateMask => {
                            unusable.push(error.in_view(index));
                            continue;
                        }
                        begun => begun?,
                    };
                    scheduler.yield_point().await;
                    view.run(scheduler).await;
                    searched.push(view);
                    let done = searched.len() as f64 / self.views.len() as f64;
                    stages.reach(share.start + (share.end - share.start) * 0.8 * done, None);
                }
                if searched.is_empty() {
                    return Err(unusable.into_iter().next().unwrap_or_else(no_mask));
                }
                stages.enter(Stage::Refine);
                summary = self.combined(&mut searched, mesh, scheduler).await;
                scheduler.yield_point().await;
                if summary.as_ref().is_ok_and(|summary| summary.is_sure) {
                    break;
                }
            }
            stages.enter(Stage::Metrics);
            summary?.report(mesh, &self.observations, &unusable, &self.options, stages)
        })
    }

    /// The result of the searches in all views.
    async fn combined(
        &self,
        searched: &mut [SearchedView],
        mesh: &PreparedMesh<'_>,
        scheduler: &Scheduler,
    ) -> Result<Summary> {
        if self.has_cameras {
            return in_world(searched, &self.views, mesh, self.options.proportions);
        }
        for view in searched.iter_mut() {
            let photo = self.views[view.index].frame.photo.as_deref();
            view.judge_colors(photo, mesh.colors(), scheduler).await;
        }
        unrelated(searched, &self.views)
    }
}

fn invalid(found: String, expected: String, remedy: &'static str) -> Error {
    Error::new(ErrorCode::InvalidArgument, "views", found, expected, remedy)
}
