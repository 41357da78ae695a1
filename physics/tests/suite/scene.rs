//! Bodies of a scene: what is free rests, what cannot rest is fixed where it is, and meshes that are no solids.

use glam::{DQuat, DVec3, Vec3};
use sim3align_geometry::mesh::Mesh;
use sim3align_geometry::similarity::Similarity;
use sim3align_physics::ground::AGREE_M;
use sim3align_physics::scene::{Motion, Object, On, Settings, Settled};
use wasm_bindgen_test::wasm_bindgen_test;

use crate::solids::{Draw, cuboid, moved, similarity};

const SETTINGS: Settings =
    Settings { density: 400.0, parts: 1, turn_deg: 8.0, move_m: 0.03, fits_ground: false, rest: true };

fn settle(objects: &[Object], settings: &Settings) -> Vec<Settled> {
    sim3align_physics::scene::settle(objects, settings).0
}

fn object(mesh: Mesh, world_from_mesh: Similarity, on: On) -> Object {
    Object { mesh, world_from_mesh, on }
}

fn cube(side: f32) -> Mesh {
    cuboid(Vec3::ZERO, Vec3::splat(side))
}

fn lowest(settled: &Settled) -> f64 {
    settled.body.points(settled.body.pose).map(|p| p.z).fold(f64::INFINITY, f64::min)
}

#[wasm_bindgen_test]
fn bodies_on_the_ground_are_free_and_stand_on_it() {
    for seed in 0..30 {
        let mut draw = Draw::new(600 + seed);
        let lean = DQuat::from_rotation_x(draw.between(-0.1, 0.1)) * DQuat::from_rotation_y(draw.between(-0.05, 0.05));
        let turn = DQuat::from_rotation_z(draw.between(0.0, 6.0));
        let at = DVec3::new(draw.between(-1.0, 1.0), draw.between(-1.0, 1.0), draw.between(-0.004, 0.004));
        let pose = similarity(draw.between(0.5, 1.0), lean * turn, at);
        let [settled] = settle(&[object(cube(0.1), pose, On::Ground)], &SETTINGS).try_into().unwrap();
        assert!(settled.is_free, "seed {seed}: moved {} m, {}°", settled.motion.move_m, settled.motion.turn_deg);
        assert!(lowest(&settled).abs() < 1e-9, "seed {seed}: {}", lowest(&settled));
        let up = settled.body.pose.rotation * DVec3::Z;
        assert!(up.z > 1.0 - 1e-9, "seed {seed}: its side is {up}");
        assert_eq!((settled.rest, settled.cut_m), (Some(settled.motion), 0.0), "seed {seed}");
        let corners = || settled.body.points(settled.body.pose).zip(settled.body.points(settled.found));
        let farthest = corners().map(|(to, from)| (to - from).length()).fold(0.0, f64::max);
        assert!((settled.motion.move_m - farthest).abs() < 1e-12 && farthest <= SETTINGS.move_m, "seed {seed}");
        assert!(settled.motion.turn_deg <= SETTINGS.turn_deg, "seed {seed}");
    }
}

#[wasm_bindgen_test]
fn what_would_move_too_far_or_rests_on_nothing_is_fixed_where_it_is() {
    let tilted = similarity(1.0, DQuat::from_rotation_x(0.3), DVec3::ZERO);
    for (what, pose, on) in [
        ("it leans by 17°", tilted, On::Ground),
        ("it floats 20 cm above the ground", moved(0.0, 0.0, 0.2), On::Ground),
        ("it hangs", moved(0.0, 0.0, 0.2), On::Nothing),
        ("it stands on itself", moved(0.0, 0.0, 0.0), On::Object(0)),
        ("it stands on no object", moved(0.0, 0.0, 0.0), On::Object(7)),
    ] {
        let [settled] = settle(&[object(cube(0.1), pose, on)], &SETTINGS).try_into().unwrap();
        assert!(!settled.is_free, "{what}");
        assert_eq!(settled.motion, Motion { move_m: 0.0, turn_deg: 0.0 }, "{what}");
        let given = DVec3::from_slice(pose.translation.as_slice());
        assert_eq!(settled.body.pose.translation, given, "{what}");
    }
}

/// A block whose underside is not level, at the height of its middle: rest would turn it by the same angle.
fn on_a_slope(slope_deg: f64, on: On) -> Object {
    let rise = (0.1 * slope_deg.to_radians().tan()) as f32;
    let block = cuboid(Vec3::ZERO, Vec3::splat(0.1));
    let sloping = |p: &Vec3| if p.z == 0.0 { *p + Vec3::Z * (rise * p.x / 0.1) } else { *p };
    let mesh = Mesh::new(block.positions().iter().map(sloping).collect(), block.triangles().to_vec()).unwrap();
    object(mesh, moved(0.0, 0.0, -f64::from(rise) / 2.0), on)
}

#[wasm_bindgen_test]
fn a_body_that_rest_would_turn_too_far_keeps_its_rotation_and_is_cut_level() {
    let bounds = Settings { turn_deg: 1.0, move_m: 3e-3, ..SETTINGS };
    let table = || object(cuboid(Vec3::ZERO, Vec3::new(0.2, 0.2, 0.1)), moved(-0.05, -0.05, -0.1), On::Nothing);
    for on in [On::Ground, On::Object(0)] {
        let [_, settled] = settle(&[table(), on_a_slope(3.0, on)], &bounds).try_into().unwrap();
        assert!(settled.is_free && settled.motion.turn_deg == 0.0 && settled.motion.move_m < 1e-3, "{settled:?}");
        assert!((settled.rest.unwrap().turn_deg - 3.0).abs() < 0.1, "{:?}", settled.rest);
        assert_eq!(settled.body.pose.rotation, settled.found.rotation);
        // What it stands on reaches beyond its centre of mass, and nothing of it is below.
        let ([x, _, _], low) = (settled.body.mass.center.to_array(), lowest(&settled));
        let level = || settled.body.points(settled.body.pose).filter(|p| p.z < 1e-6);
        assert!(low.abs() < 1e-6 && level().any(|p| p.x > x) && level().any(|p| p.x < x), "{on:?}: {low} m");
        assert!(settled.cut_m > 2.5e-3 && settled.cut_m <= 4e-3, "{on:?}: {} m", settled.cut_m);
        // More is cut off no body: it is fixed where it was found.
        let [_, settled] = settle(&[table(), on_a_slope(8.0, on)], &bounds).try_into().unwrap();
        assert!(!settled.is_free && settled.body.pose == settled.found && settled.cut_m == 0.0, "{on:?}");
        assert!((settled.rest.unwrap().turn_deg - 8.0).abs() < 0.1, "{:?}", settled.rest);
    }
}

#[wasm_bindgen_test]
fn a_stack_is_put_down_from_below_in_any_order() {
    let on = [On::Object(2), On::Ground, On::Object(1)];
    let floats = [0.21, 0.004, 0.108];
    let objects: Vec<Object> =
        on.into_iter().zip(floats).map(|(on, z)| object(cube(0.1), moved(0.0, 0.0, z), on)).collect();
    let settled = settle(&objects, &SETTINGS);
    for (body, z) in settled.iter().zip([0.2, 0.0, 0.1]) {
        assert!(body.is_free && (lowest(body) - z).abs() < 1e-6, "at {}, expected {z}", lowest(body));
        assert!(body.inside.is_empty(), "{:?}", body.inside);
    }
}

#[wasm_bindgen_test]
fn what_has_sunk_below_what_carries_it_is_put_on_it() {
    let mat = object(cuboid(Vec3::ZERO, Vec3::new(0.3, 0.3, 0.003)), moved(0.0, 0.0, 0.003), On::Ground);
    let objects = [object(cube(0.1), moved(0.1, 0.1, 0.002), On::Object(1)), mat];
    for (body, z) in settle(&objects, &SETTINGS).iter().zip([0.003, 0.0]) {
        assert!(body.is_free && (lowest(body) - z).abs() < 1e-6, "at {}, expected {z}", lowest(body));
    }
}

#[wasm_bindgen_test]
fn a_body_that_would_tip_over_an_edge_is_fixed() {
    let table = || object(cuboid(Vec3::ZERO, Vec3::new(0.4, 0.4, 0.1)), moved(0.0, 0.0, 0.0), On::Ground);
    // Its centre is 5 cm from its side: beyond x = 0.35, it is not over the table.
    for (x, is_free) in [(0.1, true), (0.33, true), (0.36, false), (0.39, false)] {
        let top = object(cube(0.1), moved(x, 0.1, 0.102), On::Object(0));
        let settled = settle(&[table(), top], &SETTINGS);
        assert_eq!(settled[1].is_free, is_free, "at x = {x}");
    }
}

/// A spike that stands on its tip and would come to lie, at an angle to the axes: it covers no more cells than other bodies.
#[wasm_bindgen_test]
fn what_is_tall_and_tips_over_needs_no_more_room() {
    let ends = cuboid(Vec3::ZERO, Vec3::new(0.5, 0.4, 400.0));
    let tipped = |p: &Vec3| if p.z == 0.0 { Vec3::new(0.25, 0.2, 0.0) } else { *p };
    let spike = Mesh::new(ends.positions().iter().map(tipped).collect(), ends.triangles().to_vec()).unwrap();
    let turned = similarity(1.0, DQuat::from_rotation_z(0.7), DVec3::Z);
    let objects = [object(cube(1.0), moved(0.0, 0.0, 0.0), On::Ground), object(spike, turned, On::Object(0))];
    assert!(!settle(&objects, &SETTINGS)[1].is_free);
}

#[wasm_bindgen_test]
fn bodies_that_are_a_little_inside_of_each_other_are_moved_apart() {
    let at = |x: f64| object(cube(0.1), moved(x, 0.0, 0.0), On::Ground);
    let settled = settle(&[at(0.0), at(0.096)], &SETTINGS);
    let gap = settled[1].body.pose.translation.x - settled[0].body.pose.translation.x - 0.1;
    assert!((-0.0015..0.0015).contains(&gap), "{gap} m between them");
    assert!(settled.iter().all(|body| body.inside.is_empty() && body.is_free && body.motion.move_m > 0.001));
    // Deeper, it is no error of a size: both stay, and say so.
    for x in [0.09, 0.05] {
        let settled = settle(&[at(0.0), at(x)], &SETTINGS);
        assert_eq!([&settled[0].inside, &settled[1].inside], [&vec![1], &vec![0]]);
        assert!(settled.iter().all(|body| body.motion.move_m < 1e-6 && body.is_free));
    }
}

#[wasm_bindgen_test]
fn a_ground_that_was_found_is_moved_to_what_most_bodies_stand_on() {
    let fitting = Settings { fits_ground: true, move_m: AGREE_M, ..SETTINGS };
    let at = |x: f64, z: f64| object(cube(0.1), moved(x, 0.0, z), On::Ground);
    let heights = [-0.006, -0.004, -0.005, 0.007];
    let mut objects: Vec<Object> = heights.iter().zip([0.0, 0.3, 0.6, 0.9]).map(|(z, x)| at(x, *z)).collect();
    objects.push(object(cube(0.1), moved(0.0, 0.5, 0.4), On::Nothing));
    let (settled, height) = sim3align_physics::scene::settle(&objects, &fitting);
    assert!((height - 0.005).abs() < 1e-6, "the ground is {height} m below the plane");
    for (body, z) in settled.iter().zip(heights) {
        let disagrees = (z + height).abs() > AGREE_M;
        assert_eq!(body.is_free, !disagrees, "at {z}");
        assert!((body.found.translation.z - (z + height)).abs() < 1e-12);
        assert!((lowest(body) - if disagrees { z + height } else { 0.0 }).abs() < 1e-6, "at {z}: {}", lowest(body));
        assert!(body.motion.move_m <= AGREE_M);
    }
    // What stands on no ground is moved with it.
    assert!((lowest(&settled[4]) - 0.405).abs() < 1e-6);
    // A plane that was given, and bodies that are not moved, stay.
    for settings in [SETTINGS, Settings { fits_ground: true, rest: false, ..SETTINGS }] {
        let (settled, height) = sim3align_physics::scene::settle(&objects, &settings);
        assert_eq!(height, 0.0);
        assert!(settled[..4].iter().all(|body| body.is_free));
    }
}

/// Settles one object of parts; all of its numbers are finite. Returns the number of its parts and its mass.
fn settled(mesh: &Mesh, scale: f64, what: &str) -> (usize, f64) {
    let pose = similarity(scale, DQuat::from_rotation_x(0.02), DVec3::new(0.1, 0.2, 0.3));
    let found = &settle(&[object(mesh.clone(), pose, On::Ground)], &Settings { parts: 4, ..SETTINGS })[0];
    let (body, mass) = (&found.body, found.body.mass);
    let corners = body.parts.iter().flat_map(|part| &part.positions);
    let vectors = [mass.center, mass.moments, body.pose.translation];
    assert!(corners.copied().chain(vectors).all(DVec3::is_finite), "{what}: {mass:?}");
    assert!(mass.mass.is_finite() && mass.mass >= 0.0 && mass.moments.min_element() > 0.0, "{what}: {mass:?}");
    assert!(body.parts.iter().all(|part| part.volume() > 0.0), "{what}: a part without volume");
    (body.parts.len(), mass.mass)
}

#[wasm_bindgen_test]
fn meshes_that_are_no_solids_have_finite_bodies() {
    let flat = |corners: [Vec3; 3]| Mesh::new(corners.to_vec(), vec![[0, 1, 2]]).unwrap();
    // About a thousandth of the diagonal to each side.
    for corners in [[Vec3::ZERO, Vec3::X, Vec3::Y], [Vec3::ZERO, Vec3::X, 2.0 * Vec3::X]] {
        let (count, mass) = settled(&flat(corners), 0.1, "flat");
        assert!(count == 1 && mass > 0.0 && mass < 2.1e-3, "{corners:?}: {mass} kg");
    }
    assert_eq!(settled(&flat([Vec3::splat(0.3); 3]), 1.0, "point"), (0, 0.0));
    for thickness in [0.1, 0.001] {
        let (count, mass) = settled(&cuboid(Vec3::ZERO, Vec3::new(1.0, 0.7, thickness)), 0.1, "plate");
        assert!(count == 1 && (mass / f64::from(0.28 * thickness) - 1.0).abs() < 1e-5, "{thickness}: {mass} kg");
    }
    for exponent in [-12, 9] {
        let size = 10f32.powi(exponent);
        let (count, mass) = settled(&cuboid(-Vec3::splat(size), Vec3::splat(size)), 0.1 / f64::from(size), "decades");
        assert!(count == 1 && (mass - 3.2).abs() < 1e-3, "1e{exponent}: {mass} kg");
    }
    for size in [1e30f32, f32::MAX] {
        let huge = object(cuboid(-Vec3::splat(size), Vec3::splat(size)), moved(0.0, 0.0, 0.0), On::Ground);
        assert!(settle(&[huge], &SETTINGS)[0].body.parts.len() <= 1, "{size}");
    }
    for seed in 0..3 {
        let mut draw = Draw::new(700 + seed);
        let count = 3 + 9 * seed as usize;
        // Coordinates of few values: coincident, collinear and coplanar vertices, triangles without area.
        let positions: Vec<Vec3> = (0..count).map(|_| draw.vector(0.0, 3.99).floor().as_vec3()).collect();
        let triangles = (0..2 * count as u32).map(|k| [0, 5, 11].map(|step| (k * 7 + step) % count as u32)).collect();
        settled(&Mesh::new(positions, triangles).unwrap(), 0.05, &format!("seed {seed}"));
    }
}
