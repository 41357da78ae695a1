//! Bodies of a scene: what is free rests, and what cannot rest is fixed where it is.

use glam::{DQuat, DVec3, Vec3};
use sim3align_geometry::mesh::Mesh;
use sim3align_geometry::similarity::Similarity;
use sim3align_physics::apart::{ASIDE_M, INSIDE_M, depth};
use sim3align_physics::body::Pose;
use sim3align_physics::columns::Columns;
use sim3align_physics::ground::{AGREE_M, agreed_height};
use sim3align_physics::part::convex_parts;
use sim3align_physics::scene::{Object, On, Settings, Settled};
use wasm_bindgen_test::wasm_bindgen_test;

use crate::solids::{Draw, cuboid, moved, similarity, tray};

const SETTINGS: Settings =
    Settings { density: 400.0, parts: 16, turn_deg: 8.0, move_m: 0.03, fits_ground: false, rest: true };

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
        let found = columns.overlap(&moved_by(by), [0, 0]);
        assert!((found - depth).abs() < 1e-6, "moved by {by}: {found} m deep, expected {depth}");
    }
    // Steps of cells are moves.
    for (step, depth) in [([3, 0], 0.05), ([-3, 0], 0.09), ([0, 15], 0.05), ([8, 0], 0.0)] {
        let found = columns.overlap(&moved_by(DVec3::X * -0.02), step);
        assert!((found - depth).abs() < 1e-6, "by {step:?} cells: {found} m deep, expected {depth}");
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
fn bodies_that_are_a_little_inside_of_each_other_are_moved_apart() {
    let at = |x: f64| object(cube(0.1), moved(x, 0.0, 0.0), On::Ground);
    let settled = settle(&[at(0.0), at(0.096)], &SETTINGS);
    let gap = settled[1].body.pose.translation.x - settled[0].body.pose.translation.x - 0.1;
    assert!((-0.0015..0.0015).contains(&gap), "{gap} m between them");
    assert!(settled.iter().all(|body| body.inside.is_empty() && body.is_free && body.moved_m > 0.001));
    // Deeper, it is no error of a size: both stay, and say so.
    for x in [0.09, 0.05] {
        let settled = settle(&[at(0.0), at(x)], &SETTINGS);
        assert_eq!([&settled[0].inside, &settled[1].inside], [&vec![1], &vec![0]]);
        assert!(settled.iter().all(|body| body.moved_m < 1e-6 && body.is_free));
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn no_body_is_moved_far_or_in_vain() {
    let (mut parted, mut left) = (0, 0);
    for seed in 0..16 {
        let mut draw = Draw::new(700 + seed);
        let objects: Vec<Object> = (0..4)
            .map(|_| {
                let size = Vec3::new(draw.between(0.02, 0.15) as f32, draw.between(0.02, 0.15) as f32, 0.1);
                let at = DVec3::new(draw.between(-0.12, 0.12), draw.between(-0.12, 0.12), draw.between(-0.01, 0.01));
                let turn = DQuat::from_rotation_z(draw.between(0.0, 6.0));
                object(cuboid(-size / 2.0, size / 2.0), similarity(1.0, turn, at + DVec3::Z * 0.05), On::Ground)
            })
            .collect();
        let settled = settle(&objects, &SETTINGS);
        let at_rest = |i: usize| settled[i].found.translation.with_z(settled[i].body.pose.translation.z);
        let columns = |i: usize, translation: DVec3| {
            settled[i].body.columns(Pose { translation, ..settled[i].body.pose }, 0.0015)
        };
        for (i, Settled { body, found, moved_m, .. }) in settled.iter().enumerate() {
            let net = body.pose.apply(body.mass.center) - found.apply(body.mass.center);
            assert!((net.length() - moved_m).abs() < 1e-12, "seed {seed}: {moved_m} m are said for {net}");
            let aside = net.truncate().length();
            assert!(aside <= ASIDE_M + 1e-12 && *moved_m <= SETTINGS.move_m, "seed {seed}: {net}");
            let mut is_closer = false;
            for k in (0..settled.len()).filter(|k| *k != i) {
                let [before, after] = [[at_rest(i), at_rest(k)], [i, k].map(|n| settled[n].body.pose.translation)]
                    .map(|places| depth(&columns(i, places[0]), &columns(k, places[1])));
                assert!(after <= before + 1e-12, "seed {seed}: {before} m deep became {after}");
                is_closer |= after < before && after <= INSIDE_M;
            }
            assert!(aside < 1e-9 || is_closer, "seed {seed}: body {i} was moved in vain");
            parted += usize::from(aside > 1e-9);
            left += usize::from(!settled[i].inside.is_empty());
        }
    }
    assert!(parted > 4 && left > 4, "{parted} bodies were moved aside, {left} are inside of others");
}

#[wasm_bindgen_test(unsupported = test)]
fn without_rest_every_body_keeps_its_pose() {
    let lean = similarity(1.0, DQuat::from_rotation_x(0.05), DVec3::new(0.096, 0.0, 0.004));
    let objects = [object(cube(0.1), moved(0.0, 0.0, 0.0), On::Ground), object(cube(0.1), lean, On::Ground)];
    let settled = settle(&objects, &Settings { rest: false, ..SETTINGS });
    for (body, put_down) in settled.iter().zip(settle(&objects, &SETTINGS)) {
        assert_eq!(body.body.pose, body.found);
        assert_eq!([body.moved_m, body.turned_deg], [0.0; 2]);
        assert_eq!((body.is_free, body.found), (put_down.is_free, put_down.found));
        assert_ne!(put_down.body.pose, put_down.found);
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_ground_that_was_found_is_moved_to_what_most_bodies_stand_on() {
    let fitting = Settings { fits_ground: true, ..SETTINGS };
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
        assert!(body.moved_m <= AGREE_M);
    }
    // What stands on no ground is moved with it.
    assert!((lowest(&settled[4]) - 0.405).abs() < 1e-6);
    // A plane that was given, and bodies that are not moved, stay.
    for settings in [SETTINGS, Settings { rest: false, ..fitting }] {
        let (settled, height) = sim3align_physics::scene::settle(&objects, &settings);
        assert_eq!(height, 0.0);
        assert!(settled[..4].iter().all(|body| body.is_free));
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn the_ground_is_where_more_than_half_of_the_bodies_are() {
    for (lowest, reach, height) in [
        (&[][..], 1.0, None),
        (&[0.011], 0.02, Some(0.011)),
        (&[0.021], 0.02, None),
        // One of two is no majority.
        (&[-0.0136, 0.011], 0.02, None),
        (&[-0.0025, -0.0104, -0.0072], 0.02, Some(-0.0088)),
        (&[0.0, 0.0059, 0.02, -0.02], 0.02, None),
        (&[0.0, 0.0059, 0.02], 0.02, Some(0.00295)),
    ] {
        let found = agreed_height(lowest, reach);
        let is_same = found.zip(height).is_some_and(|(a, b)| (a - b).abs() < 1e-12);
        assert!(is_same || (found.is_none() && height.is_none()), "{lowest:?}: {found:?}, expected {height:?}");
    }
}
