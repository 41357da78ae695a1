//! Calibrations of views, in steps.

use std::rc::Rc;

use js_sys::{Array, Float32Array, Function};
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

use sim3align::bindings::answer::answer;
use sim3align::bindings::host::{JsHost, now_ms};
use sim3align::bindings::object::{get, to_u8s};
use sim3align::bindings::{input, mesh, options};
use sim3align::calibrate::frames::calibrate_views;
use sim3align::calibrate::{Calibrated, Object as CalibratedObject, calibrate};
use sim3align::error::Result;
use sim3align::evidence::observation::check_mask_size;
use sim3align::geometry::image::{Image, Mask};
use sim3align::precise::drawing::prepared_mesh::PreparedMesh;
use sim3align::precise::options::AlignOptions;
use sim3align::scheduler::{Scheduler, Task};
use sim3align::views::ViewsOptions;

use crate::task::{Answer, JointTask, items, object, of};
use crate::views::world_from_camera;

/// An object that owns its parts.
struct OwnedObject {
    mask: Mask,
    others: Option<Mask>,
    mesh: Rc<PreparedMesh<'static>>,
    options: AlignOptions,
}

/// Begins to calibrate a view: `{ depth, depthScale?, width, height, camera, depthKind?, focalDeviation?, objects: [{ mask, maskWidth?,
/// maskHeight?, resizeMask?, others?, mesh, options }] }`.
#[wasm_bindgen(js_name = beginCalibrate, skip_typescript)]
pub fn begin_calibrate(input: &JsValue, on_progress: Option<Function>) -> core::result::Result<JointTask, JsValue> {
    let begin = || {
        let view = input::raw_view(input)?;
        let size = [view.values.width(), view.values.height()];
        let objects = usable(items(input, "objects")?.iter().map(|object| owned(&object, size)))?;
        let mut host = JsHost::new(on_progress);
        Ok(Task::new(Scheduler::new(now_ms, None), move |scheduler| async move {
            let borrowed: Vec<CalibratedObject<'_>> = objects
                .iter()
                .map(|OwnedObject { mask, others, mesh, options }| CalibratedObject {
                    mask,
                    others: others.clone(),
                    mesh,
                    options,
                })
                .collect();
            calibrate(&view, &borrowed, &mut host, &scheduler).await
        }))
    };
    JointTask::new(begin(), |view| calibrated(&view))
}

/// The objects that can be used: the error of one is reported where it is aligned, unless all fail.
fn usable(objects: impl Iterator<Item = Result<OwnedObject>>) -> Result<Vec<OwnedObject>> {
    let mut usable = Vec::new();
    let mut first = None;
    for object in objects {
        match object {
            Ok(object) => usable.push(object),
            Err(error) if error.argument.starts_with("options") => return Err(error),
            Err(error) => first = first.or(Some(error)),
        }
    }
    match first {
        Some(error) if usable.is_empty() => Err(error),
        _ => Ok(usable),
    }
}

fn owned(object: &JsValue, [width, height]: [usize; 2]) -> Result<OwnedObject> {
    let mask = input::mask(object, width, height)?;
    check_mask_size([width, height], &mask)?;
    let others =
        get(object, "others").map(|others| Image::new("occluders", width, height, to_u8s(&others, "occluders")?));
    let options = options::precise(&of(object, "options"))?;
    let mesh = mesh::mesh_of(object)?;
    mesh.check()?;
    Ok(OwnedObject { mask, others: others.transpose()?, mesh, options })
}

/// Begins to calibrate several views of an object: `{ mesh, options, views: [{ depth, depthScale?, width, height, camera, depthKind?,
/// focalDeviation?, mask, cameraToWorld? }] }`.
#[wasm_bindgen(js_name = beginCalibrateViews, skip_typescript)]
pub fn begin_calibrate_views(
    input: &JsValue,
    on_progress: Option<Function>,
) -> core::result::Result<JointTask, JsValue> {
    let begin = || {
        let options: ViewsOptions = options::options(&of(input, "options"), &options::OF_LONG_CALLS, |_| None)?;
        let frame = |(k, value): (usize, JsValue)| {
            let read = || input::raw_frame(&value, world_from_camera(&value)?);
            read().map_err(|error| error.in_view(k))
        };
        let frames = items(input, "views")?.iter().enumerate().map(frame).collect::<Result<Vec<_>>>()?;
        let mesh = mesh::mesh_of(input)?;
        let mut host = JsHost::new(on_progress);
        Ok(Task::new(Scheduler::new(now_ms, None), move |scheduler| async move {
            calibrate_views(&frames, &mesh, &options.of_one_view(), &mut host, &scheduler).await
        }))
    };
    JointTask::new(begin(), |views| {
        let views: core::result::Result<Array, JsValue> = views.iter().map(calibrated).collect();
        views.map(Into::into)
    })
}

/// `{ depth, calibration }`.
fn calibrated(Calibrated { depth, calibration, .. }: &Calibrated) -> Answer {
    let depth = Float32Array::from(depth.data()).into();
    Ok(object([("depth", depth), ("calibration", answer(Ok(calibration))?)]))
}
