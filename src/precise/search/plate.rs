//! The choice between a mesh and the mesh without its ground plate, which a generator may have invented.

use super::recipe::SearchSettings;
use super::start;
use crate::evidence::observation::Observation;
use crate::precise;
use crate::precise::drawing::prepared_mesh::PreparedMesh;
use crate::precise::options::AlignOptions;
use crate::progress::{Silent, Stopwatch};
use crate::scheduler::Scheduler;

/// The mesh, or the mesh without its plate: that with the better score after a search of both in all views. Most meshes have
/// nothing that looks like a plate.
pub async fn without_invented_plate<'m>(
    views: impl Iterator<Item = &Observation> + Clone,
    mesh: &'m PreparedMesh<'m>,
    options: &AlignOptions,
    settings: &SearchSettings,
    scheduler: &Scheduler,
) -> &'m PreparedMesh<'m> {
    let Some(object) = mesh.without_plate(&settings.grids) else { return mesh };
    let mut scores = [0.0f32; 2];
    for (mesh, score) in [mesh, object].into_iter().zip(&mut scores) {
        for view in views.clone() {
            let host = &mut Silent;
            let stages = &mut Stopwatch::new(host, precise::PLAN);
            // The alignment reports the error of a view that cannot be searched.
            let Ok(mut rounds) = start::start_search(view, mesh, None, options, settings, stages) else { continue };
            scheduler.yield_point().await;
            start::run_rounds(&mut rounds, 0.0..1.0, scheduler, stages).await;
            *score += rounds.candidates.first().map_or(0.0, |best| best.score.total);
        }
    }
    let [whole, alone] = scores;
    if alone > whole { object } else { mesh }
}
