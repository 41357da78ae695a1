//! Shown: which form of a mesh the image shows, where a part of it may be a ground plate that a generator invented.

use super::recipe::SearchSettings;
use super::start;
use crate::error::Result;
use crate::evidence::observation::Observation;
use crate::pauses::Pauses;
use crate::precise;
use crate::precise::drawing::prepared_mesh::PreparedMesh;
use crate::precise::options::AlignOptions;
use crate::progress::{Silent, Stopwatch};

/// The mesh, or the mesh without its plate: that with the better score after a search of both. Most meshes have nothing that
/// looks like a plate.
///
/// # Errors
/// As [`start::begin`].
pub async fn shown<'m>(
    observation: &Observation,
    mesh: &'m PreparedMesh<'m>,
    options: &AlignOptions,
    settings: &SearchSettings,
    pauses: &Pauses,
) -> Result<&'m PreparedMesh<'m>> {
    let Some(object) = mesh.without_plate() else { return Ok(mesh) };
    let mut scores = [0.0f32; 2];
    for (mesh, score) in [mesh, object].into_iter().zip(&mut scores) {
        let host = &mut Silent;
        let stages = &mut Stopwatch::new(host, precise::PLAN);
        let mut rounds = start::begin(observation, mesh, None, options, settings, stages)?;
        pauses.here().await;
        start::run(&mut rounds, &(0.0..1.0), pauses, stages).await;
        *score = rounds.found.first().map_or(0.0, |best| best.score.total);
    }
    let [whole, alone] = scores;
    Ok(if alone > whole { object } else { mesh })
}
