//! Errors against a truth, the symmetries that excuse them.

use core::f64::consts::FRAC_PI_2;

use sim3align::metrics::mesh_symmetry::symmetry_axes;
use sim3align::metrics::pose_error::{PoseErrors, pose_errors};

use crate::observations::body;
use crate::prelude::*;
use crate::score::rotation;

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
    pose_errors(mesh, estimate, &truth(), &symmetry.group(mesh).unwrap()).unwrap()
}

#[wasm_bindgen_test]
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

#[wasm_bindgen_test]
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
        let rotation_of = nalgebra::UnitQuaternion::from_rotation_matrix(&rotation);
        let nearest = group.nearest(&rotation_of);
        let sorted: Vec<f64> = group.by_nearness(&rotation_of).iter().map(|turn| turn.angle_to(&rotation_of)).collect();
        assert!(sorted.len() == 24 && sorted.is_sorted(), "seed {seed}: {sorted:?}");
        let found = nearest.to_rotation_matrix().angle_to(&rotation);
        let expected = turns.iter().map(|t| t.angle_to(&rotation)).fold(f64::INFINITY, f64::min);
        assert!((found - expected).abs() < 1e-6, "seed {seed}: {found}, expected {expected}");
    }
    let ball = declared(&[([0.0, 0.0, 1.0], None), ([1.0, 1.0, 0.0], Some(4))]);
    assert!(errors(&mesh, &turned(Vector3::new(1.0, 2.0, 3.0), 2.0), &ball).rotation_error_deg < 1e-5);
}

#[wasm_bindgen_test]
fn half_turns_across_an_axis_of_revolution_are_one_and_make_no_ball() {
    let mesh = cuboid(Vec3::ONE);
    // At any angles to each other, and written with three digits.
    let rod = declared(&[([0.0, 0.0, 1.0], None), ([1.0, 0.0, 0.0], Some(2)), ([0.955, 0.296, 0.001], Some(2))]);
    let error = |axis: [f64; 3], angle: f64| errors(&mesh, &turned(axis.into(), angle), &rod).rotation_error_deg;
    for axis in [[1.0, 0.0, 0.0], [0.4, -1.7, 0.0]] {
        assert!(error(axis, core::f64::consts::PI) < 1e-5, "{axis:?}");
        assert!((error(axis, 0.5) - 0.5f64.to_degrees()).abs() < 1e-5, "{axis:?}");
    }
}

/// The mesh turned at random, away from its origin, and uneven by `uneven` of its size.
fn askew(mesh: &Mesh, draw: &mut Draw, uneven: f32) -> (Mesh, DQuat) {
    let turn = rotation(draw);
    let phase = draw.between(0.0, 6.0) as f32;
    let size = mesh.diagonal() as f32;
    let bumps = |p: Vec3| Vec3::ONE * (uneven * size * libm::sinf(9.0 * p.x / size + 7.0 * p.y / size + phase));
    let moved = mapped(mesh, |p| (turn * (p + bumps(p)).as_dvec3()).as_vec3() + Vec3::new(3.0, -1.0, 2.0));
    (moved, turn)
}

/// The angle between two lines.
fn apart(a: DVec3, b: DVec3) -> f64 {
    libm::acos(a.normalize().dot(b.normalize()).abs().min(1.0))
}

/// The mesh, wider at its top.
fn tapered(mesh: &Mesh) -> Mesh {
    mapped(mesh, |p| Vec3::new(p.x * (1.0 + 0.6 * p.z), p.y * (1.0 + 0.6 * p.z), p.z))
}

#[wasm_bindgen_test]
fn axes_are_found_in_any_direction_and_of_any_order() {
    let lemon = ellipsoid(Vec3::new(0.6, 0.6, 1.0), 40);
    // The shape, the order of its main axis z, and the number of its axes.
    let shapes: [(&str, Mesh, Option<Option<u32>>, usize); 6] = [
        ("cup", tapered(&lemon), Some(None), 1),
        ("lemon", lemon, Some(None), 2),
        ("square prism", cuboid(Vec3::new(1.0, 1.0, 2.4)), Some(Some(4)), 2),
        ("cube", cuboid(Vec3::ONE), Some(Some(4)), 2),
        ("ball", sphere(1.0, 40), Some(None), 2),
        ("brick", cuboid(Vec3::new(1.0, 2.0, 3.0)), Some(Some(2)), 2),
    ];
    for seed in 0..2 {
        let draw = &mut Draw::new(seed);
        for (name, mesh, main, count) in &shapes {
            // As even as scanned and generated meshes are.
            let (mesh, turn) = askew(mesh, draw, if seed == 0 { 0.0 } else { 0.002 });
            let axes = symmetry_axes(&mesh).unwrap();
            let found = format!("seed {seed}, {name}: {axes:?}");
            assert_eq!((axes.first().map(|axis| axis.fold), axes.len()), (*main, *count), "{found}");
            let vector = |k: usize| DVec3::from_array(axes[k].axis.into());
            if !matches!(*name, "cube" | "ball" | "brick") {
                assert!(apart(vector(0), turn * DVec3::Z) < 0.05, "{found}");
            }
            if axes.len() == 2 {
                assert!((apart(vector(0), vector(1)) - FRAC_PI_2).abs() < 1e-9, "{found}");
            }
        }
    }
}

#[wasm_bindgen_test]
fn what_is_not_symmetric_has_no_axis() {
    for seed in 0..2 {
        let draw = &mut Draw::new(seed);
        let (mesh, _) = askew(&body(), draw, 0.0);
        assert_eq!(symmetry_axes(&mesh).unwrap(), [], "seed {seed}");
        // A cup with a handle has no axis any more.
        let cup = tapered(&ellipsoid(Vec3::new(1.0, 1.0, 1.3), 30));
        let handle = mapped(&cuboid(Vec3::new(0.6, 0.15, 1.2)), |p| p + Vec3::X * 1.1);
        assert_eq!(symmetry_axes(&askew(&joined(&cup, &handle), draw, 0.0).0).unwrap(), [], "seed {seed}: mug");
        // A small stem shows which side of an apple is up, and leaves its axis.
        let stem = mapped(&cuboid(Vec3::new(0.05, 0.05, 0.4)), |p| p + Vec3::Z * 1.1);
        let (apple, turn) = askew(&joined(&sphere(1.0, 30), &stem), draw, 0.0);
        let axes = symmetry_axes(&apple).unwrap();
        assert_eq!(axes.iter().map(|axis| axis.fold).collect::<Vec<_>>(), [None], "seed {seed}: apple");
        assert!(apart(DVec3::from_array(axes[0].axis.into()), turn * DVec3::Z) < 0.05, "seed {seed}: {axes:?}");
    }
}
