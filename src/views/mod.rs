//! One object in several views: with known camera poses, one pose from the evidence of all; without them, one size for
//! all, a pose in each, and the camera poses that follow.

pub mod by_color;
pub mod common_size;
mod in_world;
pub mod joint;
pub mod known;
pub mod options;
pub mod predicted_mask;
pub mod report;
pub mod searched_view;
mod summary;
pub mod task;
mod unrelated;
pub mod world_pose;

use crate::error::{Error, ErrorCode, Result};
use crate::evidence::frame::Frame;
use crate::geometry::similarity::Similarity;
use crate::precise::prepared_mesh::PreparedMesh;
use crate::progress::Host;
use options::ViewsOptions;
use report::ViewsAlignment;
use task::ViewsTask;

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

/// Aligns a mesh with several views of the object.
///
/// # Errors
/// As [`ViewsTask::new`] and [`ViewsTask::step`].
pub fn align_views(
    views: Vec<View>,
    mesh: &PreparedMesh<'_>,
    options: &ViewsOptions,
    host: &mut dyn Host,
) -> Result<ViewsAlignment> {
    let mut task = ViewsTask::new(views, mesh, options.clone(), host)?;
    loop {
        if let Some(alignment) = task.step(&mut || false)? {
            return Ok(alignment);
        }
    }
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
