//! An alignment with several views, as it runs.

use super::in_world::in_world;
use super::options::ViewsOptions;
use super::report::ViewsAlignment;
use super::searched_view::SearchedView;
use super::summary::Summary;
use super::unrelated::unrelated;
use super::world_pose::PlacedCamera;
use super::{MAX_VIEWS, View, no_mask};
use crate::align::search;
use crate::error::{Error, ErrorCode, Result};
use crate::evidence::observation::Observation;
use crate::options::Options;
use crate::pauses::{Boxed, Pauses, boxed};
use crate::precise::drawing::prepared_mesh::PreparedMesh;
use crate::precise::search::efforts;
use crate::precise::search::shown::shown;
use crate::progress::{Host, Stage, Stopwatch};

/// Progress at the start of each stage, 0 to 1.
const PLAN: &[(Stage, f64)] =
    &[(Stage::Prepare, 0.0), (Stage::Search, 0.05), (Stage::Refine, 0.7), (Stage::Metrics, 0.9)];

/// Views of an object, checked, and what is asked for.
pub struct Request {
    views: Vec<View>,
    observations: Vec<Option<Observation>>,
    options: ViewsOptions,
    is_known: bool,
}

impl Request {
    /// Validates views and options.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidOption`]; [`ErrorCode::InvalidArgument`] for no view or too many, for camera poses of some views
    /// only, and where masks are missing; and those of [`Frame::check`](crate::evidence::frame::Frame::check) and
    /// [`Observation::new`], whose argument names the view.
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
        Ok(Self { views, observations, options, is_known })
    }

    /// What the search in each view is asked for, and its observation.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidOption`].
    pub fn of_each_view(self) -> Result<(search::Request, Vec<Option<Observation>>)> {
        Ok((search::Request::new(self.options.of_one_view())?, self.observations))
    }

    fn camera(&self, index: usize) -> PlacedCamera {
        self.views[index].world_from_camera.as_ref().map_or(PlacedCamera::AT_ORIGIN, PlacedCamera::of)
    }

    /// Searches in every view with a mask, and combines what they have found, with increasing effort until that is sure.
    ///
    /// # Errors
    /// [`ErrorCode::DegenerateMesh`], [`ErrorCode::NoConsensus`].
    pub fn align<'a>(
        &'a self,
        mesh: &'a PreparedMesh<'_>,
        host: &'a mut dyn Host,
        pauses: &'a Pauses,
    ) -> Boxed<'a, Result<ViewsAlignment>> {
        boxed(async move {
            let mut stages = Stopwatch::new(host, PLAN);
            mesh.check()?;
            let options = self.options.of_one_view();
            let efforts = efforts::of(&options);
            let mesh = match self.observations.iter().flatten().next().zip(efforts.first()) {
                Some((view, settings)) => shown(view, mesh, &options, settings, pauses).await?,
                None => mesh,
            };
            let mut searched: Vec<SearchedView> = Vec::new();
            let mut summary = Err(no_mask());
            for (effort, settings) in efforts.iter().enumerate() {
                let share = efforts::share(effort, efforts.len());
                let before = core::mem::take(&mut searched);
                if settings.is_long(self.observations.iter().flatten().count()) && mesh.has_one_form() {
                    pauses.ask_for_help().await;
                }
                for (index, observation) in self.observations.iter().enumerate() {
                    let Some(observation) = observation else { continue };
                    let (place, previous) = ((index, self.camera(index)), before.get(searched.len()));
                    let mut view =
                        SearchedView::begin(place, observation, mesh, (&options, settings), previous, &mut stages)?;
                    pauses.here().await;
                    view.run(pauses).await;
                    searched.push(view);
                    let done = searched.len() as f64 / self.views.len() as f64;
                    stages.reach(share.start + (share.end - share.start) * 0.8 * done, None);
                }
                stages.enter(Stage::Refine);
                summary = self.combined(&mut searched, mesh, pauses).await;
                pauses.here().await;
                if summary.as_ref().is_ok_and(|summary| summary.is_sure) {
                    break;
                }
            }
            stages.enter(Stage::Metrics);
            summary?.report(mesh, &self.observations, &self.options, stages)
        })
    }

    /// The result of the searches in all views.
    async fn combined(
        &self,
        searched: &mut [SearchedView],
        mesh: &PreparedMesh<'_>,
        pauses: &Pauses,
    ) -> Result<Summary> {
        if self.is_known {
            return in_world(searched, &self.views, mesh, self.options.proportions);
        }
        for view in searched.iter_mut() {
            let photo = self.views[view.index].frame.photo.as_deref();
            view.judge_colors(photo, mesh.colors(), pauses).await;
        }
        unrelated(searched)
    }
}

fn invalid(found: String, expected: String, remedy: &'static str) -> Error {
    Error::new(ErrorCode::InvalidArgument, "views", found, expected, remedy)
}
