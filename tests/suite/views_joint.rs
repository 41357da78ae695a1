//! The summed objective of several views: its steps and its quadratic against finite differences, and one view alone.

use sim3align::geometry::normal_equations::PARAMETERS;
use sim3align::views::joint::{Joint, JointView};
use sim3align::views::world_pose::{PlacedCamera, WorldPose};

use crate::precise_scene::{model, noisy_grid, pose, scoring};
use crate::prelude::*;

/// A camera anywhere.
fn camera(draw: &mut Draw) -> PlacedCamera {
    let world_from_camera =
        Similarity { scale: 1.0, rotation: draw.rotation(), translation: Vector3::from(draw.cube(2.0)) };
    PlacedCamera::of(&world_from_camera)
}

/// The step that leads from one pose to another nearby.
fn step_between(from: &CropPose, to: &CropPose) -> [f64; PARAMETERS] {
    let turn: DQuat = to.rotation * from.rotation.conjugate();
    let turn = if turn.w < 0.0 { -turn } else { turn };
    // Of a small rotation, twice the vector part.
    let turn = DVec3::new(turn.x, turn.y, turn.z) * 2.0;
    let size = libm::exp(from.size);
    let place: DVec2 = (to.place - from.place) / size;
    [turn.x, turn.y, turn.z, to.size - from.size, place.x, place.y, (to.distance - from.distance) / size]
}

/// What steps of a pose in the world are in a camera that sees it so, by differences of `h`.
fn map_by_differences(
    camera: &PlacedCamera,
    world: &WorldPose,
    seen: &CropPose,
    h: f64,
) -> [[f64; PARAMETERS]; PARAMETERS] {
    let mut map = [[0.0; PARAMETERS]; PARAMETERS];
    for k in 0..PARAMETERS {
        let moved = |by: f64| {
            let mut step = [0.0; PARAMETERS];
            step[k] = by;
            step_between(seen, &camera.see(&world.moved(&step)).unwrap())
        };
        for (row, (after, before)) in map.iter_mut().zip(moved(h).iter().zip(moved(-h))) {
            row[k] = (after - before) / (2.0 * h);
        }
    }
    map
}

#[wasm_bindgen_test(unsupported = test)]
fn a_step_in_the_world_is_its_image_in_the_camera() {
    for seed in 0..20 {
        let draw = &mut Draw::new(seed);
        let (camera, seen) = (camera(draw), pose(draw, 0.3));
        let world = camera.place(&seen);
        let map = camera.step_map(&seen);
        let expected = map_by_differences(&camera, &world, &seen, 1e-6);
        for (found, slope) in map.as_flattened().iter().zip(expected.as_flattened()) {
            assert!((found - slope).abs() < 1e-5, "seed {seed}: {found} for {slope}");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_camera_sees_what_it_placed() {
    for seed in 0..20 {
        let draw = &mut Draw::new(100 + seed);
        let (camera, seen) = (camera(draw), pose(draw, 0.3));
        let off = step_between(&seen, &camera.see(&camera.place(&seen)).unwrap());
        assert!(off.iter().all(|x| x.abs() < 1e-9), "seed {seed}: {off:?}");
        let again = PlacedCamera::of(&camera.world_from_camera());
        let off = step_between(&seen, &again.see(&camera.place(&seen)).unwrap());
        assert!(off.iter().all(|x| x.abs() < 1e-9), "seed {seed}: {off:?}");
        let behind = WorldPose {
            center: camera.place(&CropPose::new(DQuat::IDENTITY, 1.0, DVec3::new(0.0, 0.0, 1.0))).center,
            ..camera.place(&seen)
        };
        let turned = PlacedCamera::of(&Similarity {
            rotation: camera.world_from_camera().rotation
                * Rotation3::from_axis_angle(&Vector3::x_axis(), core::f64::consts::PI),
            ..camera.world_from_camera()
        });
        assert!(turned.see(&behind).is_none(), "seed {seed}: what is behind a camera is not seen");
    }
}

/// Scenes that two cameras see in the same world pose, each with its own faults.
fn two_views(seed: u64, check: impl Fn(&mut Joint<'_>, &WorldPose)) {
    let draw = &mut Draw::new(seed);
    let (model, scoring) = (model(), scoring());
    let seen = pose(draw, 0.0);
    let world = PlacedCamera::AT_ORIGIN.place(&seen);
    // Another camera that is turned about the object.
    let turn = exp(DVec3::new(0.3, 0.7, -0.2));
    let world_from_mesh = world.center;
    let other = {
        let moved = DQuat::from_array((turn).to_array());
        let rotation = nalgebra::UnitQuaternion::new_normalize(nalgebra::Quaternion::from(moved.to_array()));
        let position = world_from_mesh - moved * world_from_mesh;
        PlacedCamera::of(&Similarity {
            scale: 1.0,
            rotation: rotation.to_rotation_matrix(),
            translation: Vector3::from(position.to_array()),
        })
    };
    let cameras = [PlacedCamera::AT_ORIGIN, other];
    let grids = cameras.map(|camera| noisy_grid(draw, &model, &camera.see(&world).unwrap(), &scoring));
    let views = cameras.iter().zip(&grids).map(|(camera, grid)| JointView {
        objective: objective(&model, grid, scoring, Prior::default()),
        camera: *camera,
        floor: 0.0,
    });
    check(&mut Joint::new(views.collect(), false), &world);
}

#[wasm_bindgen_test(unsupported = test)]
fn scores_add_up_and_quadratics_are_mapped() {
    for seed in 0..5 {
        two_views(200 + seed, |joint, world| {
            let summed = joint.score(world);
            let mut expected = NormalEquations::new();
            let mut total = 0.0;
            for view in &joint.views {
                let seen = view.camera.see(world).unwrap();
                let canvas = &mut Canvas::default();
                let score = view.objective.score(canvas, &seen);
                total += score.total;
                let refiner = Refiner { objective: view.objective, lock_scale: false };
                let own = refiner.equations(canvas, &score, &seen);
                let map = map_by_differences(&view.camera, world, &seen, 1e-5);
                expected.add_mapped(&own, &map);
            }
            assert!(summed.total == total && summed.views.len() == 2, "seed {seed}");
            let found = joint.equations(world, &summed);
            for damping in [1e-4, 1e-2, 1.0] {
                let (found, expected) = (found.solve(damping).unwrap(), expected.solve(damping).unwrap());
                let length = expected.iter().map(|x| x * x).sum::<f64>().sqrt();
                let off = found.iter().zip(expected).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
                assert!(off < 1e-4 * length, "seed {seed}, damping {damping}: {found:?} for {expected:?}");
            }
        });
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn mapped_equations_are_those_of_mapped_residuals() {
    for seed in 0..10 {
        let draw = &mut Draw::new(300 + seed);
        let mut row = || core::array::from_fn::<f64, PARAMETERS, _>(|_| draw.between(-1.0, 1.0));
        let map: [[f64; PARAMETERS]; PARAMETERS] = core::array::from_fn(|_| row());
        let residuals: Vec<_> = (0..20).map(|_| (row(), row()[0], row()[0].abs())).collect();
        let (mut own, mut mapped) = (NormalEquations::new(), NormalEquations::new());
        for (jacobian, residual, weight) in &residuals {
            own.add(jacobian, *residual, *weight);
            let through = core::array::from_fn(|k| (0..PARAMETERS).map(|i| jacobian[i] * map[i][k]).sum());
            mapped.add(&through, *residual, *weight);
        }
        let mut found = NormalEquations::new();
        found.add_mapped(&own, &map);
        let (found, expected) = (found.solve(1e-3).unwrap(), mapped.solve(1e-3).unwrap());
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "seed {seed}: {found:?} {expected:?}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_refinement_climbs_and_keeps_a_locked_size() {
    // The evidence is noisy, so that a start may be a summit already.
    let climbed = core::cell::Cell::new(0);
    for seed in 0..5 {
        two_views(400 + seed, |joint, world| {
            let start = world.moved(&[0.05, -0.04, 0.03, 0.02, 0.03, -0.02, 0.02]);
            let before = joint.score(&start).total;
            let free = joint.refine(start, 12);
            assert!(free.score.total >= before, "seed {seed}");
            climbed.set(climbed.get() + u32::from(free.score.total > before + 0.01));
            joint.lock_scale = true;
            let locked = joint.refine(start, 12);
            assert!(locked.score.total >= before, "seed {seed}");
            assert!((locked.pose.log_scale - start.log_scale).abs() < 1e-12, "seed {seed}: the size is locked");
        });
    }
    assert!(climbed.get() >= 4, "{} of 5 climbed", climbed.get());
}

#[wasm_bindgen_test(unsupported = test)]
fn a_view_at_its_floor_adds_a_constant() {
    two_views(500, |joint, world| {
        let own: Vec<f32> = joint.score(world).views.iter().map(|score| score.total).collect();
        joint.views[1].floor = own[1] + 0.5;
        let score = joint.score(world);
        assert_eq!(score.total, own[0] + own[1] + 0.5);
        let found = joint.equations(world, &score).solve(1e-3).unwrap();
        let views = vec![joint.views[0]];
        let alone = &mut Joint::new(views, false);
        let score = alone.score(world);
        assert_eq!(found, alone.equations(world, &score).solve(1e-3).unwrap());
    });
}
