//! The export of the module for simulators. It reads its arguments, calls the crate `sim3align-physics`, and returns plain
//! objects.

use glam::DVec3;
use js_sys::{Array, Float64Array, Object as JsObject, Reflect, Uint32Array};
use sim3align::bindings::answer::to_js;
use sim3align::bindings::object::{get, required_number, to_f32s, to_u32s, wrong_type};
use sim3align::bindings::transform;
use sim3align::error::Result;
use sim3align::geometry::mesh::Mesh;
use sim3align_physics::body::Pose;
use sim3align_physics::part::ConvexPart;
use sim3align_physics::scene::{Motion, Object, On, Settings, Settled, settle};
use wasm_bindgen::prelude::*;

/// Bodies at rest: `([{ mesh, transform, on }], { density, parts, turnDeg, moveM, rest,
/// fitsGround }) → { bodies, supportHeightM }`. Transforms are world from mesh, z up; `on` is `"support"`, the index of an object, or `null`.
#[wasm_bindgen(js_name = settleBodies, skip_typescript)]
pub fn settle_bodies(objects: &JsValue, settings: &JsValue) -> core::result::Result<JsValue, JsValue> {
    let run = || {
        let number = |name| required_number(settings, "options", name);
        let is_true = |name| get(settings, name).is_some_and(|value| value.is_truthy());
        let settings = Settings {
            density: number("density")?,
            parts: number("parts")? as usize,
            turn_deg: number("turnDeg")?,
            move_m: number("moveM")?,
            rest: is_true("rest"),
            fits_ground: is_true("fitsGround"),
        };
        let list = Array::is_array(objects).then(|| Array::from(objects));
        let list = list.ok_or_else(|| wrong_type("objects", objects, "an array", "Pass the objects."))?;
        let objects: Vec<Object> = list.iter().map(|object| read(&object)).collect::<Result<_>>()?;
        let (bodies, height_m) = settle(&objects, &settings);
        let bodies: Array = bodies.iter().map(body).collect();
        Ok(object(&[("bodies", bodies.into()), ("supportHeightM", height_m.into())]))
    };
    run().map_err(|error: sim3align::error::Error| to_js(&error))
}

fn read(object: &JsValue) -> Result<Object> {
    let of = |name| get(object, name).unwrap_or(JsValue::UNDEFINED);
    let (on, mesh) = (of("on"), of("mesh"));
    let part = |name| get(&mesh, name).unwrap_or(JsValue::UNDEFINED);
    Ok(Object {
        mesh: Mesh::from_flat(
            &to_f32s(&part("positions"), "mesh.positions")?,
            Some(&to_u32s(&part("indices"), "mesh.indices")?),
        )?,
        world_from_mesh: transform::similarity(&of("transform"), "transform")?,
        on: match (on.as_f64(), on.is_string()) {
            (Some(index), _) => On::Object(index as usize),
            (None, true) => On::Ground,
            (None, false) => On::Nothing,
        },
    })
}

fn body(settled: &Settled) -> JsValue {
    let Settled { body, found, is_free, motion: of_body, rest, cut_m, inside } = settled;
    let parts: Array = body.parts.iter().map(part).collect();
    let inside: Array = inside.iter().map(|i| JsValue::from(*i as f64)).collect();
    object(&[
        ("parts", parts.into()),
        ("pose", pose(body.pose)),
        ("found", pose(*found)),
        ("mass", body.mass.mass.into()),
        ("center", vector(body.mass.center)),
        ("moments", vector(body.mass.moments)),
        ("axes", Float64Array::from(body.mass.axes.to_array().as_slice()).into()),
        ("isFree", (*is_free).into()),
        ("movedM", of_body.move_m.into()),
        ("turnedDeg", of_body.turn_deg.into()),
        ("rest", rest.map_or(JsValue::NULL, motion)),
        ("cutM", (*cut_m).into()),
        ("inside", inside.into()),
        ("wallsJoined", body.walls_joined.map_or(JsValue::NULL, |walls| JsValue::from(walls as f64))),
    ])
}

fn motion(Motion { move_m, turn_deg }: Motion) -> JsValue {
    object(&[("moveM", move_m.into()), ("turnDeg", turn_deg.into())])
}

fn pose(Pose { rotation, translation }: Pose) -> JsValue {
    object(&[
        ("rotation", Float64Array::from(rotation.to_array().as_slice()).into()),
        ("translation", vector(translation)),
    ])
}

fn part(part: &ConvexPart) -> JsValue {
    let positions: Vec<f64> = part.positions.iter().flat_map(|p| p.to_array()).collect();
    object(&[
        ("positions", Float64Array::from(positions.as_slice()).into()),
        ("indices", Uint32Array::from(part.triangles.as_flattened()).into()),
    ])
}

fn vector(v: DVec3) -> JsValue {
    Float64Array::from(v.to_array().as_slice()).into()
}

fn object(properties: &[(&str, JsValue)]) -> JsValue {
    let object = JsObject::new();
    for (name, value) in properties {
        // A fresh object is extensible: setting a property on it cannot fail.
        let _ = Reflect::set(&object, &(*name).into(), value);
    }
    object.into()
}
