//! Alignment: depth, mask and mesh in, the similarity x_cam = s·R·p + t and its metrics out.

pub mod evaluate;
pub mod method;
mod outcome;
pub mod task;
pub mod warnings;

use crate::error::Result;
use crate::evidence::observation::Observation;
use crate::geometry::mesh::Mesh;
use crate::paper;
use crate::paper::options::PaperOptions;
use crate::precise::SearchSettings;
use crate::precise::options::AlignOptions;
use crate::precise::prepared_mesh::PreparedMesh;
use crate::progress::Host;
use crate::report::{Alignment, AnyAlignment, PaperAlignment};
use method::Method;
pub use outcome::{Setup, align_by};
use task::AlignTask;

/// Aligns a mesh with an observation by search by rendering.
///
/// # Errors
/// [`ErrorCode::InvalidOption`](crate::error::ErrorCode::InvalidOption),
/// [`ErrorCode::DegenerateMesh`](crate::error::ErrorCode::DegenerateMesh),
/// [`ErrorCode::NoConsensus`](crate::error::ErrorCode::NoConsensus): the identity is never returned instead.
pub fn align(observation: &Observation, mesh: &Mesh, options: &AlignOptions, host: &mut dyn Host) -> Result<Alignment> {
    align_with(observation, mesh, options, crate::precise::efforts(options), host)
}

/// [`align`] with explicit settings of the searches instead of those derived from the options, for ablations.
///
/// # Errors
/// As [`align`].
pub fn align_with(
    observation: &Observation,
    mesh: &Mesh,
    options: &AlignOptions,
    efforts: Vec<SearchSettings>,
    host: &mut dyn Host,
) -> Result<Alignment> {
    let task = AlignTask::new(observation, PreparedMesh::borrowed(mesh), options.clone(), host)?;
    task.with_efforts(efforts).finish()
}

/// Aligns a mesh with an observation by the method of the paper.
///
/// # Errors
/// As [`align`].
pub fn align_paper(
    observation: &Observation,
    mesh: &Mesh,
    options: &PaperOptions,
    host: &mut dyn Host,
) -> Result<PaperAlignment> {
    let setup = Setup::of_paper(options)?;
    align_by(observation, mesh, &setup, paper::PLAN, host, |clouds, stages| paper::estimate(clouds, options, stages))
}

/// Aligns a mesh with an observation by either method.
///
/// # Errors
/// As [`align`].
pub fn align_by_method(
    observation: &Observation,
    mesh: &Mesh,
    method: &Method,
    host: &mut dyn Host,
) -> Result<AnyAlignment> {
    match method {
        Method::Precise(options) => align(observation, mesh, options, host).map(Into::into),
        Method::Paper(options) => align_paper(observation, mesh, options, host).map(Into::into),
    }
}
