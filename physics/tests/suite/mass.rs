//! Mass, centre and inertia, next to closed forms.

use glam::{DMat3, DQuat, DVec3, Vec3};
use sim3align_geometry::mesh::Mesh;
use sim3align_geometry::symmetric_eigen::outer;
use sim3align_physics::body::Body;
use sim3align_physics::mass::Mass;
use sim3align_physics::part::{ConvexPart, convex_parts};
use wasm_bindgen_test::wasm_bindgen_test;

use crate::solids::{Draw, bracket, cuboid, cylinder, is_near, moved, similarity, sphere};

const DENSITY: f64 = 700.0;

fn mass_of(mesh: &Mesh) -> Mass {
    Mass::of(&convex_parts(mesh, 1), DENSITY)
}

/// Moments of inertia in ascending order, each within a tolerance.
fn assert_moments(found: &Mass, mut expected: [f64; 3], relative: f64, what: &str) {
    expected.sort_by(f64::total_cmp);
    for (a, b) in found.moments.to_array().into_iter().zip(expected) {
        assert!(is_near(a, b, relative), "{what}: {:?} and {expected:?}", found.moments);
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn boxes_have_the_mass_and_the_inertia_of_boxes() {
    for seed in 0..50 {
        let mut draw = Draw::new(seed);
        let (low, size) = (draw.vector(-0.3, 0.3).as_vec3(), draw.vector(0.02, 0.5).as_vec3());
        let mass = mass_of(&cuboid(low, low + size));
        let [x, y, z] = size.as_dvec3().to_array();
        let kilograms = DENSITY * x * y * z;
        assert!(is_near(mass.mass, kilograms, 1e-5), "seed {seed}: {} and {kilograms} kg", mass.mass);
        let center = (low + 0.5 * size).as_dvec3();
        assert!((mass.center - center).length() < 1e-6, "seed {seed}: {} and {center}", mass.center);
        let moment = |a: f64, b: f64| kilograms * (a * a + b * b) / 12.0;
        assert_moments(&mass, [moment(y, z), moment(x, z), moment(x, y)], 1e-4, &format!("seed {seed}"));
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn spheres_and_cylinders_come_near_to_their_closed_forms() {
    let (radius, height) = (0.07f64, 0.2f64);
    let pi = core::f64::consts::PI;
    let ball = mass_of(&sphere(radius, 40));
    let kilograms = DENSITY * 4.0 / 3.0 * pi * radius.powi(3);
    // Facets are inside of what they approximate.
    assert!(is_near(ball.mass, kilograms, 0.005) && ball.mass < kilograms, "{} and {kilograms} kg", ball.mass);
    assert!(ball.center.length() < 1e-6, "{}", ball.center);
    assert_moments(&ball, [0.4 * kilograms * radius * radius; 3], 0.01, "sphere");

    let can = mass_of(&cylinder(radius, height, 96));
    let kilograms = DENSITY * pi * radius * radius * height;
    assert!(is_near(can.mass, kilograms, 0.002) && can.mass < kilograms, "{} and {kilograms} kg", can.mass);
    assert!((can.center - DVec3::Z * 0.5 * height).length() < 1e-6, "{}", can.center);
    let [along, across] = [0.5 * radius * radius, (3.0 * radius * radius + height * height) / 12.0];
    assert_moments(&can, [along * kilograms, across * kilograms, across * kilograms], 0.005, "cylinder");
    // The least moment is that about the axis of the cylinder.
    assert!((can.axes * DVec3::X).z.abs() > 0.999_99, "{}", can.axes * DVec3::X);
}

#[wasm_bindgen_test(unsupported = test)]
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

#[wasm_bindgen_test(unsupported = test)]
fn mass_grows_with_the_cube_of_the_scale_and_does_not_depend_on_the_pose() {
    for seed in 0..20 {
        let mut draw = Draw::new(100 + seed);
        let mesh = cuboid(Vec3::ZERO, draw.vector(0.1, 1.0).as_vec3());
        let scale = draw.between(0.05, 3.0);
        let pose = similarity(scale, draw.rotation(), draw.vector(-2.0, 2.0));
        let [one, scaled] = [moved(0.0, 0.0, 0.0), pose].map(|pose| Body::new(&mesh, &pose, 1, DENSITY).mass);
        assert!(is_near(scaled.mass, one.mass * scale.powi(3), 1e-9), "seed {seed}: {scaled:?} and {one:?}");
        assert!((scaled.center - scale * one.center).length() < 1e-9 * scale, "seed {seed}: {scaled:?} and {one:?}");
        let moments = one.moments * scale.powi(5);
        assert_moments(&scaled, moments.to_array(), 1e-9, &format!("seed {seed}"));
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn the_inertia_turns_with_the_parts() {
    for seed in 0..20 {
        let mut draw = Draw::new(200 + seed);
        let parts = convex_parts(&cuboid(Vec3::ZERO, Vec3::new(0.1, 0.2, 0.4)), 1);
        let (turn, shift) = (draw.rotation(), draw.vector(-1.0, 1.0));
        let turned: Vec<ConvexPart> = parts.iter().map(|part| part.mapped(|p| turn * p + shift)).collect();
        let [a, b] = [&parts, &turned].map(|parts| Mass::of(parts, DENSITY));
        assert!((turn * a.center + shift - b.center).length() < 1e-7, "seed {seed}: {a:?} and {b:?}");
        let tensor = |mass: &Mass, turn: DQuat| {
            let axes = DMat3::from_quat(turn * mass.axes);
            axes * DMat3::from_diagonal(mass.moments) * axes.transpose()
        };
        let difference = tensor(&a, turn) - tensor(&b, DQuat::IDENTITY);
        let error = difference.to_cols_array().into_iter().fold(0.0f64, |a, b| a.max(b.abs()));
        assert!(error < 1e-6 * a.moments.max_element(), "seed {seed}: {a:?} and {b:?}");
    }
}
