//! Scenes: boxes on a floor, on one another and in the air.

use sim3align::scene::contact::Contact;
use sim3align::scene::plane::SupportChoice;
use sim3align::scene::support::RestsOn;
use sim3align::scene::task::{Scene, SceneAlignment, SceneObject, align_scene};

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
pub struct Thing {
    mesh: Mesh,
    world_from_mesh: Similarity,
}

fn thing(extent: [f32; 3], at: [f64; 3], turn: f64) -> Thing {
    let rotation = Rotation3::from_axis_angle(&Vector3::y_axis(), turn);
    let mesh = wedge(Vec3::from(extent));
    Thing { mesh, world_from_mesh: Similarity { scale: 1.0, rotation, translation: Vector3::from(at) } }
}

/// The depth map of things and boards on a floor, with noise, and the masks of the things.
fn seen(things: &[Thing], boards: &[Thing]) -> (DepthMap, Vec<Mask>) {
    let camera = camera();
    let up = view().rotation * Vector3::new(0.0, -1.0, 0.0);
    let d = -up.dot(&view().translation);
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
        rasteriser.render(&thing.mesh, &view().compose(&thing.world_from_mesh), &camera, WIDTH, HEIGHT);
        for (i, z) in rasteriser.depth().iter().enumerate() {
            if *z > 0.0 && (depth[i] == 0.0 || *z < depth[i]) {
                (depth[i], owner[i]) = (*z, k + 1);
            }
        }
    }
    for z in &mut depth {
        *z *= (1.0 + 0.002 * (random.uniform() - 0.5)) as f32;
    }
    let mask = |k: usize| {
        let pixels = owner.iter().map(|o| u8::from(*o == k + 1)).collect();
        Image::new("mask", WIDTH, HEIGHT, pixels).unwrap()
    };
    (DepthMap::from_metres(WIDTH, HEIGHT, depth).unwrap(), (0..things.len()).map(mask).collect())
}

/// The scene of things, before boards that no object stands for.
pub fn scene_of<'m>(things: &'m [Thing], boards: &[Thing], snap: bool) -> Scene<'m> {
    let (depth, masks) = seen(things, boards);
    let object = |(thing, mask): (&'m Thing, Mask)| SceneObject {
        mask,
        mesh: PreparedMesh::borrowed(&thing.mesh),
        options: AlignOptions { quality: Quality::Fast, metrics: false, ..AlignOptions::default() },
    };
    let (objects, support) = (things.iter().zip(masks).map(object).collect(), SupportChoice::Auto);
    Scene { depth, camera: camera(), relief_deviation: 0.0, objects, occluders: Vec::new(), support, snap }
}

fn pose(scene: &SceneAlignment, i: usize) -> Similarity {
    pose_of(&scene.objects[i].as_ref().unwrap().alignment.camera_from_mesh)
}

fn contacts(scene: &SceneAlignment) -> Vec<Contact> {
    scene.objects.iter().map(|object| object.as_ref().unwrap().contact.clone()).collect()
}

/// Two wedges on the floor, one on top of another, and one in the air.
pub fn things() -> Vec<Thing> {
    vec![
        thing([0.16, 0.1, 0.12], [-0.16, -0.05, 0.0], 0.4),
        thing([0.1, 0.16, 0.08], [0.12, -0.08, 0.06], -0.3),
        thing([0.08, 0.07, 0.07], [-0.17, -0.134, 0.0], 1.1),
        thing([0.09, 0.07, 0.08], [0.04, -0.24, -0.1], 0.8),
    ]
}

#[wasm_bindgen_test]
fn what_stands_lies_and_hangs_is_told_apart() {
    let things = things();
    let scene = scene_of(&things, &[], false);
    let aligned = align_scene(&scene, &mut Silent).unwrap();
    let support = aligned.support.unwrap();
    let up = view().rotation * Vector3::new(0.0, -1.0, 0.0);
    assert!(support.plane.normal.dot(DVec3::from_array(up.into())) > 0.9999, "{support:?}");
    assert!((support.plane.d + up.dot(&view().translation)).abs() < 0.002, "{support:?}");
    let contacts = contacts(&aligned);
    let rests: Vec<_> = contacts.iter().map(|contact| contact.rests_on).collect();
    let on_floor = Some(RestsOn::Support);
    assert_eq!(rests, [on_floor, on_floor, Some(RestsOn::Object(0)), None], "{contacts:?}");
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

#[wasm_bindgen_test]
fn snapping_closes_gaps_along_the_normal_only() {
    let things = things();
    let loose = align_scene(&scene_of(&things, &[], false), &mut Silent).unwrap();
    let snapped = align_scene(&scene_of(&things, &[], true), &mut Silent).unwrap();
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

#[wasm_bindgen_test]
fn an_object_that_fails_leaves_the_others() {
    let things = things();
    let mut scene = scene_of(&things[..2], &[], false);
    scene.objects[1].mask = Image::filled(WIDTH, HEIGHT, 0);
    let aligned = align_scene(&scene, &mut Silent).unwrap();
    assert!(aligned.objects[0].is_ok());
    assert_eq!(aligned.objects[1].as_ref().err().unwrap().code, ErrorCode::EmptyMask);
}

#[wasm_bindgen_test]
fn a_board_that_only_the_depth_map_shows_is_a_level() {
    let things =
        [thing([0.16, 0.1, 0.12], [-0.2, -0.05, 0.0], 0.6), thing([0.12, 0.1, 0.08], [0.15, -0.17, 0.06], -0.3)];
    let world_from_mesh = similarity(1.0, [0.0; 3], [0.15, -0.06, 0.06]);
    let boards = [Thing { mesh: cuboid(Vec3::new(0.34, 0.12, 0.26)), world_from_mesh }];
    for snap in [false, true] {
        let scene = scene_of(&things, &boards, snap);
        let aligned = align_scene(&scene, &mut Silent).unwrap();
        let contacts = contacts(&aligned);
        assert_eq!(contacts[0].rests_on, Some(RestsOn::Support), "{contacts:?}");
        assert_eq!(contacts[1].rests_on, Some(RestsOn::Level), "{contacts:?}");
        // Over the board, not over the floor, which is 12 cm below.
        let most = if snap { 1e-9 } else { 0.006 };
        assert!(contacts[1].gap_m.unwrap().abs() < most, "{contacts:?}");
    }
    // The same object at the same height over the bare floor hangs.
    let scene = scene_of(&things, &[], false);
    let aligned = align_scene(&scene, &mut Silent).unwrap();
    assert_eq!(aligned.objects[1].as_ref().unwrap().contact.rests_on, None);
}
