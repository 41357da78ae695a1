//! Scans of a place: a depth camera that is moved a little, and a spinning lidar.

use crate::prelude::*;
use sim3align_geometry::voxel_grid::voxel_downsample;

/// Random stream of the errors of sensors.
pub(super) const SENSOR_STREAM: u64 = 0x7365_6e73;

/// World from a sensor (x right, y down, z forward) at `eye` that looks to `yaw` (to the left of +x) and `pitch`, radians.
///
/// # Errors
/// Only in case of a bug in the generator.
pub fn looking(eye: DVec3, yaw: f64, pitch: f64) -> Result<Similarity> {
    let turn = DQuat::from_rotation_z(yaw) * DQuat::from_rotation_y(-pitch);
    let [x, y, z] = [-DVec3::Y, -DVec3::Z, DVec3::X].map(|axis| turn * axis);
    let rotation = Matrix3::new(x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z);
    Similarity::from_parts(1.0, rotation, eye.to_array().into())
}

/// Size of a depth image, its field of view, and the range of its readings.
const WIDTH: usize = 200;
const HEIGHT: usize = 150;
const FOV_Y_DEG: f64 = 45.0;
const RANGE_M: [f64; 2] = [0.4, 4.0];
/// Share of the depth by which neighbouring readings may differ on a surface.
const JUMP: f32 = 0.06;
/// Distance of the points of a fragment.
const SPACING_M: f32 = 0.02;
/// The yaw of each frame of a fragment, relative to the first.
const ASIDE: [f64; 7] = [0.0, -0.45, -0.22, 0.22, 0.45, -0.1, 0.1];

/// Frames of a depth camera, fused as by odometry that drifts a little: points in the frame of the first camera.
///
/// # Errors
/// Only in case of a bug in the generator.
pub fn fragment(place: &Mesh, eye: DVec3, yaw: f64, pitch: f64, seed: u64) -> Result<Vec<Vec3>> {
    let random = &mut Random::new(seed, SENSOR_STREAM);
    let camera = Pinhole::from_vertical_fov(FOV_Y_DEG, WIDTH, HEIGHT)?;
    let first = looking(eye, yaw, pitch)?;
    let mut rasteriser = Rasteriser::new();
    let mut points = Vec::new();
    for (frame, aside) in ASIDE.into_iter().enumerate() {
        let size = if frame == 0 { 0.0 } else { 1.0 };
        let [x, y, z, tilt] = [0.1, 0.1, 0.04, 0.12].map(|sd| size * sd * normal(random));
        let pose = looking(eye + DVec3::new(x, y, z), yaw + aside, pitch + tilt)?;
        rasteriser.render(place, &pose.inverse(), &camera, WIDTH, HEIGHT);
        let drift = Similarity {
            translation: Vector3::from_fn(|_, _| 0.006 * normal(random)),
            rotation: Rotation3::new(Vector3::from_fn(|_, _| 0.004 * normal(random))),
            scale: 1.0,
        };
        let believed = first.inverse().compose(&pose).compose(&drift);
        let seen = readings(rasteriser.depth(), &camera, random);
        points.extend(seen.into_iter().map(|p| vec3(&believed.apply(vector3(p)))));
    }
    Ok(voxel_downsample(&Cloud::from_points(points), SPACING_M).points)
}

/// Readings with the noise and the distortion of structured light, without those at jumps.
fn readings(depth: &[f32], camera: &Pinhole, random: &mut Random) -> Vec<Vec3> {
    let [a, b] = [(); 2].map(|()| between(random, 0.0, TAU));
    let bend = between(random, 0.0, 0.01);
    let mut points = Vec::new();
    for (u, v) in (1..HEIGHT - 1).flat_map(|v| (1..WIDTH - 1).map(move |u| (u, v))) {
        let at = |u: usize, v: usize| depth[v * WIDTH + u];
        let z = at(u, v);
        let noise = normal(random);
        let around = [at(u - 1, v), at(u + 1, v), at(u, v - 1), at(u, v + 1)];
        let true_z = f64::from(z);
        let is_surface = around.iter().all(|other| (other - z).abs() < JUMP * z);
        if !is_surface || !(RANGE_M[0]..=RANGE_M[1]).contains(&true_z) {
            continue;
        }
        let (x, y) = (u as f64 / WIDTH as f64, v as f64 / HEIGHT as f64);
        let wave = bend * libm::sin(4.0 * x + a) * libm::sin(3.0 * y + b);
        let z = true_z * (1.0 + wave) + (0.001 + 0.0018 * true_z * true_z) * noise;
        points.push(camera.back_project(u as f64, v as f64, z));
    }
    points
}

/// Beams and steps of a turn, elevations in degrees, range and noise of a lidar, and the share of readings that get lost.
const BEAMS: usize = 64;
const STEPS: usize = 1000;
const ELEVATIONS_DEG: [f64; 2] = [2.0, -24.8];
const LIDAR_RANGE_M: [f64; 2] = [2.5, 80.0];
const NOISE_M: f64 = 0.02;
const LOST: f64 = 0.06;
/// Side of the four images that a turn is read from.
const SIDE: usize = 1024;

/// One turn of a lidar, as points in its frame (x forward, y left, z up), from four images of 90°.
///
/// # Errors
/// Only in case of a bug in the generator.
pub fn sweep(place: &Mesh, world_from_lidar: &Similarity, seed: u64) -> Result<Vec<Vec3>> {
    let random = &mut Random::new(seed, SENSOR_STREAM);
    let half = 0.5 * SIDE as f64;
    let camera = Pinhole::new(half, half, half - 0.5, half - 0.5)?;
    let mut rasteriser = Rasteriser::new();
    let mut points = Vec::new();
    for side in 0..4 {
        let lidar_from_camera = looking(DVec3::ZERO, FRAC_PI_2 * f64::from(side), 0.0)?;
        let camera_from_world = world_from_lidar.compose(&lidar_from_camera).inverse();
        rasteriser.render(place, &camera_from_world, &camera, SIDE, SIDE);
        for (step, beam) in (0..STEPS / 4).flat_map(|step| (0..BEAMS).map(move |beam| (step, beam))) {
            // To the right of the middle of the image, and up.
            let turn = FRAC_PI_2 * ((step as f64 + 0.5) / (STEPS / 4) as f64 - 0.5);
            let share = beam as f64 / (BEAMS - 1) as f64;
            let elevation = (ELEVATIONS_DEG[0] + share * (ELEVATIONS_DEG[1] - ELEVATIONS_DEG[0])).to_radians();
            let ray = Vector3::new(libm::tan(turn), -libm::tan(elevation) / libm::cos(turn), 1.0);
            let [u, v] = [0, 1].map(|k| (half - 0.5 + half * ray[k]).round() as usize);
            let range = ray.norm() * f64::from(rasteriser.depth()[v.min(SIDE - 1) * SIDE + u.min(SIDE - 1)]);
            let (noise, lost) = (normal(random), random.uniform());
            if lost > LOST && (LIDAR_RANGE_M[0]..=LIDAR_RANGE_M[1]).contains(&range) {
                let seen = ray.normalize() * (range + NOISE_M * noise);
                points.push(vec3(&lidar_from_camera.apply(seen)));
            }
        }
    }
    Ok(points)
}
