//! One object in several views: with known camera poses, one pose from the evidence of all; without them, one size for
//! all, a pose in each, and the camera poses that follow.

pub mod by_color;
pub mod common_size;
mod in_world;
pub mod joint;
pub mod predicted_mask;
pub mod report;
mod request;
pub mod searched_view;
mod stretch;
mod summary;
mod unrelated;
pub mod view_set;
pub mod world_pose;

use core::borrow::Borrow;
use std::rc::Rc;

use crate::align::helper::Helper;
use crate::error::{Error, ErrorCode, Result};
use crate::evidence::frame::Frame;
use crate::geometry::similarity::Similarity;
use crate::options::Options;
use crate::precise::drawing::prepared_mesh::PreparedMesh;
use crate::precise::options::{Proportions, search_options};
use crate::progress::Host;
use crate::scheduler::{Scheduler, Task, finished};
use report::ViewsAlignment;

search_options! {
    /// Options of `alignViews`. All have defaults.
    pub struct ViewsOptions {
        /// Whether to fit the proportions of the mesh to all views together, as in `align`. Only with given camera poses.
        proportions: Proportions = Proportions::Keep, Choice;
        /// Whether to compute the `metrics` of each view. Without them the call takes less time.
        metrics: bool = true, Flag;
        /// Upper bound on the depth readings of each view that are used for metrics.
        max_observed_points: u32 = 20_000, Count(32..=1_000_000);
        /// Number of points sampled on the mesh surface for metrics.
        surface_samples: u32 = 10_000, Count(100..=1_000_000);
    }
    check check_combination;
    fn of_one_view;
}

fn check_combination(options: &ViewsOptions) -> Result<()> {
    options.of_one_view().check_combination()
}
use request::Request;
use world_pose::PlacedCamera;

/// Maximum number of views.
pub const MAX_VIEWS: usize = 64;

/// One view: a frame and, if it is known, the pose of its camera.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    /// Depth, camera and mask.
    pub frame: Frame,
    /// World from camera, of scale 1.
    pub world_from_camera: Option<Similarity>,
}

impl View {
    /// The camera in the world; without a pose, that of the world itself.
    fn camera(&self) -> PlacedCamera {
        self.world_from_camera.as_ref().map_or(PlacedCamera::AT_ORIGIN, PlacedCamera::of)
    }
}

/// Aligns a mesh with several views of the object.
///
/// # Errors
/// [`InvalidOption`](crate::error::ErrorCode::InvalidOption) and [`InvalidArgument`](crate::error::ErrorCode::InvalidArgument);
/// [`NoConsensus`](crate::error::ErrorCode::NoConsensus) if no view has a pose.
pub fn align_views(
    views: Vec<View>,
    mesh: &PreparedMesh<'_>,
    options: &ViewsOptions,
    host: &mut dyn Host,
) -> Result<ViewsAlignment> {
    finished(Request::new(views, options.clone())?.align(mesh, host, &Scheduler::unbounded()))
}

/// [`align_views`] in steps, with other threads that may help.
///
/// # Errors
/// As [`align_views`].
pub fn align_views_task<'a, 'm: 'a>(
    views: Vec<View>,
    mesh: impl Borrow<PreparedMesh<'m>> + 'a,
    options: ViewsOptions,
    mut host: impl Host + 'a,
    scheduler: Scheduler,
) -> Result<Task<'a, ViewsAlignment>> {
    let request = Request::new(views, options)?;
    Ok(Task::new(scheduler, |scheduler| async move { request.align(mesh.borrow(), &mut host, &scheduler).await }))
}

/// A helper of [`align_views_task`] with the same views, mesh and options.
///
/// # Errors
/// As [`align_views`].
pub fn views_helper(views: Vec<View>, mesh: Rc<PreparedMesh<'static>>, options: ViewsOptions) -> Result<Helper> {
    let (request, observations) = Request::new(views, options)?.of_each_view()?;
    Ok(Helper::new(observations, mesh, request, |_| ()))
}

/// The error where a mask is needed.
pub(crate) fn no_mask() -> Error {
    Error::new(
        ErrorCode::InvalidArgument,
        "views",
        "no view with a mask",
        "at least one view with a mask; without `cameraToWorld`, a mask in every view",
        "Pass the mask of the object in the view that shows it best.",
    )
}
