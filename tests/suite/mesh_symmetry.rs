//! Symmetries that are found on the surface of a mesh, and the poses that they make one.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use sim3align::metrics::mesh_symmetry::symmetry_axes;
use sim3align::precise::drawn::equivalence::Equivalence;

use crate::precise_scene::rotation;
use crate::prelude::*;

/// A prism with `sides` sides, `height` high, and narrower at its top by `taper`.
fn prism(sides: u32, height: f32, taper: f32) -> Mesh {
    const STEPS: u32 = 12;
    let corner = |k: u32, z: f32| {
        let (sin, cos) = libm::sincosf(core::f32::consts::TAU * (k % sides) as f32 / sides as f32);
        let radius = 1.0 - taper * (z / height + 0.5);
        Vec3::new(radius * cos, radius * sin, z)
    };
    let level = |step: u32| height * (step as f32 / STEPS as f32 - 0.5);
    let mut positions: Vec<Vec3> = (0..=STEPS).flat_map(|s| (0..sides).map(move |k| corner(k, level(s)))).collect();
    let [bottom, top] = [positions.len() as u32, positions.len() as u32 + 1];
    positions.extend([Vec3::Z * level(0), Vec3::Z * level(STEPS)]);
    let at = |s: u32, k: u32| s * sides + k % sides;
    let walls = (0..STEPS).flat_map(|s| {
        (0..sides)
            .flat_map(move |k| [[at(s, k), at(s, k + 1), at(s + 1, k)], [at(s, k + 1), at(s + 1, k + 1), at(s + 1, k)]])
    });
    let ends = (0..sides).flat_map(|k| [[bottom, at(0, k + 1), at(0, k)], [top, at(STEPS, k), at(STEPS, k + 1)]]);
    Mesh::new(positions, walls.chain(ends).collect()).unwrap()
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

#[wasm_bindgen_test(unsupported = test)]
fn axes_are_found_in_any_direction_and_of_any_order() {
    // The shape, the order of its main axis z, and the number of its axes.
    let shapes: [(&str, Mesh, Option<Option<u32>>, usize); 10] = [
        ("can", prism(48, 2.6, 0.0), Some(None), 2),
        ("cup", prism(48, 2.6, 0.4), Some(None), 1),
        ("flat can", prism(48, 0.7, 0.0), Some(None), 2),
        ("lemon", ellipsoid(Vec3::new(0.6, 0.6, 1.0), 40), Some(None), 2),
        ("nut", prism(6, 1.0, 0.0), Some(Some(6)), 2),
        ("square prism", cuboid(Vec3::new(1.0, 1.0, 2.4)), Some(Some(4)), 2),
        ("pyramid", prism(3, 3.0, 0.7), Some(Some(3)), 1),
        ("cube", cuboid(Vec3::ONE), Some(Some(4)), 2),
        ("ball", sphere(1.0, 40), Some(None), 2),
        ("brick", cuboid(Vec3::new(1.0, 2.0, 3.0)), Some(Some(2)), 2),
    ];
    for seed in 0..4 {
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

#[wasm_bindgen_test(unsupported = test)]
fn what_is_not_symmetric_has_no_axis() {
    for seed in 0..4 {
        let draw = &mut Draw::new(seed);
        let body = mapped(&ellipsoid(Vec3::new(1.0, 0.8, 0.6), 30), |p| {
            p * (1.0 + 0.4 * libm::sinf(3.0 * p.x + 1.0) * libm::sinf(4.0 * p.y + 0.4))
        });
        let (mesh, _) = askew(&body, draw, 0.0);
        assert_eq!(symmetry_axes(&mesh).unwrap(), [], "seed {seed}");
        // A cup with a handle has no axis any more.
        let cup = prism(48, 2.6, 0.4);
        let handle = mapped(&cuboid(Vec3::new(0.6, 0.15, 1.2)), |p| p + Vec3::X * 1.1);
        assert_eq!(symmetry_axes(&askew(&joined(&cup, &handle), draw, 0.0).0).unwrap(), [], "seed {seed}: mug");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn poses_that_a_symmetry_makes_equal_are_no_angle_apart() {
    let equivalence = |mesh: &Mesh| Equivalence::new(Symmetry::Auto.group(mesh).unwrap());
    let [can, box_, ball] = [prism(48, 2.6, 0.0), cuboid(Vec3::new(1.0, 1.0, 2.4)), sphere(1.0, 40)];
    let [can, box_, ball] = [&can, &box_, &ball].map(equivalence);
    for seed in 0..50 {
        let draw = &mut Draw::new(seed);
        let pose = rotation(draw);
        let roll = DQuat::from_rotation_z(draw.between(0.0, TAU));
        let flip = DQuat::from_rotation_x(PI);
        let tilt = draw.between(0.05, 1.4);
        let tilted = pose * DQuat::from_rotation_x(tilt) * roll;
        assert!(can.angle(pose, pose * roll * flip) < 0.03, "seed {seed}");
        assert!((can.angle(pose, tilted) - tilt).abs() < 0.03, "seed {seed}");
        assert!(apart(can.free_axis(pose).unwrap(), pose * DVec3::Z) < 0.03, "seed {seed}");
        assert!(box_.angle(pose, pose * DQuat::from_rotation_z(FRAC_PI_2)) < 0.03, "seed {seed}");
        assert!((box_.angle(pose, pose * DQuat::from_rotation_z(0.5)) - 0.5).abs() < 0.03, "seed {seed}");
        assert!(box_.free_axis(pose).is_none() && ball.free_axis(pose).is_none());
        assert!(ball.is_sphere() && ball.angle(pose, rotation(draw)) < 1e-6, "seed {seed}");
        // The nearest of all equivalent rotations, among all of them.
        let other = rotation(draw);
        let nearest = box_.nearest(pose, other);
        let all = box_.others(pose, 1).into_iter().chain([pose]);
        let least = all.map(|one| angle_between(one, other)).fold(f64::INFINITY, f64::min);
        assert!((angle_between(nearest, other) - least).abs() < 1e-9, "seed {seed}");
    }
    // Eight of the square prism without itself, and all rolls of the can with both ends up.
    assert_eq!((box_.others(DQuat::IDENTITY, 1).len(), can.others(DQuat::IDENTITY, 24).len()), (7, 47));
    assert!(ball.others(DQuat::IDENTITY, 24).is_empty());
}
