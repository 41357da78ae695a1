//! What a depth camera makes of a room while it is moved a little: frames fused to one fragment.

use crate::prelude::*;
use sim3align_geometry::voxel_grid::voxel_downsample;

/// Random stream of the path of the camera and its errors.
pub(super) const CAMERA_STREAM: u64 = 0x6361_6d65;

const WIDTH: usize = 200;
const HEIGHT: usize = 150;
const FOV_Y_DEG: f64 = 45.0;

/// Readings nearer or farther are none.
const RANGE_M: [f64; 2] = [0.4, 4.0];

/// Frames of a fragment.
const FRAMES: usize = 7;

/// Points of a fragment are about this far apart.
const SPACING_M: f32 = 0.02;

/// Share of the depth by which neighbouring readings may differ on a surface.
const JUMP: f32 = 0.06;

/// Where a camera stands and looks, in the room.
#[derive(Debug, Clone, Copy)]
pub struct Stand {
    /// Where it is.
    pub eye: DVec3,
    /// To the left of +x, in radians.
    pub yaw: f64,
    /// Upwards, in radians.
    pub pitch: f64,
}

impl Stand {
    /// Room from camera (OpenCV: x right, y down, z forward).
    pub fn room_from_camera(&self) -> Result<Similarity> {
        let forward_left_up = DQuat::from_rotation_z(self.yaw) * DQuat::from_rotation_y(-self.pitch);
        let [x, y, z] = [-DVec3::Y, -DVec3::Z, DVec3::X].map(|axis| forward_left_up * axis);
        let rotation = Matrix3::new(x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z);
        Similarity::from_parts(1.0, rotation, self.eye.to_array().into())
    }
}

/// A fragment in the frame of its first camera, and room from that frame.
///
/// # Errors
/// Only in case of a bug in the generator.
pub fn fragment(room: &Mesh, stand: Stand, seed: u64) -> Result<(Vec<Vec3>, Similarity)> {
    let random = &mut Random::new(seed, CAMERA_STREAM);
    let camera = Pinhole::from_vertical_fov(FOV_Y_DEG, WIDTH, HEIGHT)?;
    let room_from_fragment = stand.room_from_camera()?;
    let mut rasteriser = Rasteriser::new();
    let mut points = Vec::new();
    for frame in 0..FRAMES {
        // The first frame looks straight ahead, the others to both sides in turn.
        let aside = [0.0, -0.45, -0.22, 0.22, 0.45, -0.1, 0.1][frame % FRAMES];
        let shake = |random: &mut Random, size: f64| size * normal(random);
        let moved = Stand {
            eye: stand.eye + DVec3::new(shake(random, 0.1), shake(random, 0.1), shake(random, 0.04)),
            yaw: stand.yaw + aside,
            pitch: stand.pitch + if frame == 0 { 0.0 } else { shake(random, 0.12) },
        };
        let stand = if frame == 0 { stand } else { moved };
        let pose = stand.room_from_camera()?;
        rasteriser.render_depth(room, &pose.inverse(), &camera, WIDTH, HEIGHT);
        let seen = readings(rasteriser.depth(), &camera, random);
        // Odometry drifts within a fragment.
        let drift = Similarity {
            translation: Vector3::from_fn(|_, _| 0.006 * normal(random)),
            rotation: Rotation3::new(Vector3::from_fn(|_, _| 0.004 * normal(random))),
            scale: 1.0,
        };
        let believed = room_from_fragment.inverse().compose(&pose).compose(&drift);
        points.extend(seen.into_iter().map(|p| vec3(&believed.apply(vector3(p)))));
    }
    Ok((voxel_downsample(&Cloud::from_points(points), SPACING_M).points, room_from_fragment))
}

/// Readings with the noise and the distortion of structured light, without those at jumps.
fn readings(depth: &[f32], camera: &Pinhole, random: &mut Random) -> Vec<Vec3> {
    let [a, b, c] = [(); 3].map(|()| between(random, 0.0, TAU));
    let bend = between(random, 0.0, 0.01);
    let mut points = Vec::new();
    for (u, v) in (1..HEIGHT - 1).flat_map(|v| (1..WIDTH - 1).map(move |u| (u, v))) {
        let at = |u: usize, v: usize| depth[v * WIDTH + u];
        let z = at(u, v);
        let noise = normal(random);
        let around = [at(u - 1, v), at(u + 1, v), at(u, v - 1), at(u, v + 1)];
        let is_surface = around.iter().all(|other| (other - z).abs() < JUMP * z);
        let true_z = f64::from(z);
        if !is_surface || !(RANGE_M[0]..=RANGE_M[1]).contains(&true_z) {
            continue;
        }
        let (x, y) = (u as f64 / WIDTH as f64, v as f64 / HEIGHT as f64);
        let wave = bend * libm::sin(4.0 * x + a) * libm::sin(3.0 * y + b + 0.5 * libm::cos(c));
        let z = true_z * (1.0 + wave) + (0.001 + 0.0018 * true_z * true_z) * noise;
        points.push(camera.back_project(u as f64, v as f64, z));
    }
    points
}
