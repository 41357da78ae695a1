//! Alignments of several views, in steps.

use js_sys::Function;
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

use sim3align::bindings::answer::answer;
use sim3align::bindings::answer::to_js;
use sim3align::bindings::helpers::{JsHelpers, scheduler};
use sim3align::bindings::host::JsHost;
use sim3align::bindings::object::get;
use sim3align::bindings::transform::similarity;
use sim3align::bindings::{input, mesh, options};
use sim3align::error::{Error, ErrorCode, Result};
use sim3align::geometry::similarity::Similarity;
use sim3align::number::number;
use sim3align::views::{View, align_views_task, views_helper};

use crate::task::{JointHelper, JointTask, items};

/// Largest deviation of the scale of a camera pose from 1.
const RIGID: f64 = 1e-3;

/// Starts an alignment; see `Aligner.alignViews` in the TypeScript package.
#[wasm_bindgen(js_name = beginAlignViews, skip_typescript)]
pub fn begin_align_views(
    input: &JsValue,
    options: &JsValue,
    on_progress: Option<Function>,
    helpers: Option<JsHelpers>,
) -> core::result::Result<JointTask, JsValue> {
    let begin = || {
        let options = options::options(options, &options::OF_LONG_CALLS, |_| None)?;
        let (views, mesh) = (views_of(input)?, mesh::mesh_of(input)?);
        align_views_task(views, mesh, options, JsHost::new(on_progress), scheduler(helpers))
    };
    JointTask::new(begin(), |alignment| answer(Ok(alignment)))
}

/// Prepares a helper of the alignment that [`begin_align_views`] starts with the same input and options.
#[wasm_bindgen(js_name = beginHelpViews, skip_typescript)]
pub fn begin_help_views(input: &JsValue, options: &JsValue) -> core::result::Result<JointHelper, JsValue> {
    let begin = || {
        let options = options::options(options, &options::OF_LONG_CALLS, |_| None)?;
        views_helper(views_of(input)?, mesh::mesh_of(input)?, options)
    };
    begin().map(JointHelper::from).map_err(|error| to_js(&error))
}

fn views_of(input: &JsValue) -> Result<Vec<View>> {
    items(input, "views")?.iter().enumerate().map(|(k, value)| view(&value, k)).collect()
}

/// A view, whose errors name it.
fn view(value: &JsValue, index: usize) -> Result<View> {
    let read = || Ok(View { frame: input::frame(value)?, world_from_camera: world_from_camera(value)? });
    read().map_err(|error: Error| error.in_view(index))
}

/// The pose of the camera of a view, if it is known.
pub fn world_from_camera(value: &JsValue) -> Result<Option<Similarity>> {
    let pose = get(value, "cameraToWorld").map(|pose| similarity(&pose, "cameraToWorld")).transpose()?;
    if let Some(pose) = &pose
        && (pose.scale - 1.0).abs() > RIGID
    {
        return Err(Error::new(
            ErrorCode::InvalidTransform,
            "cameraToWorld",
            format!("a scale of {}", number(pose.scale)),
            "the pose of a camera: a rotation and a translation in metres",
            "Convert the world to metres, and divide the scale out.",
        ));
    }
    Ok(pose)
}
