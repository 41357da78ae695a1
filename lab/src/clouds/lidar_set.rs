//! Drives along streets in KITTI's layout.

use glam::EulerRot;

use super::kitti::line;
use super::lidar::{HEIGHT_M, LIDAR_STREAM, sweep};
use super::overlap::overlap;
use super::pair::{Listed, write_set};
use super::street::Street;
use crate::files::write;
use crate::prelude::*;
use sim3align_geometry::voxel_grid::voxel_downsample;

/// Way from frame to frame.
const STEP_M: f64 = 5.0;

/// Frames of a drive.
const FRAMES: u32 = 17;

/// Frames between the two sweeps of a pair: 5, 10, 20, 30 and 40 m.
const AHEAD: [u32; 5] = [1, 2, 4, 6, 8];

/// Pairs of each distance in a drive.
const PAIRS_OF_A_DISTANCE: u32 = 4;

/// Voxel at which overlap is measured, and how near points of the same surface are there.
const VOXEL_M: f32 = 0.3;
const SAME_SURFACE_M: f32 = 0.45;

/// A drive.
#[derive(Debug, Clone)]
pub struct Drive {
    /// Points in the sensor's frame.
    pub sweeps: Vec<Vec<Vec3>>,
    /// World from lidar.
    pub poses: Vec<Similarity>,
}

impl Drive {
    /// The first `frames` frames of the drive of a seed.
    ///
    /// # Errors
    /// Only in case of a bug in the generator.
    pub fn new(seed: u64, frames: u32) -> Result<Self> {
        let street = Street::new(seed, STEP_M * f64::from(FRAMES));
        let random = &mut Random::new(seed, LIDAR_STREAM);
        let (mut sweeps, mut poses) = (Vec::new(), Vec::new());
        for frame in 0..frames {
            let (at, heading) = street.pose(STEP_M * f64::from(frame));
            let [roll, pitch, yaw] = [0.01, 0.01, 0.04].map(|size| size * normal(random));
            let rotation = DQuat::from_euler(EulerRot::ZYX, heading + yaw, pitch, roll);
            let place = at.extend(HEIGHT_M) + DVec3::new(0.0, 0.2 * normal(random), 0.02 * normal(random));
            let bodies: Vec<_> = street.bodies.iter().copied().chain(street.moving(seed, frame)).collect();
            sweeps.push(sweep(&bodies, place, rotation, seed ^ (u64::from(frame) + 1) << 32));
            let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| rotation * axis);
            let matrix = Matrix3::new(x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z);
            poses.push(Similarity::from_parts(1.0, matrix, place.to_array().into())?);
        }
        Ok(Self { sweeps, poses })
    }

    /// Target from source.
    pub fn pose(&self, source: usize, target: usize) -> Similarity {
        self.poses[target].inverse().compose(&self.poses[source])
    }

    /// Share of the voxels of both sweeps that the other has, too.
    pub fn overlap(&self, source: usize, target: usize) -> f64 {
        let [a, b] =
            [source, target].map(|i| voxel_downsample(&Cloud::from_points(self.sweeps[i].clone()), VOXEL_M).points);
        overlap(&a, &b, &self.pose(source, target), SAME_SURFACE_M)
    }

    fn write(&self, root: &Path, name: &str) -> Result<Vec<Listed>> {
        // Camera 0 looks ahead: x right, y down, z forward, a little below and before the lidar.
        let axes = Matrix3::new(0.0, -1.0, 0.0, 0.0, 0.0, -1.0, 1.0, 0.0, 0.0);
        let camera_from_lidar = Similarity::from_parts(1.0, axes, Vector3::new(0.0, -0.08, -0.27))?;
        let folder = root.join("sequences").join(name);
        let calibration = format!("Tr: {}\n", line(&camera_from_lidar));
        write(&folder.join("calib.txt"), calibration.as_bytes())?;
        let mut text = String::new();
        for (frame, points) in self.sweeps.iter().enumerate() {
            write(&folder.join("velodyne").join(format!("{frame:06}.bin")), &super::cloud_file::bin(points))?;
            let pose = camera_from_lidar.compose(&self.pose(frame, 0)).compose(&camera_from_lidar.inverse());
            text += &format!("{}\n", line(&pose));
        }
        write(&root.join("poses").join(format!("{name}.txt")), text.as_bytes())?;
        let mut listed = Vec::new();
        for ahead in AHEAD {
            let starts = FRAMES - ahead;
            for k in 0..PAIRS_OF_A_DISTANCE {
                let source = k * starts / PAIRS_OF_A_DISTANCE;
                let target = source + ahead;
                let overlap = self.overlap(source as usize, target as usize);
                listed.push(Listed { group: name.to_owned(), source, target, overlap });
            }
        }
        Ok(listed)
    }
}

/// Writes `scenes` drives: `sequences/<n>/velodyne/<frame>.bin` and `calib.txt`, `poses/<n>.txt`, `pairs.json`.
///
/// # Errors
/// [`InvalidArgument`](sim3align_geometry::error::ErrorCode::InvalidArgument) if a file cannot be written.
pub fn write_lidar(root: &Path, seed: u64, scenes: u32) -> Result<()> {
    write_set(root, scenes, |i| {
        let drive = Drive::new(seed.wrapping_mul(0x1_0001).wrapping_add(u64::from(i)), FRAMES)?;
        drive.write(root, &format!("{:02}", i + 8))
    })
}
