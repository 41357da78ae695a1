//! Contact: the attitudes of meshes, the credit of a contact and its quadratic, and volumes.

use core::f64::consts::PI;
use std::rc::Rc;

use glam::{DQuat, DVec2, DVec3, Vec3};
use sim3align::geometry::normal_equations::NormalEquations;
use sim3align::geometry::pinhole::Pinhole;
use sim3align::geometry::random::Random;
use sim3align::geometry::similarity::Similarity;
use sim3align::precise::drawn::pose::{CropPose, Step};
use sim3align::precise::drawn::rests::{Rest, rests};
use sim3align::precise::scored::surroundings::{Ground, Surroundings};
use sim3align::scene::layers::{layer, volumes};
use wasm_bindgen_test::wasm_bindgen_test;

use super::precise_refine::unpacked;
use super::shapes::{cuboid, mapped, sphere};

#[wasm_bindgen_test(unsupported = test)]
fn a_box_stands_on_its_six_sides_and_a_ball_on_none() {
    let size = Vec3::new(0.3, 0.5, 0.8);
    let found = rests(&cuboid(size));
    let axes = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z];
    for axis in axes {
        let rest = found.iter().find(|rest| rest.down.dot(axis) > 0.9999);
        let rest = rest.unwrap_or_else(|| panic!("{axis}: {found:?}"));
        let face = axis * size.as_dvec3() * 0.5;
        assert!((rest.base - face).length() < 1e-6, "{axis}: {rest:?}");
        assert!(rest.firmness.iter().all(|firmness| *firmness > 0.9), "{axis}: {rest:?}");
    }
    assert!(found.len() <= 10, "{found:?}");
    for rest in rests(&sphere(0.3, 24)) {
        assert!(rest.firmness[0] < 0.4, "{rest:?}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_rough_underside_is_stood_on_as_a_whole() {
    // A plate of many quads whose heights differ by a hundredth.
    let rough = |p: Vec3| Random::new(u64::from((p.x + 3.0 * p.y).to_bits()), 910).uniform() as f32;
    let bumpy = mapped(&sphere(0.5, 40), |p| {
        let z = if p.z < -0.2 { -0.2 - 0.01 * rough(p) } else { p.z };
        Vec3::new(p.x, p.y, z)
    });
    let found = rests(&bumpy);
    let rest = found.iter().max_by(|a, b| a.down.dot(DVec3::NEG_Z).total_cmp(&b.down.dot(DVec3::NEG_Z))).unwrap();
    assert!(rest.down.dot(DVec3::NEG_Z) > (1.0 * PI / 180.0).cos(), "{rest:?}");
    assert!(rest.firmness[0] > 0.9, "{rest:?}");
}

fn ground(firmness: [f64; 2], normal: DVec3, offset_m: f64) -> Ground {
    let rest = Rest { down: DVec3::Y, base: DVec3::new(0.1, 0.4, -0.05), axes: [DVec3::X, DVec3::Z], firmness };
    Ground { normal, offset_m, gap_m: 0.006, rests: Rc::from([rest]), points: Rc::from([Vec3::Y]), weight: 0.2 }
}

fn pose(random: &mut Random) -> CropPose {
    let mut small = || 0.1 * (random.uniform() - 0.5);
    CropPose {
        rotation: DQuat::from_xyzw(small(), small(), small(), 1.0).normalize(),
        size: -1.6 + small(),
        place: DVec2::new(small(), small()),
        distance: -0.2 + small(),
    }
}

/// The gradient of the quadratic is that of the credit, which it bounds.
#[wasm_bindgen_test(unsupported = test)]
fn the_quadratic_has_the_slope_of_the_credit() {
    const H: f64 = 1e-6;
    for seed in 0..20u64 {
        let mut random = Random::new(seed, 911);
        let pose = pose(&mut random);
        let normal = DVec3::new(0.05, -1.0, -0.1).normalize();
        let base = {
            let (scale, translation) = pose.scale_translation();
            pose.rotation * DVec3::new(0.1, 0.4, -0.05) * scale + translation
        };
        // Without firmness the gap alone counts; without gap the attitude alone.
        let gap_m = if seed % 2 == 0 { 0.02 * (random.uniform() - 0.5) } else { 0.0 };
        let firmness = if seed % 2 == 0 { [0.0; 2] } else { [0.7, 0.3] };
        let surroundings = Surroundings {
            ground: Some(ground(firmness, normal, gap_m - normal.dot(base))),
            ..Surroundings::default()
        };
        let mut equations = NormalEquations::new();
        surroundings.add_to(&mut equations, &pose, false);
        let (_, gradient) = unpacked(&equations);
        for k in 0..7 {
            let at = |x: f64| {
                let mut step: Step = [0.0; 7];
                step[k] = x;
                surroundings.contact(&pose.moved(&step))
            };
            let slope = (at(H) - at(-H)) / (2.0 * H);
            let size = 1e-3 + gradient.amax();
            assert!((slope + gradient[k]).abs() < 1e-2 * size, "seed {seed}, {k}: {slope} and {}", -gradient[k]);
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn what_hangs_is_not_pulled_and_what_is_sunk_in_loses_ever_more() {
    let normal = DVec3::NEG_Y;
    let pose = CropPose { rotation: DQuat::IDENTITY, size: -1.6, place: DVec2::ZERO, distance: 0.0 };
    let (scale, translation) = pose.scale_translation();
    let base = DVec3::new(0.1, 0.4, -0.05) * scale + translation;
    let credit = |gap_m: f64| {
        let ground = ground([1.0; 2], normal, gap_m - normal.dot(base));
        Surroundings { ground: Some(ground), ..Surroundings::default() }.contact(&pose)
    };
    assert!((credit(0.0) - 0.2).abs() < 1e-9, "{}", credit(0.0));
    let pull = |gap_m: f64| credit(gap_m - 0.001) - credit(gap_m);
    assert!(pull(0.006) > 0.01 && pull(0.1) < 1e-4, "{} and {}", pull(0.006), pull(0.1));
    assert!(credit(-0.015) < 0.0 && credit(-0.01) < credit(-0.005));
}

#[wasm_bindgen_test(unsupported = test)]
fn volumes_of_boxes_are_those_of_the_boxes() {
    let camera = Pinhole::new(500.0, 500.0, 159.5, 119.5).unwrap();
    let side = cuboid(Vec3::new(0.2, 0.2, 0.2));
    let at = |x: f64, z: f64| Similarity { translation: nalgebra::Vector3::new(x, 0.0, z), ..Similarity::identity() };
    let [first, second] = [at(0.0, 1.0), at(0.05, 1.1)].map(|pose| layer(&side, &pose, &camera, [320, 240]));
    let [own, shared] = volumes(&first, &second, &camera);
    assert!((own - 0.008).abs() < 2e-4, "{own}");
    assert!((shared - 0.15 * 0.2 * 0.1).abs() < 2e-4, "{shared}");
    let apart = layer(&side, &at(0.0, 1.3), &camera, [320, 240]);
    assert_eq!(volumes(&first, &apart, &camera)[1], 0.0);
}
