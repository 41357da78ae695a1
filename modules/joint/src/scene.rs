//! Scenes: the alignment of one object, and what follows from those of all. Plans and placements are bytes for JavaScript,
//! which only hands them on, so that objects can be aligned by different workers.

use core::ops::ControlFlow;

use glam::DVec3;
use js_sys::{Array, Function, Uint8Array};
use serde::Serialize;
use serde::de::DeserializeOwned;
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

use sim3align::bindings::answer::answer;
use sim3align::bindings::answer::to_js;
use sim3align::bindings::helpers::{JsHelpers, scheduler};
use sim3align::bindings::host::JsHost;
use sim3align::bindings::object::{required_number, to_numbers, to_u8s, wrong_type};
use sim3align::bindings::{input, mesh, options};
use sim3align::error::{Error, ErrorCode, Result};
use sim3align::geometry::image::{Image, Mask};
use sim3align::number::number;
use sim3align::report::Alignment;
use sim3align::scene::local::View;
use sim3align::scene::placement::Placement;
use sim3align::scene::plan::{Plan, missing};
use sim3align::scene::plane::Plane;
use sim3align::scene::plane::SupportChoice;
use sim3align::scene::planes::union_of;
use sim3align::scene::task::{helper, place};
use sim3align::scheduler::Task;

use crate::task::{Answer, JointHelper, JointTask, object, of};

/// Begins to align an object of a scene in a round of its `plan`, which is not there in the first one; `index` is its number.
#[wasm_bindgen(js_name = beginPlace, skip_typescript)]
pub fn begin_place(
    input: &JsValue,
    options: &JsValue,
    on_progress: Option<Function>,
    helpers: Option<JsHelpers>,
) -> core::result::Result<JointTask, JsValue> {
    let begin = || {
        let options = options::precise(options)?;
        let (observation, mesh) = (input::observation(input)?, mesh::mesh_of(input)?);
        let (plan, index) = planned(input)?;
        let mut host = JsHost::new(on_progress);
        Ok(Task::new(scheduler(helpers), move |scheduler| async move {
            place(&observation, &mesh, options, plan.warm_start(index)?, &mut host, &scheduler).await
        }))
    };
    JointTask::new(begin(), placed)
}

/// `{ placement, alignment? }`.
fn placed((placement, alignment): (Placement, Option<Alignment>)) -> Answer {
    let alignment = alignment.map_or(Ok(JsValue::UNDEFINED), |alignment| answer(Ok(alignment)))?;
    Ok(object([("placement", packed(&placement)?), ("alignment", alignment)]))
}

/// Prepares a helper of the alignment that [`begin_place`] begins with the same input and options.
#[wasm_bindgen(js_name = beginHelpPlace, skip_typescript)]
pub fn begin_help(input: &JsValue, options: &JsValue) -> core::result::Result<JointHelper, JsValue> {
    let begin = || {
        let options = options::precise(options)?;
        let (observation, mesh) = (input::observation(input)?, mesh::mesh_of(input)?);
        let (plan, index) = planned(input)?;
        helper(observation, mesh, options, plan.warm_start(index)?)
    };
    begin().map(JointHelper::from).map_err(|error: Error| to_js(&error))
}

/// The plan of the scene, and the number of the object.
fn planned(input: &JsValue) -> Result<(Plan, usize)> {
    let plan = unpacked(&of(input, "plan"))?.unwrap_or_default();
    Ok((plan, required_number(input, "input", "index")? as usize))
}

/// What follows from the placements of a round: `({ depth, …, camera, masks, support, seed, snap }, plan, placements)` →
/// `{ plan }` of another round, or `{ objects, support }`. A placement is `null` for an object that could not be aligned.
#[wasm_bindgen(js_name = planScene, skip_typescript)]
pub fn plan_scene(scene: &JsValue, plan: &JsValue, placements: &Array) -> Answer {
    let run = || {
        let plan: Plan = unpacked(plan)?.unwrap_or_default();
        let placements = placements.iter().map(|placement| unpacked(&placement)).collect::<Result<_>>()?;
        plan.next(placements, of(scene, "snap").is_truthy(), || view(scene))
    };
    match run().map_err(|error| to_js(&error))? {
        ControlFlow::Continue(plan) => Ok(object([("plan", packed(&plan)?)])),
        ControlFlow::Break(arrangement) => answer(Ok(arrangement)),
    }
}

fn view(scene: &JsValue) -> Result<View> {
    let (depth, camera) = input::view(scene)?;
    let (width, height) = (depth.width(), depth.height());
    let masks = Array::from(&of(scene, "masks"));
    let masks: Vec<Mask> =
        masks.iter().map(|mask| Image::new("mask", width, height, to_u8s(&mask, "mask")?)).collect::<Result<_>>()?;
    let taken = union_of(width, height, masks.iter());
    let seed = required_number(scene, "options", "seed")? as u64;
    Ok(View { depth, camera, taken, choice: choice(&of(scene, "support"))?, seed })
}

/// As bytes, without loss.
fn packed(value: &impl Serialize) -> Answer {
    let bytes = postcard::to_allocvec(value).map_err(|_| to_js(&missing()))?;
    Ok(Uint8Array::from(bytes.as_slice()).into())
}

/// The value of [`packed`]; `None` for `null` and `undefined`.
fn unpacked<T: DeserializeOwned>(bytes: &JsValue) -> Result<Option<T>> {
    if bytes.is_null() || bytes.is_undefined() {
        return Ok(None);
    }
    postcard::from_bytes(&to_u8s(bytes, "placement")?).map(Some).map_err(|_| missing())
}

/// `"auto"`, `{ normal, d }` or nothing.
fn choice(value: &JsValue) -> Result<SupportChoice> {
    if value.is_undefined() {
        return Ok(SupportChoice::None);
    }
    if value.as_string().as_deref() == Some("auto") {
        return Ok(SupportChoice::Auto);
    }
    let invalid = || {
        let remedy = "The plane is n·x + d = 0 in the camera frame, metres; n points to the side of the objects.";
        wrong_type("support", value, "\"auto\", { normal: [x, y, z], d } or null", remedy)
    };
    let normal = to_numbers::<3>(&of(value, "normal"), "support.normal").map_err(|_| invalid())?;
    let d = required_number(value, "support", "d")?;
    let normal = DVec3::from(normal);
    let length = normal.length();
    if !(length > 0.0 && length.is_finite()) {
        return Err(Error::new(
            ErrorCode::InvalidArgument,
            "support.normal",
            format!("[{}, {}, {}]", number(normal.x), number(normal.y), number(normal.z)),
            "a direction: three finite numbers that are not all 0",
            "Pass the normal of the plane, of any length; or \"auto\", to find the plane.",
        ));
    }
    if !d.is_finite() {
        return Err(invalid());
    }
    // As it is given: the camera may be below it.
    Ok(SupportChoice::Plane(Plane { normal: normal / length, d: d / length }))
}
