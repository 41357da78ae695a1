//! Bodies: convex parts that contain and fill their mesh, mass and inertia next to closed forms, and poses at rest.

use glam::{DMat3, DQuat, DVec2, DVec3, Vec3};
use sim3align_geometry::symmetric_eigen::outer;
use sim3align_physics::body::{Body, Pose};
use sim3align_physics::mass::Mass;
use sim3align_physics::part::{ConvexPart, convex_parts};
use sim3align_physics::rest::levelled;
use wasm_bindgen_test::wasm_bindgen_test;

use crate::solids::{Draw, bracket, cuboid, is_near, moved, outside, similarity, tray};

/// Every edge belongs to two triangles, once in each direction; Euler's formula; and no vertex is outside.
fn assert_closed_and_convex(part: &ConvexPart, size: f64, what: &str) {
    let mut edges: Vec<(u32, u32)> = part.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
    edges.sort_unstable();
    assert!(edges.windows(2).all(|pair| pair[0] != pair[1]), "{what}: an edge is used twice");
    assert!(edges.iter().all(|&(a, b)| edges.binary_search(&(b, a)).is_ok()), "{what}: a side is open");
    assert_eq!(part.positions.len() + part.triangles.len(), edges.len() / 2 + 2, "{what}: Euler");
    assert!(part.positions.iter().all(|p| outside(part, *p) < 1e-4 * size), "{what}: a vertex is outside");
    assert!(part.volume() > 0.0, "{what}: volume {}", part.volume());
}

#[wasm_bindgen_test]
fn hulls_contain_their_points() {
    for seed in 0..40 {
        let mut draw = Draw::new(300 + seed);
        // Far from the origin, flattened, and of all sizes.
        let size = 10f64.powi((seed % 7) as i32 - 3);
        let flat = DVec3::new(1.0, 1.0, if seed % 3 == 0 { 0.02 } else { 1.0 });
        let shift = draw.vector(-3.0, 3.0);
        let count = 8 + (seed as usize * 7) % 300;
        let points: Vec<DVec3> = (0..count).map(|_| size * (shift + flat * draw.vector(-0.5, 0.5))).collect();
        let Some(hull) = ConvexPart::hull(&points) else { panic!("seed {seed}: no hull of {count} points") };
        assert_closed_and_convex(&hull, size, &format!("seed {seed}"));
        assert!(points.iter().all(|p| outside(&hull, *p) < 1e-4 * size), "seed {seed}: a point is outside");
    }
}

#[wasm_bindgen_test]
fn parts_cover_their_mesh_and_fill_no_more() {
    let (tray, tray_volume) = tray();
    assert!((0..4).all(|most| (1..=most.max(1)).contains(&convex_parts(&tray, None, most).len())), "fewer");
    for (name, mesh, volume, fewest) in [("bracket", bracket(), 0.003, 2), ("tray", tray, tray_volume, 5)] {
        let parts = convex_parts(&mesh, None, 16);
        assert!((fewest..=16).contains(&parts.len()), "{name}: {} parts", parts.len());
        for (k, part) in parts.iter().enumerate() {
            assert_closed_and_convex(part, mesh.diagonal(), &format!("{name}, part {k}"));
        }
        let found: f64 = parts.iter().map(ConvexPart::volume).sum();
        assert!(is_near(found, volume, 0.15), "{name}: {found} and {volume} m³");
        // Vertices are at most two cells of the decomposition outside of all parts.
        for p in mesh.positions() {
            let far = parts.iter().map(|part| outside(part, p.as_dvec3())).fold(f64::INFINITY, f64::min);
            assert!(far < mesh.diagonal() / 32.0, "{name}: {p} is {far} m outside of all parts");
        }
    }
}

const DENSITY: f64 = 700.0;

/// Moments of inertia in ascending order, each within a tolerance.
fn assert_moments(found: &Mass, mut expected: [f64; 3], relative: f64, what: &str) {
    expected.sort_by(f64::total_cmp);
    for (a, b) in found.moments.to_array().into_iter().zip(expected) {
        assert!(is_near(a, b, relative), "{what}: {:?} and {expected:?}", found.moments);
    }
}

#[wasm_bindgen_test]
fn boxes_have_the_mass_and_the_inertia_of_boxes() {
    for seed in 0..50 {
        let mut draw = Draw::new(seed);
        let (low, size) = (draw.vector(-0.3, 0.3).as_vec3(), draw.vector(0.02, 0.5).as_vec3());
        let mass = Mass::of(&convex_parts(&cuboid(low, low + size), None, 1), DENSITY);
        let [x, y, z] = size.as_dvec3().to_array();
        let kilograms = DENSITY * x * y * z;
        assert!(is_near(mass.mass, kilograms, 1e-5), "seed {seed}: {} and {kilograms} kg", mass.mass);
        let center = (low + 0.5 * size).as_dvec3();
        assert!((mass.center - center).length() < 1e-6, "seed {seed}: {} and {center}", mass.center);
        let moment = |a: f64, b: f64| kilograms * (a * a + b * b) / 12.0;
        assert_moments(&mass, [moment(y, z), moment(x, z), moment(x, y)], 1e-4, &format!("seed {seed}"));
    }
}

#[wasm_bindgen_test]
fn parts_add_up_by_the_parallel_axis_theorem() {
    let body = Body::new(&bracket(), &moved(0.0, 0.0, 0.0), 16, DENSITY);
    let boxes = [[0.2, 0.1, 0.1, 0.1, 0.05, 0.05], [0.1, 0.1, 0.1, 0.05, 0.05, 0.15]];
    let (mut kilograms, mut first, mut about) = (0.0, DVec3::ZERO, DMat3::ZERO);
    for [x, y, z, a, b, c] in boxes {
        let (m, center) = (DENSITY * x * y * z, DVec3::new(a, b, c));
        let own = DVec3::new(y * y + z * z, x * x + z * z, x * x + y * y) * (m / 12.0);
        kilograms += m;
        first += m * center;
        about += DMat3::from_diagonal(own) + (DMat3::IDENTITY * center.length_squared() - outer(center)) * m;
    }
    let center = first / kilograms;
    let expected = about - (DMat3::IDENTITY * center.length_squared() - outer(center)) * kilograms;
    // The decomposition works on cells of a 64th of the size.
    assert!(is_near(body.mass.mass, kilograms, 0.05), "{} and {kilograms} kg", body.mass.mass);
    assert!((body.mass.center - center).length() < 0.004, "{} and {center}", body.mass.center);
    let axes = DMat3::from_quat(body.mass.axes);
    let found = axes * DMat3::from_diagonal(body.mass.moments) * axes.transpose();
    let size = expected.to_cols_array().into_iter().fold(0.0f64, |a, b| a.max(b.abs()));
    for (a, b) in found.to_cols_array().into_iter().zip(expected.to_cols_array()) {
        assert!((a - b).abs() < 0.1 * size, "{found} and {expected}");
    }
}

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

#[wasm_bindgen_test]
fn whatever_its_pose_a_body_rolls_until_its_centre_is_over_what_it_stands_on() {
    let plank = cuboid(Vec3::ZERO, Vec3::new(0.05, 0.1, 0.4));
    for (name, mesh) in [("plank", plank), ("bracket", bracket())] {
        let body = Body::new(&mesh, &moved(0.0, 0.0, 0.0), 8, 400.0);
        for seed in 0..30 {
            let mut draw = Draw::new(400 + seed);
            let pose = Pose { rotation: draw.rotation(), translation: draw.vector(-1.0, 1.0) };
            assert_at_rest(&Body { pose, ..body.clone() }, &format!("{name}, seed {seed}"));
        }
    }
}

#[wasm_bindgen_test]
fn a_box_that_leans_turns_to_its_nearest_side() {
    let mesh = cuboid(Vec3::ZERO, Vec3::new(0.1, 0.1, 0.2));
    for (lean_deg, turn_deg) in [(3.0f64, 3.0f64), (30.0, 30.0), (44.0, 44.0), (46.0, 44.0), (60.0, 30.0)] {
        let lean = DQuat::from_rotation_y(lean_deg.to_radians());
        let body = Body::new(&mesh, &similarity(1.0, lean, DVec3::new(0.3, 0.2, 0.5)), 1, 400.0);
        let (_, angle) = levelled(&body).unwrap();
        assert!((angle.to_degrees() - turn_deg).abs() < 1e-3, "{lean_deg}°: turned by {}°", angle.to_degrees());
    }
}
