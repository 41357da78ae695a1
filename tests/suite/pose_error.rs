//! Errors against a truth, and the symmetries that excuse them.

use sim3align::metrics::pose_error::{PoseErrors, pose_errors};

use crate::prelude::*;

const OFFSET: Vec3 = Vec3::new(2.0, -1.0, 0.5);

fn truth() -> Similarity {
    similarity(0.2, [0.3, 1.2, -0.4], [0.1, 0.2, 0.9])
}

/// The truth after a turn of the mesh about `OFFSET`, by `angle` about `axis`.
fn turned(axis: Vector3<f64>, angle: f64) -> Similarity {
    let rotation = Rotation3::new(axis.normalize() * angle);
    let center = Vector3::new(2.0, -1.0, 0.5);
    truth().compose(&Similarity { scale: 1.0, rotation, translation: center - rotation * center })
}

fn brick() -> Mesh {
    mapped(&cuboid(Vec3::new(1.0, 2.0, 3.0)), |p| p + OFFSET)
}

fn declared(axes: &[([f64; 3], Option<u32>)]) -> Symmetry {
    Symmetry::Declared(axes.iter().map(|&(axis, fold)| SymmetryAxis { axis: axis.into(), fold }).collect())
}

fn errors(mesh: &Mesh, estimate: &Similarity, symmetry: &Symmetry) -> PoseErrors {
    pose_errors(mesh, estimate, &truth(), symmetry).unwrap()
}

#[wasm_bindgen_test(unsupported = test)]
fn the_truth_has_no_error() {
    let e = errors(&brick(), &truth(), &Symmetry::None);
    assert!(e.scale_error == 0.0 && e.rotation_error_deg < 1e-9 && e.translation_error_m < 1e-12, "{e:?}");
    assert!(e.add_s_mm < 1e-4, "{e:?}");
}

#[wasm_bindgen_test(unsupported = test)]
fn each_error_is_what_was_done() {
    let mesh = brick();
    let moved = Similarity { translation: truth().translation + Vector3::new(0.003, 0.0, 0.004), ..truth() };
    let e = errors(&mesh, &moved, &Symmetry::None);
    assert!((e.translation_error_m - 0.005).abs() < 1e-12 && e.rotation_error_deg < 1e-9, "{e:?}");
    assert!((e.translation_error_relative - 0.005 / (0.2 * 14.0f64.sqrt())).abs() < 1e-8, "{e:?}");

    let e = errors(&mesh, &turned(Vector3::new(1.0, 2.0, 0.5), 0.1), &Symmetry::None);
    assert!((e.rotation_error_deg - 0.1f64.to_degrees()).abs() < 1e-9, "{e:?}");
    // It turns about the middle of the box, which stays where it is, however far t moves.
    assert!(e.translation_error_m < 1e-12, "{e:?}");

    let e = errors(&mesh, &Similarity { scale: 0.19, ..truth() }, &Symmetry::None);
    assert!((e.scale_error - 0.05).abs() < 1e-12, "{e:?}");
    // About the mesh's origin, so its middle comes nearer to it by 5 %.
    assert!((e.translation_error_m - 0.01 * f64::from(OFFSET.length())).abs() < 1e-8, "{e:?}");
}

#[wasm_bindgen_test(unsupported = test)]
fn add_s_of_a_shifted_sphere() {
    // The mean of |d·cos| over a sphere is d/2; of 2 mm on a radius of 200 mm little is lost to curvature.
    let ball = sphere(1.0, 60);
    let moved = Similarity { translation: truth().translation + Vector3::new(0.0, 0.002, 0.0), ..truth() };
    let e = errors(&ball, &moved, &Symmetry::None);
    assert!((e.add_s_mm - 1.0).abs() < 0.02, "{e:?}");
}

#[wasm_bindgen_test(unsupported = test)]
fn half_turns_of_a_brick_are_found_and_excused() {
    let mesh = brick();
    for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
        let flipped = turned(axis, core::f64::consts::PI);
        assert!((errors(&mesh, &flipped, &Symmetry::None).rotation_error_deg - 180.0).abs() < 1e-6);
        for symmetry in [Symmetry::Auto, declared(&[([1.0, 0.0, 0.0], Some(2)), ([0.0, 0.0, 5.0], Some(2))])] {
            let e = errors(&mesh, &flipped, &symmetry);
            assert!(e.rotation_error_deg < 1e-5 && e.translation_error_m < 1e-7 && e.add_s_mm < 1e-3, "{e:?}");
        }
        // A quarter turn is none of a brick's symmetries.
        let e = errors(&mesh, &turned(axis, core::f64::consts::FRAC_PI_2), &Symmetry::Auto);
        assert!((e.rotation_error_deg - 90.0).abs() < 1e-5, "{e:?}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn what_sticks_out_breaks_the_symmetry() {
    // A brick with a knob on one end: about its long axis it still turns over, end to end it does not.
    let knob = mapped(&cuboid(Vec3::new(0.4, 0.4, 0.6)), |p| p + OFFSET + Vec3::Z * 1.8);
    let mesh = joined(&brick(), &knob);
    let error = |axis| errors(&mesh, &turned(axis, core::f64::consts::PI), &Symmetry::Auto).rotation_error_deg;
    assert!(error(Vector3::z()) < 0.01);
    assert!(error(Vector3::x()) > 179.0 && error(Vector3::y()) > 179.0);
}

#[wasm_bindgen_test(unsupported = test)]
fn any_turn_about_an_axis_of_revolution_is_excused() {
    let mesh = mapped(&ellipsoid(Vec3::new(0.5, 0.5, 1.0), 40), |p| p + OFFSET);
    let lemon = declared(&[([0.0, 0.0, 2.0], None), ([1.0, 0.0, 0.0], Some(2))]);
    for symmetry in [lemon, Symmetry::Auto] {
        for angle in [0.3, 1.7, 3.0, -2.0] {
            let e = errors(&mesh, &turned(Vector3::z(), angle), &symmetry);
            assert!(e.rotation_error_deg < 0.01 && e.translation_error_m < 1e-4 && e.add_s_mm < 0.2, "{e:?}");
        }
        // A tilt of 0.2 after a turn about the axis is a tilt of 0.2.
        let tilted = turned(Vector3::x(), 0.2)
            .compose(&Similarity { rotation: Rotation3::new(Vector3::z() * 1.1), ..Similarity::identity() });
        let e = errors(&mesh, &tilted, &symmetry);
        assert!((e.rotation_error_deg - 0.2f64.to_degrees()).abs() < 0.01, "{e:?}");
    }
    let e = errors(&mesh, &turned(Vector3::z(), 1.7), &declared(&[([0.0, 0.0, 1.0], Some(2))]));
    assert!(e.rotation_error_deg > 70.0, "half turns do not excuse this: {e:?}");
}

#[wasm_bindgen_test(unsupported = test)]
fn the_nearest_turn_is_the_nearest_of_all() {
    // The cube's group from two of its axes, against the 24 signed permutations of the axes.
    let cube = declared(&[([0.0, 0.0, 1.0], Some(4)), ([1.0, 0.0, 0.0], Some(4))]);
    let mesh = cuboid(Vec3::ONE);
    let group = cube.group(&mesh).unwrap();
    let mut turns = Vec::new();
    for i in 0..3 {
        for j in (0..3).filter(|j| *j != i) {
            for (s, t) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
                let (x, y) = (Vector3::ith(i, s), Vector3::ith(j, t));
                turns.push(Rotation3::from_basis_unchecked(&[x, y, x.cross(&y)]));
            }
        }
    }
    assert_eq!(turns.len(), 24);
    for seed in 0..200 {
        let mut random = Random::new(seed, 917);
        let rotation = Rotation3::new(Vector3::from_fn(|_, _| random.uniform() * 6.0 - 3.0));
        let nearest = group.nearest(&nalgebra::UnitQuaternion::from_rotation_matrix(&rotation));
        let found = nearest.to_rotation_matrix().angle_to(&rotation);
        let expected = turns.iter().map(|t| t.angle_to(&rotation)).fold(f64::INFINITY, f64::min);
        assert!((found - expected).abs() < 1e-6, "seed {seed}: {found}, expected {expected}");
    }
    let ball = declared(&[([0.0, 0.0, 1.0], None), ([1.0, 1.0, 0.0], Some(4))]);
    assert!(errors(&mesh, &turned(Vector3::new(1.0, 2.0, 3.0), 2.0), &ball).rotation_error_deg < 1e-5);
}

#[wasm_bindgen_test(unsupported = test)]
fn axes_that_make_no_group_are_refused() {
    let wrong = [
        declared(&[([0.0, 0.0, 0.0], Some(2))]),
        declared(&[([0.0, f64::NAN, 1.0], Some(2))]),
        declared(&[([0.0, 0.0, 1.0], Some(0))]),
        declared(&[([0.0, 0.0, 1.0], Some(7)), ([0.0, 1.0, 1.0], Some(7))]),
    ];
    for symmetry in wrong {
        let error = pose_errors(&brick(), &truth(), &truth(), &symmetry).unwrap_err();
        assert_eq!((error.code, &*error.argument), (ErrorCode::InvalidOption, "symmetry"), "{symmetry:?}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn descriptions_are_read_by_their_first_word() {
    for (text, expected) in [
        ("none", Symmetry::None),
        ("unknown", Symmetry::None),
        ("", Symmetry::None),
        ("discrete: 180deg about each axis in shape", Symmetry::Auto),
        (" Continuous about z", Symmetry::Auto),
    ] {
        assert_eq!(Symmetry::from_description(text), expected, "{text}");
    }
}
