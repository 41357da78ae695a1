//! Scans of a room by a depth camera that is moved a little.

use crate::prelude::*;
use sim3align_geometry::voxel_grid::voxel_downsample;

/// Random stream of the errors of sensors.
pub(super) const SENSOR_STREAM: u64 = 0x7365_6e73;

/// World from a sensor (x right, y down, z forward) at `eye` that looks to `yaw` (to the left of +x) and `pitch`, radians.
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
/// Distance of the points of a scan.
const SPACING_M: f32 = 0.02;
/// What a depth camera at `eye` sees that pans over the room: points in the frame of its middle image.
pub fn scan(room: &Mesh, eye: DVec3, yaw: f64, pitch: f64, seed: u64) -> Result<Vec<Vec3>> {
    let random = &mut Random::new(seed, SENSOR_STREAM);
    let camera = Pinhole::from_vertical_fov(FOV_Y_DEG, WIDTH, HEIGHT)?;
    let middle = looking(eye, yaw, pitch)?;
    let mut rasteriser = Rasteriser::new();
    let mut points = Vec::new();
    for aside in [-0.45, 0.0, 0.45] {
        let pose = looking(eye, yaw + aside, pitch)?;
        rasteriser.render(room, &pose.inverse(), &camera, WIDTH, HEIGHT);
        // Fused as by odometry that drifts a little.
        let drift = Similarity {
            translation: Vector3::from_fn(|_, _| 0.006 * normal(random)),
            rotation: Rotation3::new(Vector3::from_fn(|_, _| 0.004 * normal(random))),
            scale: 1.0,
        };
        let believed = middle.inverse().compose(&pose).compose(&drift);
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
