//! Scenes: boxes on a floor, on one another and in the air.

use core::ops::ControlFlow;
use std::rc::Rc;

use sim3align::align::align;
use sim3align::pauses::{Pauses, finished};
use sim3align::precise::searched::start::Findings;
use sim3align::scene::contact::Contact;
use sim3align::scene::layers::{extremes, layer, volumes};
use sim3align::scene::local::View;
use sim3align::scene::placement::{Body, Placement};
use sim3align::scene::plan::Plan;
use sim3align::scene::planes::union_of;
use sim3align::scene::support::{RestsOn, SupportChoice, find_support};
use sim3align::scene::task::{Scene, SceneAlignment, SceneObject, align_scene, place};

use super::shapes::{cuboid, mapped};

use crate::prelude::*;

const WIDTH: usize = 200;
const HEIGHT: usize = 150;

fn camera() -> Pinhole {
    Pinhole::new(220.0, 220.0, 99.5, 74.5).unwrap()
}

/// A wedge: a box whose top slopes, so that no turn maps it onto itself.
fn wedge(extent: Vec3) -> Mesh {
    mapped(&cuboid(extent), |p| {
        if p.y < 0.0 { Vec3::new(0.7 * p.x + 0.05 * extent.x, p.y * (1.0 + 0.5 * p.x / extent.x), p.z) } else { p }
    })
}

/// Camera from world: world x right, y down, the floor at y = 0; the camera 0.6 m over it and tilted.
fn view() -> Similarity {
    let turn = Rotation3::from_axis_angle(&Vector3::x_axis(), 0.6);
    Similarity { scale: 1.0, rotation: turn, translation: Vector3::new(0.0, 0.08, 0.95) }
}

/// A mesh, and its place in the world.
struct Thing {
    mesh: Mesh,
    world_from_mesh: Similarity,
}

fn thing(extent: [f32; 3], at: [f64; 3], turn: f64) -> Thing {
    let rotation = Rotation3::from_axis_angle(&Vector3::y_axis(), turn);
    let mesh = wedge(Vec3::from(extent));
    Thing { mesh, world_from_mesh: Similarity { scale: 1.0, rotation, translation: Vector3::from(at) } }
}

/// The depth map of things and boards on a floor, which it shows at another height, and the masks of the things.
fn seen(things: &[Thing], boards: &[Thing], floor_m: f64, noise: f64) -> (DepthMap, Vec<Mask>) {
    let camera = camera();
    let up = view().rotation * Vector3::new(0.0, -1.0, 0.0);
    let d = -up.dot(&view().translation) - floor_m;
    let mut random = Random::new(7, 920);
    let mut depth: Vec<f32> = (0..WIDTH * HEIGHT)
        .map(|i| {
            let ray = camera.back_project((i % WIDTH) as f64, (i / WIDTH) as f64, 1.0).as_dvec3();
            let z = -d / DVec3::from_array(up.into()).dot(ray);
            if z > 0.0 && z < 5.0 { z as f32 } else { 0.0 }
        })
        .collect();
    let mut owner = vec![0usize; depth.len()];
    let mut rasteriser = Rasteriser::new();
    for (k, thing) in things.iter().chain(boards).enumerate() {
        rasteriser.render_depth(&thing.mesh, &view().compose(&thing.world_from_mesh), &camera, WIDTH, HEIGHT);
        for (i, z) in rasteriser.depth().iter().enumerate() {
            if *z > 0.0 && (depth[i] == 0.0 || *z < depth[i]) {
                (depth[i], owner[i]) = (*z, k + 1);
            }
        }
    }
    for z in &mut depth {
        *z *= (1.0 + noise * (random.uniform() - 0.5)) as f32;
    }
    let mask = |k: usize| {
        let pixels = owner.iter().map(|o| u8::from(*o == k + 1)).collect();
        Image::new("mask", WIDTH, HEIGHT, pixels).unwrap()
    };
    (DepthMap::from_metres(WIDTH, HEIGHT, depth).unwrap(), (0..things.len()).map(mask).collect())
}

fn options() -> AlignOptions {
    AlignOptions { quality: Quality::Fast, metrics: false, ..AlignOptions::default() }
}

fn scene_of<'m>(things: &'m [Thing], support: SupportChoice, snap: bool) -> Scene<'m> {
    scene_with(things, seen(things, &[], 0.0, 0.002), support, snap)
}

fn scene_with<'m>(
    things: &'m [Thing],
    (depth, masks): (DepthMap, Vec<Mask>),
    support: SupportChoice,
    snap: bool,
) -> Scene<'m> {
    let object = |(thing, mask): (&'m Thing, Mask)| SceneObject {
        mask,
        mesh: PreparedMesh::borrowed(&thing.mesh),
        options: options(),
    };
    let objects = things.iter().zip(masks).map(object).collect();
    Scene { depth, camera: camera(), relief_deviation: 0.0, objects, occluders: Vec::new(), support, snap }
}

fn pose(scene: &SceneAlignment, i: usize) -> Similarity {
    pose_of(&scene.objects[i].as_ref().unwrap().alignment.camera_from_mesh)
}

fn contacts(scene: &SceneAlignment) -> Vec<Contact> {
    scene.objects.iter().map(|object| object.as_ref().unwrap().contact.clone()).collect()
}

/// Two wedges on the floor, one on top of another, and one in the air.
fn things() -> Vec<Thing> {
    vec![
        thing([0.16, 0.1, 0.12], [-0.16, -0.05, 0.0], 0.4),
        thing([0.1, 0.16, 0.08], [0.12, -0.08, 0.06], -0.3),
        thing([0.08, 0.07, 0.07], [-0.17, -0.134, 0.0], 1.1),
        thing([0.09, 0.07, 0.08], [0.04, -0.24, -0.1], 0.8),
    ]
}

#[wasm_bindgen_test(unsupported = test)]
fn what_stands_lies_and_hangs_is_told_apart() {
    let things = things();
    let scene = scene_of(&things, SupportChoice::Auto, false);
    let aligned = align_scene(&scene, &mut Silent).unwrap();
    let support = aligned.support.unwrap();
    let up = view().rotation * Vector3::new(0.0, -1.0, 0.0);
    assert!(support.plane.normal.dot(DVec3::from_array(up.into())) > 0.9999, "{support:?}");
    assert!((support.plane.d + up.dot(&view().translation)).abs() < 0.002, "{support:?}");
    let contacts = contacts(&aligned);
    let rests: Vec<_> = contacts.iter().map(|contact| contact.rests_on).collect();
    assert_eq!(rests[0], Some(RestsOn::Support), "{contacts:?}");
    assert_eq!(rests[1], Some(RestsOn::Support), "{contacts:?}");
    assert_eq!(rests[2], Some(RestsOn::Object(0)), "{contacts:?}");
    assert_eq!(rests[3], None, "{contacts:?}");
    // It is not pulled down: its true height is 20 cm.
    let hanging = contacts[3].gap_m.unwrap();
    assert!((hanging - 0.205).abs() < 0.02, "{hanging}");
    for (i, thing) in things.iter().enumerate() {
        let truth = view().compose(&thing.world_from_mesh);
        let found = pose(&aligned, i);
        assert!((found.scale / truth.scale - 1.0).abs() < 0.05, "{i}: {}", found.scale);
        let turn = found.rotation_angle_to(&truth).to_degrees();
        // The smallest one almost maps onto itself by half a turn.
        assert!(turn < 6.0 || (i == 2 && turn > 174.0), "{i}: {turn}");
    }
    assert!(contacts.iter().all(|contact| contact.shared_volume < 0.05), "{contacts:?}");
}

#[wasm_bindgen_test(unsupported = test)]
fn snapping_closes_gaps_along_the_normal_only() {
    let things = things();
    let loose = align_scene(&scene_of(&things, SupportChoice::Auto, false), &mut Silent).unwrap();
    let snapped = align_scene(&scene_of(&things, SupportChoice::Auto, true), &mut Silent).unwrap();
    let normal = snapped.support.unwrap().plane.normal;
    for i in 0..things.len() {
        let contact = &snapped.objects[i].as_ref().unwrap().contact;
        let moved = pose(&snapped, i).translation - pose(&loose, i).translation;
        let moved = DVec3::from_array(moved.into());
        assert!((moved - normal * contact.snapped_m).length() < 1e-12, "{i}: {moved}");
        match contact.rests_on {
            Some(_) => assert!(contact.gap_m.unwrap().abs() < 1e-9, "{i}: {contact:?}"),
            None => assert_eq!(contact.snapped_m, 0.0),
        }
    }
}

/// `align` is a scene of one object without support.
#[wasm_bindgen_test(unsupported = test)]
fn one_object_without_support_is_align() {
    let things = &things()[1..2];
    let scene = scene_of(things, SupportChoice::None, false);
    let aligned = align_scene(&scene, &mut Silent).unwrap();
    assert!(aligned.support.is_none());
    let object = aligned.objects[0].as_ref().unwrap();
    let observation = Observation::new(scene.depth.clone(), scene.objects[0].mask.clone(), camera()).unwrap();
    let expected = align(&observation, &things[0].mesh, &options(), &mut Silent).unwrap();
    assert_eq!(object.alignment.camera_from_mesh, expected.camera_from_mesh);
    assert_eq!(object.alignment.confidence, expected.confidence);
    assert_eq!(object.alignment.alternatives, expected.alternatives);
    assert_eq!(object.alignment.uncertainty, expected.uncertainty);
    assert_eq!(object.alignment.diagnostics.score, expected.diagnostics.score);
}

fn alone(observation: &Observation, object: &SceneObject<'_>) -> Placement {
    let (mut host, pauses) = (Silent, Pauses::none());
    finished(place(observation, &object.mesh, object.options.clone(), None, &mut host, &pauses)).unwrap().0
}

/// What is written of numbers tells them apart to the bit.
#[wasm_bindgen_test(unsupported = test)]
fn plans_survive_as_bytes() {
    let things = &things()[..1];
    let Scene { depth, objects, .. } = scene_of(things, SupportChoice::Auto, false);
    let observation = Observation::new(depth.clone(), objects[0].mask.clone(), camera()).unwrap();
    let taken = union_of(WIDTH, HEIGHT, [&objects[0].mask].into_iter());
    let view = View { depth, camera: camera(), taken, choice: SupportChoice::Auto, seed: 0 };
    let placements = vec![Some(alone(&observation, &objects[0])), None];
    let Ok(ControlFlow::Continue(plan)) = Plan::default().next(placements, false, || Ok(view)) else {
        panic!("no second round")
    };
    let bytes = postcard::to_allocvec(&plan).unwrap();
    let copy: Plan = postcard::from_bytes(&bytes).unwrap();
    assert_eq!(format!("{copy:?}"), format!("{plan:?}"));
    for end in [0, 1, bytes.len() / 2, bytes.len() - 1] {
        assert!(postcard::from_bytes::<Plan>(&bytes[..end]).is_err(), "{end}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn an_object_that_fails_leaves_the_others() {
    let things = things();
    let mut scene = scene_of(&things[..2], SupportChoice::Auto, false);
    scene.objects[1].mask = Image::filled(WIDTH, HEIGHT, 0);
    let aligned = align_scene(&scene, &mut Silent).unwrap();
    assert!(aligned.objects[0].is_ok());
    let error = aligned.objects[1].as_ref().err().unwrap();
    assert_eq!(error.code.as_str(), "EMPTY_MASK");
}

#[wasm_bindgen_test(unsupported = test)]
fn a_board_that_only_the_depth_map_shows_is_a_level() {
    let things =
        [thing([0.16, 0.1, 0.12], [-0.2, -0.05, 0.0], 0.6), thing([0.12, 0.1, 0.08], [0.15, -0.17, 0.06], -0.3)];
    let translation = Vector3::new(0.15, -0.06, 0.06);
    let board = Thing {
        mesh: cuboid(Vec3::new(0.34, 0.12, 0.26)),
        world_from_mesh: Similarity { translation, ..Similarity::identity() },
    };
    let boards = [board];
    for snap in [false, true] {
        let scene = scene_with(&things, seen(&things, &boards, 0.0, 0.002), SupportChoice::Auto, snap);
        let aligned = align_scene(&scene, &mut Silent).unwrap();
        let contacts = contacts(&aligned);
        assert_eq!(contacts[0].rests_on, Some(RestsOn::Support), "{contacts:?}");
        assert_eq!(contacts[1].rests_on, Some(RestsOn::Level), "{contacts:?}");
        // Over the board, not over the floor, which is 12 cm below.
        let most = if snap { 1e-9 } else { 0.006 };
        assert!(contacts[1].gap_m.unwrap().abs() < most, "{contacts:?}");
    }
    // The same object at the same height over the bare floor hangs.
    let scene = scene_of(&things, SupportChoice::Auto, false);
    let aligned = align_scene(&scene, &mut Silent).unwrap();
    assert_eq!(aligned.objects[1].as_ref().unwrap().contact.rests_on, None);
}

/// What an alignment tells that has found a pose this much too high, metres.
fn placed(thing: &Thing, too_high: f64) -> Placement {
    let mut world_from_mesh = thing.world_from_mesh;
    world_from_mesh.translation.y -= too_high;
    let camera_from_mesh = view().compose(&world_from_mesh);
    let points = thing.mesh.positions().iter().map(|p| vec3(&camera_from_mesh.apply(vector3(*p)))).collect();
    let layer = Rc::new(layer(&thing.mesh, &camera_from_mesh, &camera(), [WIDTH, HEIGHT]));
    Placement {
        findings: Findings { confidence: 0.9, ..Findings::default() },
        camera_from_mesh: camera_from_mesh.to_column_major(),
        body: Body { points, layer, along: None },
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn objects_tell_by_how_much_the_depth_map_misplaces_the_floor() {
    let things = [
        thing([0.16, 0.1, 0.12], [-0.18, -0.05, 0.05], 0.4),
        thing([0.1, 0.16, 0.08], [0.03, -0.08, 0.1], -0.3),
        thing([0.12, 0.09, 0.1], [0.2, -0.045, -0.05], 1.1),
    ];
    for floor_m in [-0.008, 0.0, 0.008] {
        let (depth, masks) = seen(&things, &[], floor_m, 0.001);
        let taken = union_of(WIDTH, HEIGHT, masks.iter());
        let seen = View { depth, camera: camera(), taken, choice: SupportChoice::Auto, seed: 0 };
        // The last one may have been found 2 cm too high.
        for too_high in [0.0, 0.02] {
            let placements: Vec<_> =
                things.iter().zip([0.0, 0.0, too_high]).map(|(thing, high)| Some(placed(thing, high))).collect();
            let (support, grounds) = find_support(&seen, &placements);
            let support = support.unwrap();
            for ground in grounds.into_iter().flatten() {
                assert_eq!(ground.on, RestsOn::Support);
                let offset = support.plane.d - ground.plane.d;
                // Large offsets are less likely: two objects against one do not tell all of it.
                let most = if too_high > 0.0 { 0.004 } else { 0.002 };
                assert!((offset + floor_m).abs() < most, "{floor_m}, {too_high}: {offset}");
            }
        }
    }
}

/// Colours may choose another pose than the search.
#[wasm_bindgen_test(unsupported = test)]
fn the_space_of_an_object_is_that_of_its_alignment() {
    let things = &things()[..1];
    let scene = scene_of(things, SupportChoice::None, false);
    let object = &scene.objects[0];
    let observation = Observation::new(scene.depth.clone(), object.mask.clone(), camera()).unwrap();
    let placement = alone(&observation, object);
    let mut alignment = align(&observation, &things[0].mesh, &options(), &mut Silent).unwrap();
    let normal = DVec3::NEG_Y;
    let body = |alignment: &Alignment| {
        placement.clone().in_pose_of(alignment, &object.mesh, &observation, Some(normal)).unwrap().body
    };
    assert_eq!(body(&alignment).layer, placement.body.layer);
    // Turned over and moved away from the camera.
    let mut turned = Similarity::from_column_major(&placement.camera_from_mesh).unwrap();
    turned.rotation *= Rotation3::from_axis_angle(&Vector3::x_axis(), core::f64::consts::PI);
    turned.translation.z += 0.1;
    alignment.camera_from_mesh = (&turned).into();
    let body = body(&alignment);
    let expected = layer(&things[0].mesh, &turned, &camera(), [WIDTH, HEIGHT]);
    let [own, shared] = volumes(&body.layer, &expected, &camera());
    assert!(shared > 0.97 * own, "{own} and {shared}");
    let heights = things[0].mesh.positions().iter().map(|p| -turned.apply(vector3(*p)).y);
    let [low, high] = body.along.unwrap();
    let [lowest, highest] = extremes(heights);
    assert!((low - lowest).abs() < 1e-6 && (high - highest).abs() < 1e-6, "{low}, {high}");
}
