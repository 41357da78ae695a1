//! Trackers, by the id of the caller.

use core::cell::{RefCell, RefMut};
use std::rc::Rc;

use js_sys::Function;
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

use sim3align::bindings::answer::answer;
use sim3align::bindings::host::{JsHost, now_ms};
use sim3align::bindings::object::wrong_type;
use sim3align::bindings::transform::similarity;
use sim3align::bindings::{input, mesh, options};
use sim3align::calibrate::Calibrated;
use sim3align::calibrate::calibration::DepthCalibration;
use sim3align::calibrate::frames::Sequence;
use sim3align::error::{Error, ErrorCode, Result};
use sim3align::evidence::frame::Frame;
use sim3align::precise::drawing::prepared_mesh::PreparedMesh;
use sim3align::progress::Silent;
use sim3align::scheduler::{Scheduler, Task};
use sim3align::track::report::TrackedFrame;
use sim3align::track::tracker::Tracker;

use crate::task::{Answer, JointTask, set};

/// A tracker, and the calibrations of its frames.
struct Tracked {
    mesh: Rc<PreparedMesh<'static>>,
    tracker: Tracker<Rc<PreparedMesh<'static>>>,
    sequence: Sequence,
}

type SharedTracker = Rc<RefCell<Tracked>>;

thread_local! {
    static TRACKERS: RefCell<Vec<(u32, SharedTracker)>> = const { RefCell::new(Vec::new()) };
}

/// Creates a tracker under this id; see `Aligner.track` in the TypeScript package.
#[wasm_bindgen(js_name = openTracker, skip_typescript)]
pub fn open_tracker(id: u32, input: &JsValue, options: &JsValue) -> Answer {
    let open = || {
        let options = options::options(options, &options::OF_CALLS, |_| None)?;
        let mesh = mesh::mesh_of(input)?;
        let tracker = Tracker::new(mesh.clone(), options)?;
        let tracked = Tracked { mesh, tracker, sequence: Sequence::default() };
        TRACKERS.with_borrow_mut(|trackers| trackers.push((id, Rc::new(RefCell::new(tracked)))));
        Ok(())
    };
    answer(open())
}

/// Begins to track the next frame; see `Tracker.next` in the TypeScript package. A task that is dropped before its end leaves the
/// tracker as it was.
#[expect(clippy::await_holding_refcell_ref, reason = "a tracker is borrowed for as long as it tracks a frame")]
#[wasm_bindgen(js_name = beginTrackFrame, skip_typescript)]
pub fn begin_track_frame(
    id: u32,
    frame: &JsValue,
    on_progress: Option<Function>,
) -> core::result::Result<JointTask, JsValue> {
    let begin = || {
        let (tracked, mut host, scheduler) = (tracker(id)?, JsHost::new(on_progress), Scheduler::new(now_ms, None));
        if !input::is_raw(frame) {
            let frame = input::frame(frame)?;
            return Ok(Task::new(scheduler, move |scheduler| async move {
                let Tracked { tracker, .. } = &mut *borrowed(&tracked)?;
                Ok((tracker.next_in_steps(&frame, &mut host, &scheduler).await?, None))
            }));
        }
        let (raw, photo) = (input::raw_frame(frame, None)?, input::photo(frame)?);
        Ok(Task::new(scheduler, move |scheduler| async move {
            let Tracked { mesh, tracker, sequence } = &mut *borrowed(&tracked)?;
            let (mut next, options) = (sequence.clone(), tracker.options().of_first_frame());
            let Calibrated { depth, camera, calibration } =
                next.next(&raw, mesh, &options, &mut Silent, &scheduler).await?;
            let relief_deviation = calibration.uncertainty.relief();
            let frame = Frame { depth, camera, mask: raw.mask, photo, relief_deviation };
            let found = tracker.next_in_steps(&frame, &mut host, &scheduler).await?;
            *sequence = next;
            Ok((found, Some(calibration)))
        }))
    };
    JointTask::new(begin(), found)
}

/// The pose, with the calibration of its depth map.
fn found((frame, calibration): (TrackedFrame, Option<DepthCalibration>)) -> Answer {
    let result = answer(Ok(frame))?;
    if let Some(calibration) = calibration {
        set(&result, "depthCalibration", &answer(Ok(calibration))?);
    }
    Ok(result)
}

/// Corrects the pose of a frame; see `Tracker.correct` in the TypeScript package.
#[wasm_bindgen(js_name = correctTrack, skip_typescript)]
pub fn correct_track(id: u32, pose: &JsValue, frame: &JsValue) -> Answer {
    let correct = || {
        let tracker = tracker(id)?;
        let pose = similarity(pose, "pose")?;
        let index = frame.as_f64().filter(|index| index.fract() == 0.0 && *index >= 0.0).map(|index| index as usize);
        if index.is_none() && !frame.is_undefined() && !frame.is_null() {
            return Err(wrong_type("frame", frame, "the number of a frame", "Pass `frame` of its result."));
        }
        borrowed(&tracker)?.tracker.correct(&pose, index)
    };
    answer(correct())
}

/// Removes a tracker, if there is one with this id.
#[wasm_bindgen(js_name = closeTracker, skip_typescript)]
pub fn close_tracker(id: u32) {
    TRACKERS.with_borrow_mut(|trackers| trackers.retain(|(known, _)| *known != id));
}

/// The tracker with this id. It is lost if the module trapped since.
fn tracker(id: u32) -> Result<SharedTracker> {
    let kept =
        TRACKERS.with_borrow(|trackers| trackers.iter().find(|(known, _)| *known == id).map(|(_, kept)| kept.clone()));
    kept.ok_or_else(|| {
        Error::new(
            ErrorCode::TrackerLost,
            "tracker",
            "a tracker whose worker, or whose memory, is gone",
            "a tracker that lives as long as its frames come",
            "Open another one with track(), and pass the last pose as options.initial.",
        )
    })
}

/// The tracker, for one call at a time.
fn borrowed(kept: &SharedTracker) -> Result<RefMut<'_, Tracked>> {
    kept.try_borrow_mut().map_err(|_| {
        Error::new(
            ErrorCode::Internal,
            "tracker",
            "a call before the last one has ended",
            "one call after the other",
            "Please report this.",
        )
    })
}
