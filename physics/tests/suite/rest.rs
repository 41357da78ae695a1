//! Poses at rest: the centre of mass is over what the body stands on.

use glam::{DQuat, DVec2, DVec3, Vec3};
use sim3align_geometry::mesh::Mesh;
use sim3align_physics::body::{Body, Pose};
use sim3align_physics::part::{ConvexPart, convex_parts};
use sim3align_physics::rest::levelled;
use wasm_bindgen_test::wasm_bindgen_test;

use crate::solids::{Draw, bracket, cuboid, cylinder, moved, similarity};

/// How far the centre of mass is inside of the support polygon, metres, in the direction in which it is the least: the
/// points up to `height` above the ground are what the body stands on. No polygon is made: the least over directions of the
/// farthest point.
fn margin(body: &Body, pose: Pose, height: f64) -> f64 {
    let center = pose.apply(body.mass.center);
    let stands: Vec<DVec2> =
        body.points(pose).filter(|p| p.z <= height).map(|p| p.truncate() - center.truncate()).collect();
    let farthest = |k: u32| {
        let (sine, cosine) = libm::sincos(core::f64::consts::TAU * f64::from(k) / 720.0);
        stands.iter().map(|p| p.x * cosine + p.y * sine).fold(f64::NEG_INFINITY, f64::max)
    };
    (0..720).map(farthest).fold(f64::INFINITY, f64::min)
}

fn assert_at_rest(body: &Body, what: &str) {
    let (pose, angle) = levelled(body).unwrap();
    let size = body.points(pose).map(|p| (p - pose.translation).length()).fold(0.0, f64::max);
    let lowest = body.points(pose).map(|p| p.z).fold(f64::INFINITY, f64::min);
    assert!(lowest.abs() < 1e-9, "{what}: its lowest point is at {lowest} m");
    let [from, to] = [body.pose, pose].map(|pose| pose.apply(body.mass.center).truncate());
    assert!((from - to).length() < 1e-9, "{what}: its centre moved from {from} to {to}");
    assert!(pose.rotation.is_normalized(), "{what}: {}", pose.rotation);
    let turned = body.pose.rotation.angle_between(pose.rotation);
    assert!((turned - angle).abs() < 1e-6, "{what}: turned by {turned}, said to be {angle}");
    let margin = margin(body, pose, 1e-4 * size);
    assert!(margin > -1e-4 * size, "{what}: its centre is {} m beyond what it stands on", -margin);
    // Once at rest, it stays.
    let again = levelled(&Body { pose, ..body.clone() }).unwrap();
    assert!(again.1 < 1e-3, "{what}: it turns again, by {} rad", again.1);
}

fn solids() -> [(&'static str, Mesh); 3] {
    let plank = cuboid(Vec3::ZERO, Vec3::new(0.05, 0.1, 0.4));
    [("plank", plank), ("can", cylinder(0.04, 0.12, 24)), ("bracket", bracket())]
}

#[wasm_bindgen_test(unsupported = test)]
fn whatever_its_pose_a_body_rolls_until_its_centre_is_over_what_it_stands_on() {
    for (name, mesh) in solids() {
        let body = Body::new(&mesh, &moved(0.0, 0.0, 0.0), 8, 400.0);
        for seed in 0..100 {
            let mut draw = Draw::new(400 + seed);
            let pose = Pose { rotation: draw.rotation(), translation: draw.vector(-1.0, 1.0) };
            assert_at_rest(&Body { pose, ..body.clone() }, &format!("{name}, seed {seed}"));
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn hulls_of_random_points_come_to_rest() {
    for seed in 0..100 {
        let mut draw = Draw::new(500 + seed);
        let points: Vec<Vec3> = (0..30).map(|_| draw.vector(-0.1, 0.1).as_vec3()).collect();
        let triangles = (0..10).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        let mesh = Mesh::new(points, triangles).unwrap();
        let pose = similarity(draw.between(0.2, 4.0), draw.rotation(), draw.vector(-1.0, 1.0));
        assert_at_rest(&Body::new(&mesh, &pose, 1, 400.0), &format!("seed {seed}"));
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_box_that_leans_turns_to_its_nearest_side() {
    let mesh = cuboid(Vec3::ZERO, Vec3::new(0.1, 0.1, 0.2));
    for (lean_deg, turn_deg) in [(3.0f64, 3.0f64), (30.0, 30.0), (44.0, 44.0), (46.0, 44.0), (60.0, 30.0)] {
        let lean = DQuat::from_rotation_y(lean_deg.to_radians());
        let body = Body::new(&mesh, &similarity(1.0, lean, DVec3::new(0.3, 0.2, 0.5)), 1, 400.0);
        let (_, angle) = levelled(&body).unwrap();
        assert!((angle.to_degrees() - turn_deg).abs() < 1e-3, "{lean_deg}°: turned by {}°", angle.to_degrees());
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_prism_whose_centre_is_beyond_its_base_falls_to_the_side() {
    let cube = cuboid(Vec3::ZERO, Vec3::new(0.1, 0.1, 0.2));
    for (shear, turn_deg) in [
        // Its centre is over its base, 1 cm from the edge.
        (0.4f32, 0.0f64),
        // 1 cm and more beyond the edge; the side that it falls on leans by atan(1 / shear).
        (0.6, 59.036),
        (1.5, 33.690),
    ] {
        let positions = cube.positions().iter().map(|p| *p + Vec3::X * shear * p.z).collect();
        let mesh = Mesh::new(positions, cube.triangles().to_vec()).unwrap();
        let body = Body::new(&mesh, &moved(0.0, 0.0, 0.0), 1, 400.0);
        let (_, angle) = levelled(&body).unwrap();
        assert!((angle.to_degrees() - turn_deg).abs() < 1e-3, "{shear}: turned by {}°", angle.to_degrees());
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn without_parts_there_is_no_pose() {
    let mesh = Mesh::new(vec![Vec3::ONE; 3], vec![[0, 1, 2]]).unwrap();
    let body = Body::new(&mesh, &moved(0.0, 0.0, 0.0), 4, 400.0);
    assert!(convex_parts(&mesh, 4).is_empty() && body.parts.is_empty());
    assert!(levelled(&body).is_none());
    assert!(ConvexPart::hull(&[]).is_none());
}
