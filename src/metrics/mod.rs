//! Metrics: agreement of a transform with the observation (as in the paper), and errors relative to the true pose.
//!
//! In: an observation, a mesh, a pose, and the evidence sampled from both. Out: [`Metrics`], and errors where the truth is known.
//! They follow the definitions of the paper, not those of the score that a search maximises: a method must not be
//! judged by its own objective.

pub mod mesh_symmetry;
pub mod pose_error;
pub mod silhouette;
pub mod surface;
pub mod symmetry;

use std::borrow::Cow;

use serde::Serialize;

use crate::error::Result;
use crate::evidence::Evidence;
use crate::evidence::clouds::Sampling;
use crate::evidence::observation::Observation;
use crate::geometry::decimate::decimate;
use crate::geometry::image::{DepthMap, Mask, Window};
use crate::geometry::mesh::Mesh;
use crate::geometry::rasteriser::Rasteriser;
use crate::geometry::similarity::Similarity;
use silhouette::boundary_tolerance_px;
use surface::{Drawn, Mean, surface_agreement};

/// Triangles above which surfaces are searched on a decimated mesh, above which it is rendered as well, and the number of
/// triangles that it then has.
const MAX_SEARCHED_TRIANGLES: usize = 1 << 18;
const MAX_DRAWN_TRIANGLES: usize = 1 << 21;
const DECIMATED_TRIANGLES: usize = 1 << 17;

/// Agreement of a posed mesh with the observation. `null` marks a value that could not be measured. Distances to a mesh with
/// more than 262 144 triangles are distances to its decimated surface, which differs by less than a thousandth of its size.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
pub struct Metrics {
    /// DAVIS boundary F-measure of mask and rendered silhouette at 0.008 × the image diagonal, 0 to 1, higher is
    /// better; 0 if nothing is rendered.
    pub boundary_f: Option<f64>,
    /// Distance of the centroids of mask and rendered silhouette, pixels; `null` where nothing is rendered.
    pub center_drift_px: Option<f64>,
    /// Intersection over union of mask and rendered silhouette, 0 to 1, higher is better; 0 where nothing is
    /// rendered or nothing overlaps.
    pub iou: Option<f64>,
    /// Mean of the two directional mean distances between observed points and surface, metres. The surface's
    /// unseen side counts, so that it is above 0 at the true pose too.
    pub chamfer_m: Option<f64>,
    /// Mean distance from the observed points to the surface, metres.
    pub uni_chamfer_m: Option<f64>,
    /// Share of the observed points within 5 % of their box diagonal of the surface, 0 to 1.
    pub fitness: Option<f64>,
    /// Mean |n·n′| of an observed point's normal and that of the nearest triangle, 0 to 1; random directions
    /// give 0.5. `null` where no point has a normal.
    pub normal_consistency: Option<f64>,
    /// Mean |rendered − observed| depth over the mask's pixels that have both, metres; `null` where none has.
    pub depth_mae_m: Option<f64>,
    /// Correlation of the mesh's colours with the photo inside the mask, without the shading that normals explain, −1 to
    /// 1, higher is better; absent where the mesh or the photo has no colours. Not of the paper.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "types", ts(optional))]
    pub color_agreement: Option<f64>,
}

/// Computes the metrics of a transform at the resolution of the depth map.
///
/// # Errors
/// [`crate::error::ErrorCode::InvalidTransform`] for a transform that is no similarity,
/// [`crate::error::ErrorCode::DegenerateMesh`] for a mesh without area.
pub fn evaluate(
    observation: &Observation,
    mesh: &Mesh,
    camera_from_mesh: &Similarity,
    options: &Sampling,
) -> Result<Metrics> {
    score(observation, mesh, camera_from_mesh, &Evidence::of(observation, mesh, options)?)
}

/// Like [`evaluate`], with given evidence of the same observation and mesh, for use with several poses.
///
/// # Errors
/// [`crate::error::ErrorCode::InvalidTransform`] for a transform that is no similarity.
pub fn score(
    observation: &Observation,
    mesh: &Mesh,
    camera_from_mesh: &Similarity,
    evidence: &Evidence,
) -> Result<Metrics> {
    check_transform(camera_from_mesh)?;
    let image = [observation.mask().width(), observation.mask().height()];
    let part = Window::of_bounds(observation.bounds());
    let mut rasteriser = Rasteriser::new();
    let window = rasteriser.render_around(&drawable(mesh), camera_from_mesh, &observation.camera(), image, part);
    let drawn =
        Drawn { depth: rasteriser.depth(), triangles: rasteriser.triangles(), window, camera: observation.camera() };
    let agreement = surface_agreement(evidence, &searchable(mesh), camera_from_mesh, &drawn);
    // All else is empty in both images.
    let (depth, mask) = (observation.depth().window(&window), observation.mask().window(&window));
    let mut silhouette = Mask::filled(window.size[0], window.size[1], 0);
    for (pixel, z) in silhouette.data_mut().iter_mut().zip(rasteriser.depth()) {
        *pixel = u8::from(*z > 0.0);
    }
    let finite = |metres: Option<f64>| metres.filter(|m| m.is_finite());
    let chamfer = agreement.points_to_surface.zip(agreement.surface_to_points).map(|(to, from)| 0.5 * (to + from));
    Ok(Metrics {
        boundary_f: Some(silhouette::boundary_f(&mask, &silhouette, boundary_tolerance_px(image[0], image[1]))),
        center_drift_px: silhouette::center_drift_px(&mask, &silhouette),
        iou: Some(silhouette::iou(&mask, &silhouette)),
        chamfer_m: finite(chamfer),
        uni_chamfer_m: finite(agreement.points_to_surface),
        fitness: agreement.fitness,
        normal_consistency: agreement.normal_consistency,
        depth_mae_m: finite(depth_mae(&depth, &mask, rasteriser.depth())),
        color_agreement: None,
    })
}

/// The mesh that is searched for nearest points. A tree over half a million triangles takes longer to build than an
/// alignment to find, and the decimated surface differs by less than a thousandth of the size of the object.
fn searchable(mesh: &Mesh) -> Cow<'_, Mesh> {
    at_most(MAX_SEARCHED_TRIANGLES, mesh)
}

/// The mesh that is rendered: a rasteriser's buffers for millions of vertices would take more memory than all else.
fn drawable(mesh: &Mesh) -> Cow<'_, Mesh> {
    at_most(MAX_DRAWN_TRIANGLES, mesh)
}

fn at_most(most: usize, mesh: &Mesh) -> Cow<'_, Mesh> {
    if mesh.triangles().len() <= most {
        return Cow::Borrowed(mesh);
    }
    Cow::Owned(decimate(mesh, DECIMATED_TRIANGLES))
}

/// Mean |rendered − observed| over the pixels of the mask with both depths (above 0).
fn depth_mae(observed: &DepthMap, mask: &Mask, rendered: &[f32]) -> Option<f64> {
    let mut mean = Mean::default();
    for ((&observed, &inside), &rendered) in observed.data().iter().zip(mask.data()).zip(rendered) {
        if inside != 0 && observed > 0.0 && rendered > 0.0 {
            mean.add((f64::from(rendered) - f64::from(observed)).abs());
        }
    }
    mean.value()
}

/// Checks a [`Similarity`], whose public fields may have any value.
fn check_transform(transform: &Similarity) -> Result<()> {
    Similarity::from_parts(transform.scale, *transform.rotation.matrix(), transform.translation).map(|_| ())
}
