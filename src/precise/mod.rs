//! Preset `precise`: search by rendering. The pose whose picture explains mask, free space and depth best.
//!
//! Coarse to fine on a crop around the mask. A grid of rotations, each with size, place and distance in closed form;
//! the best distinct ones refined over all seven parameters; the best of those refined again where every pixel
//! counts.

mod alternatives;
pub mod anchors;
pub mod clean;
pub mod coarse;
pub mod conditioning;
mod confidence;
pub mod grid;
pub mod mesh_pyramid;
pub mod objective;
pub mod pose;
pub mod prior;
pub mod ranking;
pub mod recipe;
pub mod refine;
pub mod render;
pub mod rim;
pub mod rounds;
pub mod score;
pub mod search;

use crate::align::Estimated;
use crate::align::options::{AlignOptions, ExtentAxis, Quality, SearchScope};
use crate::align::report::{Counts, Uncertainty};
use crate::error::{Error, ErrorCode, Result};
use crate::evidence::Evidence;
use crate::evidence::extents::Extents;
use crate::evidence::observation::Observation;
use crate::geometry::cloud::Bounds;
use crate::geometry::mesh::Mesh;
use crate::geometry::similarity::Similarity;
use crate::paper;
use crate::progress::{Stage, Stopwatch};
use std::rc::Rc;

use alternatives::alternatives;
use confidence::confidence;
use mesh_pyramid::MeshPyramid;
use pose::{CropPose, MeshFrame};
use prior::Prior;
pub use recipe::SearchSettings;
use recipe::Task;
use rounds::Rounds;
pub use search::Search;

/// When each stage begins, as a share of the whole; from profiles of real cases.
pub(super) const PLAN: &[(Stage, f64)] = &[
    (Stage::Observe, 0.0),
    (Stage::Sample, 0.01),
    (Stage::Normals, 0.02),
    (Stage::Prepare, 0.15),
    (Stage::Search, 0.2),
    (Stage::Refine, 0.6),
    (Stage::Metrics, 0.85),
];

/// Grid of rotations, refinement, choice. A `hypothesis` found otherwise joins the candidates of the grid.
pub(super) fn estimate(
    observation: &Observation,
    mesh: &Mesh,
    hypothesis: Option<Similarity>,
    options: &AlignOptions,
    settings: &SearchSettings,
    stages: &mut Stopwatch<'_>,
) -> Result<Estimated> {
    stages.enter(Stage::Prepare);
    let mut rounds = prepare(observation, mesh, options, settings)?;
    stages.enter(Stage::Search);
    let pose = hypothesis.and_then(|pose| CropPose::of_similarity(&pose, &rounds.search.mesh.frame));
    pose.into_iter().for_each(|pose| rounds.join(pose));
    while let Some(round) = rounds.round() {
        if round.task == Task::Refine && stages.running() != Some(Stage::Refine) {
            stages.enter(Stage::Refine);
        }
        rounds.run(&mut || false);
        stages.reach(round.done, rounds.best());
    }
    conclude(&rounds, mesh, options)
}

/// A search that is about to begin.
pub(super) fn prepare(
    observation: &Observation,
    mesh: &Mesh,
    options: &AlignOptions,
    settings: &SearchSettings,
) -> Result<Rounds> {
    let pyramid = MeshPyramid::new(mesh, &settings.grids).ok_or_else(no_candidate)?;
    let mut search = Search::new(observation, Rc::new(pyramid), *settings);
    search.assume(prior(options, mesh, &search.mesh.frame));
    let initial = options.initial.map(|pose| seen_from(&pose, &search.mesh.frame)).transpose()?;
    Ok(Rounds::new(search, initial, options.search == SearchScope::Global))
}

/// Descriptors are weak evidence, but of another kind: where time is no matter, their pose is a candidate too.
pub(super) fn hypothesis(
    evidence: &Evidence,
    extents: [&Extents; 2],
    options: &AlignOptions,
    stages: &mut Stopwatch<'_>,
) -> Option<Similarity> {
    let is_wanted = options.quality == Quality::Best && options.search == SearchScope::Global;
    let found = is_wanted.then(|| paper::estimate(evidence, extents, options, stages).ok()).flatten()?;
    Some(found.camera_from_mesh)
}

/// What the search found, and how sure it is.
pub(super) fn conclude(rounds: &Rounds, mesh: &Mesh, options: &AlignOptions) -> Result<Estimated> {
    let (found, search) = (&rounds.found, &rounds.search);
    let best = found.first().ok_or_else(no_candidate)?;
    let alternatives = alternatives(found, search, mesh, &options.symmetry)?;
    let (conditioning, residual_m) = search.conditioning(&best.pose);
    Ok(Estimated {
        camera_from_mesh: best.pose.similarity(&search.mesh.frame),
        clamped: search.is_held(&best.pose),
        converged: best.converged,
        residual_m,
        confidence: Some(confidence(best, &alternatives, conditioning.as_ref())),
        score: Some(f64::from(best.score.total)),
        terms: Some((&best.score).into()),
        alternatives,
        uncertainty: conditioning.map(|c| Uncertainty {
            scale: c.scale,
            rotation_deg: c.rotation.0.to_degrees(),
            rotation_axis: c.rotation.1.to_array(),
            lateral_m: c.lateral_m,
            distance_m: c.distance_m,
        }),
        counts: Counts { renders: search.renders, ..Counts::default() },
    })
}

/// The search that the options ask for.
pub fn search_settings(options: &AlignOptions) -> SearchSettings {
    let settings = match options.quality {
        Quality::Fast => SearchSettings::fast(),
        Quality::Balanced => SearchSettings::default(),
        Quality::Best => SearchSettings::best(),
    };
    let fixed = options.scale.is_some_and(|[min, max]| min == max) || options.known_extent_m.is_some();
    let settings = SearchSettings { lock_scale: fixed || options.lock_scale == Some(true), ..settings };
    options.budget_ms.map_or(settings, |budget_ms| settings.within(budget_ms))
}

/// What the options say of size and attitude.
fn prior(options: &AlignOptions, mesh: &Mesh, frame: &MeshFrame) -> Prior {
    let extent = Bounds::of(mesh.positions()).map_or(glam::Vec3::ONE, |b| b.extent());
    let side = f64::from(match options.known_extent_axis {
        ExtentAxis::Longest => extent.max_element(),
        ExtentAxis::X => extent.x,
        ExtentAxis::Y => extent.y,
        ExtentAxis::Z => extent.z,
    });
    let known = options.known_extent_m.map(|length| [length / side; 2]);
    // A scale that is locked from the beginning is that of the initial pose.
    let locked = options.initial.filter(|_| options.lock_scale == Some(true)).map(|pose| [pose.scale; 2]);
    let bounds = options.scale.or(known).or(locked);
    let direction = |v: [f64; 3]| glam::DVec3::from(v).normalize_or_zero();
    Prior {
        scale: bounds.map(|b| b.map(|s| s * frame.diagonal)),
        up: options.camera_up.zip(options.mesh_up).map(|(camera, mesh)| [direction(camera), direction(mesh)]),
    }
}

/// The caller's pose.
fn seen_from(pose: &Similarity, frame: &MeshFrame) -> Result<CropPose> {
    CropPose::of_similarity(pose, frame).ok_or_else(|| {
        Error::new(
            ErrorCode::InvalidOption,
            "options.initial",
            "a pose that puts the middle of the mesh behind the camera",
            "a pose in front of it: z forward",
            "Convert the pose from its own camera frame (OpenGL: negate y and z; PyTorch3D: negate x and y).",
        )
    })
}

fn no_candidate() -> Error {
    Error::new(
        ErrorCode::NoConsensus,
        "mesh",
        "no pose whose picture overlaps the mask",
        "a mesh and a mask of one object",
        "Check that mesh and mask show the same object, and that the camera belongs to the depth map.",
    )
}
