//! The steps of a scene. What one step hands over to the next crosses to JavaScript, so that objects can be aligned by
//! different workers: numbers in typed arrays, without loss.

use core::cell::RefCell;
use std::rc::Rc;

use glam::DVec3;
use js_sys::{Array, Float32Array, Float64Array, Function, Object, Reflect};
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

use sim3align::align::search::Given;
use sim3align::bindings::answer::answer;
use sim3align::bindings::error::to_js;
use sim3align::bindings::host::{JsHost, now_ms};
use sim3align::bindings::object::{get, required_number, to_f32s, to_f64s, to_numbers, to_u8s, wrong_type};
use sim3align::bindings::{input, mesh, options};
use sim3align::error::{Error, ErrorCode, Result};
use sim3align::geometry::image::{Image, Mask};
use sim3align::geometry::similarity::Similarity;
use sim3align::number::number;
use sim3align::options::Choice;
use sim3align::pauses::{Pauses, Task};
use sim3align::precise::scored::surroundings::{Layer, Neighbourhood};
use sim3align::report::{Alignment, Effort};
use sim3align::scene::contact::contacts;
use sim3align::scene::local::View;
use sim3align::scene::placement::{Body, Placement, found_of};
use sim3align::scene::plane::Plane;
use sim3align::scene::planes::union_of;
use sim3align::scene::support::{Ground, RestsOn, Support, SupportChoice, find_support};
use sim3align::scene::task::{alone, together};

/// A step of one object of a scene.
#[wasm_bindgen(skip_typescript)]
pub struct PlaceTask(RefCell<Task<'static, (Option<Alignment>, Placement)>>);

/// Begins to align an object of a scene alone or, with `known`, with what the others have told:
/// `{ placement, ground, layers }`.
#[wasm_bindgen(js_name = beginPlace, skip_typescript)]
pub fn begin_place(
    input: &JsValue,
    options: &JsValue,
    known: &JsValue,
    on_progress: Option<Function>,
) -> core::result::Result<PlaceTask, JsValue> {
    let begin = || {
        let options = options::precise(options)?;
        let (observation, mesh) = (input::observation(input)?, mesh::mesh_of(input)?);
        let given = optional(known, given)?;
        let mut host = JsHost::new(on_progress);
        Ok(Task::new(Pauses::new(now_ms, None), |pauses| async move {
            let Some(given) = given else {
                return Ok((None, alone(&observation, &mesh, options, &mut host, &pauses).await?));
            };
            let (alignment, placement) = together(&observation, &mesh, options, &given, &mut host, &pauses).await?;
            Ok((Some(alignment), placement))
        }))
    };
    begin().map(|task| PlaceTask(RefCell::new(task))).map_err(|error: Error| to_js(&error))
}

#[wasm_bindgen]
impl PlaceTask {
    /// Runs for about `slice_ms` milliseconds. Returns `{ placement, alignment? }` when finished, otherwise `undefined`.
    #[wasm_bindgen(skip_typescript)]
    pub fn step(&self, slice_ms: f64) -> core::result::Result<JsValue, JsValue> {
        let done = self.0.borrow_mut().step(now_ms() + slice_ms).map_err(|error| to_js(&error))?;
        let Some((alignment, placement)) = done else { return Ok(JsValue::UNDEFINED) };
        let alignment = alignment.map_or(Ok(JsValue::UNDEFINED), |alignment| answer(Ok(alignment)))?;
        Ok(object([("placement", placement_object(&placement)), ("alignment", alignment)]))
    }
}

/// The support of a scene, and what each object may stand on:
/// `({ depth, …, camera, masks }, placements, support, seed) → { support, grounds }`. A placement is `null` for an object
/// that could not be aligned.
#[wasm_bindgen(js_name = sceneSupport, skip_typescript)]
pub fn scene_support(
    view: &JsValue,
    placements: &JsValue,
    support: &JsValue,
    seed: u32,
) -> core::result::Result<JsValue, JsValue> {
    let run = || {
        let (depth, camera) = input::view(view)?;
        let (width, height) = (depth.width(), depth.height());
        let masks = Array::from(&of(view, "masks"));
        let masks: Vec<Mask> = masks
            .iter()
            .map(|mask| Image::new("mask", width, height, to_u8s(&mask, "mask")?))
            .collect::<Result<_>>()?;
        let placements: Vec<_> =
            Array::from(placements).iter().map(|p| optional(&p, placement)).collect::<Result<_>>()?;
        let taken = union_of(width, height, masks.iter());
        let view = View { depth: &depth, camera: &camera, taken: &taken, seed: u64::from(seed) };
        let (support, grounds) = find_support(&view, &choice(support)?, &placements);
        let grounds: Array = grounds.iter().map(|g| g.as_ref().map_or(JsValue::NULL, ground_object)).collect();
        Ok(object([("support", support.as_ref().map_or(JsValue::NULL, support_object)), ("grounds", grounds.into())]))
    };
    run().map_err(|error: Error| to_js(&error))
}

/// The contacts of posed objects: `({ camera }, placements, { support, grounds }, snap) → [contact | null]`.
#[wasm_bindgen(js_name = sceneContacts, skip_typescript)]
pub fn scene_contacts(
    view: &JsValue,
    placements: &JsValue,
    supported: &JsValue,
    snap: bool,
) -> core::result::Result<JsValue, JsValue> {
    let run = || {
        let camera = input::camera(&of(view, "camera"))?;
        let bodies: Vec<_> = Array::from(placements).iter().map(|p| optional(&p, body)).collect::<Result<_>>()?;
        let support = optional(&of(supported, "support"), plane)?;
        let grounds = of(supported, "grounds");
        let grounds: Vec<_> = Array::from(&grounds).iter().map(|g| ground(&g)).collect::<Result<_>>()?;
        Ok(contacts(&bodies, &grounds, support.as_ref(), &camera, snap))
    };
    answer(run())
}

fn of(object: &JsValue, key: &str) -> JsValue {
    get(object, key).unwrap_or(JsValue::UNDEFINED)
}

fn optional<T>(value: &JsValue, read: impl Fn(&JsValue) -> Result<T>) -> Result<Option<T>> {
    if value.is_object() { read(value).map(Some) } else { Ok(None) }
}

fn object<const N: usize>(fields: [(&str, JsValue); N]) -> JsValue {
    let object = Object::new();
    for (name, value) in fields {
        // Setting a property of a new object cannot fail.
        let _ = Reflect::set(&object, &name.into(), &value);
    }
    object.into()
}

/// `"auto"`, `{ normal, d }` or `null`.
fn choice(value: &JsValue) -> Result<SupportChoice> {
    if value.is_null() {
        return Ok(SupportChoice::None);
    }
    if value.is_undefined() || value.as_string().as_deref() == Some("auto") {
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

fn given(known: &JsValue) -> Result<Given> {
    let ground = ground(&of(known, "ground"))?.map(|ground| ground.known());
    let layers = Array::from(&of(known, "layers"));
    let layers = layers.iter().map(|l| Ok(Rc::new(layer(&l)?))).collect::<Result<_>>()?;
    Ok(placement(&of(known, "placement"))?.given(Neighbourhood { ground, layers }))
}

fn placement(value: &JsValue) -> Result<Placement> {
    let mut effort = Effort::default();
    effort.set(&of(value, "effort").as_string().unwrap_or_default());
    let found = found_of(&to_f64s(&of(value, "found"), "placement.found")?);
    Ok(Placement {
        found,
        effort,
        renders: required_number(value, "placement", "renders")? as usize,
        confidence: required_number(value, "placement", "confidence")?,
        camera_from_mesh: Similarity::from_column_major(&to_numbers(&of(value, "matrix"), "placement.matrix")?)?,
        body: body(value)?,
    })
}

fn body(value: &JsValue) -> Result<Body> {
    let points = to_f32s(&of(value, "points"), "placement.points")?;
    let points = points.as_chunks().0.iter().map(|p: &[f32; 3]| glam::Vec3::from(*p)).collect();
    let along = optional(&of(value, "along"), |along| to_numbers::<2>(along, "placement.along"))?;
    Ok(Body { points, layer: Rc::new(layer(value)?), along })
}

fn layer(value: &JsValue) -> Result<Layer> {
    let spans = to_f32s(&of(value, "spans"), "placement.spans")?;
    let origin = to_numbers::<2>(&of(value, "origin"), "placement.origin")?;
    let width = required_number(value, "placement", "layerWidth")? as usize;
    Ok(Layer { origin: origin.map(|x| x as usize), width, spans: spans.as_chunks().0.to_vec() })
}

fn plane(value: &JsValue) -> Result<Plane> {
    let normal = to_numbers::<3>(&of(value, "normal"), "ground.normal")?;
    Ok(Plane { normal: normal.into(), d: required_number(value, "ground", "d")? })
}

fn ground(value: &JsValue) -> Result<Option<Ground>> {
    if !value.is_object() {
        return Ok(None);
    }
    Ok(Some(Ground {
        plane: plane(value)?,
        gap_m: required_number(value, "ground", "gapM")?,
        on: rests_on(&of(value, "on")),
    }))
}

fn rests_on(value: &JsValue) -> RestsOn {
    match (value.as_f64(), value.as_string().as_deref()) {
        (Some(on), _) => RestsOn::Object(on as usize),
        (None, Some("level")) => RestsOn::Level,
        _ => RestsOn::Support,
    }
}

fn placement_object(placement: &Placement) -> JsValue {
    let Placement { effort, renders, confidence, camera_from_mesh, body, .. } = placement;
    let Layer { origin, width, spans } = body.layer.as_ref();
    let points: Vec<f32> = body.points.iter().flat_map(|p| p.to_array()).collect();
    let origin = origin.map(|x| JsValue::from(x as f64));
    object([
        ("found", Float64Array::from(placement.numbers().as_slice()).into()),
        ("effort", effort.name().into()),
        ("renders", (*renders as f64).into()),
        ("confidence", (*confidence).into()),
        ("matrix", Float64Array::from(camera_from_mesh.to_column_major().as_slice()).into()),
        ("points", Float32Array::from(points.as_slice()).into()),
        (
            "along",
            body.along.map_or(JsValue::NULL, |along| along.iter().map(|x| JsValue::from(*x)).collect::<Array>().into()),
        ),
        ("origin", origin.iter().collect::<Array>().into()),
        ("layerWidth", (*width as f64).into()),
        ("spans", Float32Array::from(spans.as_flattened()).into()),
    ])
}

fn plane_fields(plane: &Plane) -> [(&'static str, JsValue); 2] {
    let normal: Array = plane.normal.to_array().iter().map(|x| JsValue::from(*x)).collect();
    [("normal", normal.into()), ("d", plane.d.into())]
}

fn ground_object(ground: &Ground) -> JsValue {
    let [normal, d] = plane_fields(&ground.plane);
    let on = match ground.on {
        RestsOn::Support => "support".into(),
        RestsOn::Level => "level".into(),
        RestsOn::Object(on) => JsValue::from(on as f64),
    };
    object([normal, d, ("gapM", ground.gap_m.into()), ("on", on)])
}

fn support_object(support: &Support) -> JsValue {
    let [normal, d] = plane_fields(&support.plane);
    object([normal, d, ("confidence", support.confidence.into())])
}
