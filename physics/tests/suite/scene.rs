//! Bodies of a scene: what is free rests, and what cannot rest is fixed where it is.

use glam::{DQuat, DVec3, Vec3};
use sim3align_geometry::mesh::Mesh;
use sim3align_geometry::similarity::Similarity;
use sim3align_physics::columns::Columns;
use sim3align_physics::part::convex_parts;
use sim3align_physics::scene::{Object, On, Settings, Settled, settle};
use wasm_bindgen_test::wasm_bindgen_test;

use crate::solids::{Draw, cuboid, moved, similarity, tray};

const SETTINGS: Settings = Settings { density: 400.0, parts: 16, turn_deg: 8.0, move_m: 0.03 };

fn object(mesh: Mesh, world_from_mesh: Similarity, on: On) -> Object {
    Object { mesh, world_from_mesh, on }
}

fn cube(side: f32) -> Mesh {
    cuboid(Vec3::ZERO, Vec3::splat(side))
}

fn lowest(settled: &Settled) -> f64 {
    settled.body.points(settled.body.pose).map(|p| p.z).fold(f64::INFINITY, f64::min)
}

#[wasm_bindgen_test(unsupported = test)]
fn columns_are_the_extent_of_a_box_over_its_cells() {
    let [part] = convex_parts(&cuboid(Vec3::new(0.0, 0.0, 0.1), Vec3::new(0.1, 0.2, 0.4)), 1).try_into().unwrap();
    let columns = Columns::of(&part, 0.01);
    let cells: Vec<_> = columns.cells().collect();
    assert_eq!(cells.len(), 10 * 20);
    for (at, [low, high]) in cells {
        assert!((low - 0.1).abs() < 1e-6 && (high - 0.4).abs() < 1e-6, "{at:?}: {low} to {high}");
        assert_eq!(columns.at(at), Some([low, high]));
    }
    assert_eq!(columns.at([-1, 0]), None);
    assert_eq!(columns.at([10, 0]), None);
    // A copy that is moved by 3 cm along x shares 7 cm of 10: the least side of what both share is that.
    let moved_by = |by: DVec3| Columns::of(&part.mapped(|p| p + by), 0.01);
    for (by, depth) in [(DVec3::X * 0.03, 0.07), (DVec3::Z * 0.26, 0.04), (DVec3::Z * 0.31, 0.0), (DVec3::X, 0.0)] {
        let found = columns.overlap(&moved_by(by));
        assert!((found - depth).abs() < 1e-6, "moved by {by}: {found} m deep, expected {depth}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn bodies_on_the_ground_are_free_and_stand_on_it() {
    for seed in 0..30 {
        let mut draw = Draw::new(600 + seed);
        let lean = DQuat::from_rotation_x(draw.between(-0.1, 0.1)) * DQuat::from_rotation_y(draw.between(-0.05, 0.05));
        let turn = DQuat::from_rotation_z(draw.between(0.0, 6.0));
        let at = DVec3::new(draw.between(-1.0, 1.0), draw.between(-1.0, 1.0), draw.between(-0.004, 0.004));
        let pose = similarity(draw.between(0.5, 1.0), lean * turn, at);
        let [settled] = settle(&[object(cube(0.1), pose, On::Ground)], &SETTINGS).try_into().unwrap();
        assert!(settled.is_free, "seed {seed}: moved {} m, {}°", settled.moved_m, settled.turned_deg);
        assert!(lowest(&settled).abs() < 1e-9, "seed {seed}: {}", lowest(&settled));
        let up = settled.body.pose.rotation * DVec3::Z;
        assert!(up.z > 1.0 - 1e-9, "seed {seed}: its side is {up}");
        assert!(settled.moved_m <= SETTINGS.move_m && settled.turned_deg <= SETTINGS.turn_deg, "seed {seed}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
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
        assert_eq!([settled.moved_m, settled.turned_deg], [0.0; 2], "{what}");
        let given = DVec3::from_slice(pose.translation.as_slice());
        assert_eq!(settled.body.pose.translation, given, "{what}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
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

#[wasm_bindgen_test(unsupported = test)]
fn a_body_stands_in_a_tray_and_not_on_its_hull() {
    let (tray, _) = tray();
    let objects =
        [object(tray, moved(0.0, 0.0, 0.0), On::Ground), object(cube(0.06), moved(0.07, 0.07, 0.021), On::Object(0))];
    let settled = settle(&objects, &SETTINGS);
    assert!(settled.iter().all(|body| body.is_free));
    // The floor of the tray is 2 cm thick, within a cell of the decomposition.
    assert!((lowest(&settled[1]) - 0.02).abs() < 0.006, "{}", lowest(&settled[1]));
}

#[wasm_bindgen_test(unsupported = test)]
fn a_body_that_would_tip_over_an_edge_is_fixed() {
    let table = || object(cuboid(Vec3::ZERO, Vec3::new(0.4, 0.4, 0.1)), moved(0.0, 0.0, 0.0), On::Ground);
    // Its centre is 5 cm from its side: beyond x = 0.35, it is not over the table.
    for (x, is_free) in [(0.1, true), (0.33, true), (0.36, false), (0.39, false)] {
        let top = object(cube(0.1), moved(x, 0.1, 0.102), On::Object(0));
        let settled = settle(&[table(), top], &SETTINGS);
        assert_eq!(settled[1].is_free, is_free, "at x = {x}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn bodies_that_are_partly_inside_of_each_other_are_moved_apart() {
    let at = |x: f64| object(cube(0.1), moved(x, 0.0, 0.0), On::Ground);
    let settled = settle(&[at(0.0), at(0.09)], &SETTINGS);
    let gap = settled[1].body.pose.translation.x - settled[0].body.pose.translation.x - 0.1;
    assert!((0.0..0.01).contains(&gap), "{gap} m between them");
    assert!(settled.iter().all(|body| body.inside.is_empty() && body.is_free && body.moved_m > 0.004));
    // One in the other by half is no error of a size: both stay, and say so.
    let settled = settle(&[at(0.0), at(0.05)], &SETTINGS);
    assert_eq!([&settled[0].inside, &settled[1].inside], [&vec![1], &vec![0]]);
}
