//! Alignment: depth, mask and mesh in, the similarity x_cam = s·R·p + t and its metrics out.

pub mod evaluate;
pub mod helper;
mod outcome;
pub mod search;
pub mod warnings;

use core::borrow::Borrow;

use crate::error::Result;
use crate::evidence::observation::Observation;
use crate::geometry::mesh::Mesh;
use crate::paper;
use crate::paper::options::PaperOptions;
use crate::precise::drawing::prepared_mesh::PreparedMesh;
use crate::precise::options::AlignOptions;
use crate::progress::Host;
use crate::report::{Alignment, PaperAlignment};
use crate::scheduler::{Boxed, Scheduler, Task, boxed, finished};
pub use outcome::{Setup, align_by};
use search::{Request, Search};

/// Aligns a mesh with an observation by search by rendering.
///
/// # Errors
/// [`ErrorCode::InvalidOption`](crate::error::ErrorCode::InvalidOption),
/// [`ErrorCode::DegenerateMesh`](crate::error::ErrorCode::DegenerateMesh),
/// [`ErrorCode::NoConsensus`](crate::error::ErrorCode::NoConsensus): the identity is never returned instead.
pub fn align(observation: &Observation, mesh: &Mesh, options: &AlignOptions, host: &mut dyn Host) -> Result<Alignment> {
    align_prepared(observation, &PreparedMesh::borrowed(mesh), Request::new(options.clone())?, host)
}

/// [`align`] with a prepared mesh, which may have colours.
///
/// # Errors
/// As [`align`].
pub fn align_prepared(
    observation: &Observation,
    mesh: &PreparedMesh<'_>,
    request: Request,
    host: &mut dyn Host,
) -> Result<Alignment> {
    finished(align_cooperatively(observation, mesh, &request, host, &Scheduler::unbounded()))
}

/// [`align`] in steps, with other threads that may help. The task owns or borrows its observation and mesh.
///
/// # Errors
/// [`ErrorCode::InvalidOption`](crate::error::ErrorCode::InvalidOption).
pub fn align_task<'a, 'm: 'a>(
    observation: impl Borrow<Observation> + 'a,
    mesh: impl Borrow<PreparedMesh<'m>> + 'a,
    options: AlignOptions,
    mut host: impl Host + 'a,
    scheduler: Scheduler,
) -> Result<Task<'a, Alignment>> {
    let request = Request::new(options)?;
    Ok(Task::new(scheduler, |scheduler| async move {
        align_cooperatively(observation.borrow(), mesh.borrow(), &request, &mut host, &scheduler).await
    }))
}

/// The recipe of [`align`].
fn align_cooperatively<'a>(
    observation: &'a Observation,
    mesh: &'a PreparedMesh<'_>,
    request: &'a Request,
    host: &'a mut dyn Host,
    scheduler: &'a Scheduler,
) -> Boxed<'a, Result<Alignment>> {
    boxed(async move {
        let mut search = Search::begin(observation, mesh, request, host, scheduler).await?;
        let clouds = search.clouds().await?;
        let searched = search.search().await?;
        let colors = search.colors(&searched).await;
        search.finish(clouds, searched, colors.as_ref())
    })
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
