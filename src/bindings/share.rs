//! One's share of an alignment, as JavaScript works on it: one at a time. See `pkg-config/src/pool/split.ts`.

use core::cell::Cell;

use glam::{DQuat, DVec2};
use js_sys::{Float64Array, Function};
use wasm_bindgen::prelude::*;

use super::aligner::{answer, case};
use super::error::to_js;
use super::host::{JsHost, best_numbers};
use crate::align::split::Share;
use crate::error::{Error, ErrorCode};
use crate::stages::search::Found;
use crate::stages::search::pose::CropPose;
use crate::stages::search::score::Score;

/// Numbers in which a candidate goes from one to another.
const NUMBERS: usize = 11;

thread_local! {
    static SHARE: Cell<Option<Box<Share>>> = const { Cell::new(None) };
}

/// Prepares the search, in place of any other that is under way.
#[wasm_bindgen(js_name = beginShare, skip_typescript)]
pub fn begin_share(input: &JsValue, options: &JsValue) -> Result<(), JsValue> {
    let run = || case(input, options).and_then(|(observation, mesh, options)| Share::new(observation, mesh, options));
    SHARE.set(Some(Box::new(run().map_err(|e| to_js(&e))?)));
    Ok(())
}

/// Takes what came of all tasks of the last round, in their order; then does every `parts`-th of the next round's, the
/// first of them being `part`. Without parts, ends the share.
///
/// What comes of it: how many tasks the round has, all parts together; whether it is refinement; in how many numbers a
/// task's outcome is told; the best pose so far, 16 numbers column by column, and its score, or 17 zeros; then the
/// outcomes, task by task. Nothing where there is no share.
#[wasm_bindgen(js_name = stepShare, skip_typescript)]
pub fn step_share(found: Option<Float64Array>, part: usize, parts: usize) -> Float64Array {
    let mut numbers = Vec::new();
    if let Some(mut share) = SHARE.take().filter(|_| parts > 0) {
        found.into_iter().for_each(|found| share.advance(of_numbers(&found)));
        let (found, per_task) = share.run(part, parts);
        let is_refinement = f64::from(u8::from(share.is_refinement()));
        numbers.extend_from_slice(&[share.tasks() as f64, is_refinement, (per_task * NUMBERS) as f64]);
        numbers.extend_from_slice(&share.best().map_or([0.0; 17], |(pose, score)| best_numbers(&pose, score)));
        for Found { pose, score, converged, renders } in found {
            let CropPose { rotation: DQuat { x, y, z, w }, size, place, distance } = pose;
            let (total, converged) = (f64::from(score.total), f64::from(u8::from(converged)));
            let renders = renders as f64;
            numbers.extend_from_slice(&[x, y, z, w, size, place.x, place.y, distance, total, converged, renders]);
        }
        SHARE.set(Some(share));
    }
    Float64Array::from(numbers.as_slice())
}

/// The alignment, once no task is left. Ends the share.
#[wasm_bindgen(js_name = finishShare, skip_typescript)]
pub fn finish_share(on_progress: Option<Function>) -> Result<JsValue, JsValue> {
    let none = || Error::new(ErrorCode::Internal, "share", "none", "one that was begun", "");
    answer(SHARE.take().ok_or_else(none).and_then(|share| share.finish(&mut JsHost::new(on_progress))))
}

fn of_numbers(numbers: &Float64Array) -> Vec<Found> {
    let numbers = numbers.to_vec();
    let (records, _) = numbers.as_chunks::<NUMBERS>();
    let found = records.iter().map(|&[x, y, z, w, size, u, v, distance, total, converged, renders]| Found {
        pose: CropPose { rotation: DQuat::from_xyzw(x, y, z, w), size, place: DVec2::new(u, v), distance },
        score: Score { total: total as f32, ..Score::default() },
        converged: converged != 0.0,
        renders: renders as usize,
    });
    found.collect()
}
