//! Alignments in steps: pauses anywhere change no bit of the result.

use sim3align::align::{align, align_task};
use sim3align::pauses::Pauses;
use sim3align::precise::searched::start::prepare;
use sim3align::progress::Timings;

use crate::prelude::*;
use crate::shapes::{body, observe};

/// The result of a task that pauses where its clock says, and how often it did.
fn in_steps(mesh: &PreparedMesh<'_>, options: AlignOptions, clock: fn() -> f64) -> (Alignment, usize) {
    let mut task = align_task(observe(mesh.mesh(), 1.0), mesh, options, Silent, Pauses::new(clock, None)).unwrap();
    let mut pauses = 0;
    loop {
        match task.step(0.0).unwrap() {
            Some(alignment) => {
                assert_eq!(task.step(0.0).unwrap_err().code, ErrorCode::Internal, "the task is over");
                return (alignment, pauses);
            }
            None => pauses += 1,
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn pauses_change_nothing() {
    let mesh = body();
    let prepared = PreparedMesh::borrowed(&mesh);
    let options = AlignOptions { quality: Quality::Fast, ..AlignOptions::default() };
    let whole = align(&observe(&mesh, 1.0), &mesh, &options, &mut Silent).unwrap();
    let (stepped, pauses) = in_steps(&prepared, options.clone(), pausing(0, 1));
    assert_eq!(stepped, whole);
    assert!(pauses > 600, "after every rotation at least: {pauses}");
    for seed in 0..4 {
        let (stepped, _) = in_steps(&prepared, options.clone(), pausing(seed, 50));
        assert_eq!(stepped, whole, "seed {seed}");
    }
    assert_eq!(whole.diagnostics.common.timings_ms.total_ms(), Timings::default().total_ms(), "no clock, no times");
}

#[wasm_bindgen_test(unsupported = test)]
fn a_prepared_mesh_gives_the_same_bits_at_every_quality() {
    let mesh = body();
    let prepared = PreparedMesh::new(mesh.clone());
    prepare(&prepared).unwrap();
    for quality in [Quality::Balanced, Quality::Fast, Quality::Fast] {
        let options = AlignOptions { quality, ..AlignOptions::default() };
        let expected = align(&observe(&mesh, 1.0), &mesh, &options, &mut Silent).unwrap();
        let (found, _) = in_steps(&prepared, options, pausing(0, 0));
        assert_eq!(found, expected);
    }
}
