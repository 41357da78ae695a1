//! Generated pairs of decreasing overlap: rooms in 3DMatch's layout, and drives along streets in KITTI's.

use nalgebra::{Matrix4, Matrix6};

use super::cloud_file::bin;
use super::kitti::line;
use super::overlap::{covered, information, overlap};
use super::pair::Listed;
use super::places::{Room, street};
use super::sensors::{SENSOR_STREAM, fragment, looking, sweep};
use super::trajectory::{Block, text};
use crate::case_folder::write::ply_points;
use crate::files::write;
use crate::prelude::*;
use sim3align_geometry::voxel_grid::voxel_downsample;

/// Writes the pairs of so many scenes below a folder, and their list, `pairs.json`.
///
/// # Errors
/// [`InvalidArgument`](ErrorCode::InvalidArgument) if a file cannot be written.
pub fn write_pairs(root: &Path, is_lidar: bool, seed: u64, scenes: u32) -> Result<()> {
    let write_scene = if is_lidar { write_drive } else { write_room };
    let mut listed = Vec::new();
    for i in 0..scenes {
        listed.extend(write_scene(root, i, seed.wrapping_mul(0x1_0001).wrapping_add(u64::from(i)))?);
    }
    write(&root.join("pairs.json"), serde_json::json!(listed).to_string().as_bytes())
}

/// Largest distance of two points of the same surface, metres.
const SAME_SURFACE_M: f32 = 0.0375;
/// Fragments of a room.
const FRAGMENTS: u32 = 16;
/// Lower bounds of the overlap of the kinds of pairs, descending, and the maximum number of pairs of a kind.
const BINS: [f64; 3] = [0.6, 0.3, 0.1];
const PAIRS_OF_A_KIND: usize = 8;

/// Writes `room-<n>/cloud_bin_<i>.ply`, `room-<n>-evaluation/gt.log` and `gt.info`.
fn write_room(root: &Path, number: u32, seed: u64) -> Result<Vec<Listed>> {
    let (room, name) = (Room::new(seed)?, format!("room-{number:02}"));
    let random = &mut Random::new(seed, SENSOR_STREAM);
    let start = between(random, 0.0, TAU);
    let mut seen = Vec::new();
    for i in 0..FRAGMENTS {
        let way = start + TAU * f64::from(i) / f64::from(FRAGMENTS);
        let reach = room.half * between(random, 0.25, 0.5);
        let eye = DVec3::new(reach.x * libm::cos(way), reach.y * libm::sin(way), between(random, 1.1, 1.6));
        // Across the room, so that what is seen is some 2 to 4 m away.
        let (yaw, pitch) = (way + 0.5 * TAU + between(random, -0.35, 0.35), between(random, -0.45, -0.1));
        let points = fragment(&room.mesh, eye, yaw, pitch, seed ^ (u64::from(i) + 1) << 32)?;
        write(&root.join(&name).join(format!("cloud_bin_{i}.ply")), &ply_points(&points))?;
        seen.push((points, looking(eye, yaw, pitch)?));
    }
    let (mut poses, mut matrices, mut listed) = (Vec::new(), Vec::new(), Vec::new());
    let mut count = [0; BINS.len()];
    for (target, source) in all_pairs(random) {
        let [(target_points, room_from_target), (source_points, room_from_source)] =
            [target, source].map(|i| &seen[i as usize]);
        let pose = room_from_target.inverse().compose(room_from_source);
        let share = overlap(source_points, target_points, &pose, SAME_SURFACE_M);
        let Some(kind) = BINS.iter().position(|least| share >= *least).filter(|kind| count[*kind] < PAIRS_OF_A_KIND)
        else {
            continue;
        };
        count[kind] += 1;
        let near = covered(source_points, &KdTree::new(target_points), &pose, SAME_SURFACE_M);
        let matrix: Matrix6<f64> = information(near.into_iter().map(|i| source_points[i]));
        let fragments = FRAGMENTS;
        let block = Matrix4::from_column_slice(&pose.to_column_major());
        poses.push(Block { target, source, fragments, matrix: block });
        matrices.push(Block { target, source, fragments, matrix });
        listed.push(Listed { group: name.clone(), source, target, overlap: share });
    }
    let folder = root.join(format!("{name}-evaluation"));
    write(&folder.join("gt.log"), text(&poses).as_bytes())?;
    write(&folder.join("gt.info"), text(&matrices).as_bytes())?;
    Ok(listed)
}

/// All pairs of fragments that are not consecutive, in random order.
fn all_pairs(random: &mut Random) -> Vec<(u32, u32)> {
    let mut pairs: Vec<(u32, u32)> = (0..FRAGMENTS).flat_map(|i| (i + 2..FRAGMENTS).map(move |j| (i, j))).collect();
    for i in (1..pairs.len()).rev() {
        pairs.swap(i, random.below(i + 1));
    }
    pairs
}

/// Way from frame to frame, frames of a drive, the frames between the sweeps of a pair, and the pairs of each distance.
const STEP_M: f64 = 5.0;
const FRAMES: u32 = 17;
const AHEAD: [u32; 5] = [1, 2, 4, 6, 8];
const PAIRS_OF_A_DISTANCE: u32 = 4;
/// Height of the lidar, the voxel at which overlap is measured, and how near points of the same surface are there.
const HEIGHT_M: f64 = 1.73;
const VOXEL_M: f32 = 0.3;
const SAME_VOXEL_M: f32 = 0.45;

/// Writes `sequences/<n>/velodyne/<frame>.bin` and `calib.txt`, `poses/<n>.txt`.
fn write_drive(root: &Path, number: u32, seed: u64) -> Result<Vec<Listed>> {
    let (street, name) = (street(seed, STEP_M * f64::from(FRAMES))?, format!("{:02}", number + 8));
    let random = &mut Random::new(seed, SENSOR_STREAM);
    // Camera 0 looks ahead, a little below and before the lidar.
    let lidar_from_camera = looking(DVec3::ZERO, 0.0, 0.0)?;
    let camera_from_lidar = Similarity { translation: Vector3::new(0.0, -0.08, -0.27), ..lidar_from_camera.inverse() };
    let folder = root.join("sequences").join(&name);
    write(&folder.join("calib.txt"), format!("Tr: {}\n", line(&camera_from_lidar)).as_bytes())?;
    let (mut poses, mut voxels, mut lines): (Vec<Similarity>, Vec<Vec<Vec3>>, String) = Default::default();
    for frame in 0..FRAMES {
        let [roll, pitch, yaw, aside] = [0.01, 0.01, 0.04, 0.2].map(|sd| sd * normal(random));
        let rotation = Rotation3::from_euler_angles(roll, pitch, yaw);
        let translation = Vector3::new(STEP_M * f64::from(frame), aside, HEIGHT_M);
        let pose = Similarity { scale: 1.0, rotation, translation };
        let points = sweep(&street, &pose, seed ^ (u64::from(frame) + 1) << 32)?;
        write(&folder.join("velodyne").join(format!("{frame:06}.bin")), &bin(&points))?;
        let first = poses.first().unwrap_or(&pose).inverse();
        let moved = camera_from_lidar.compose(&first.compose(&pose)).compose(&camera_from_lidar.inverse());
        lines += &format!("{}\n", line(&moved));
        voxels.push(voxel_downsample(&Cloud::from_points(points), VOXEL_M).points);
        poses.push(pose);
    }
    write(&root.join("poses").join(format!("{name}.txt")), lines.as_bytes())?;
    let mut listed = Vec::new();
    for (ahead, k) in AHEAD.into_iter().flat_map(|ahead| (0..PAIRS_OF_A_DISTANCE).map(move |k| (ahead, k))) {
        let source = k * (FRAMES - ahead) / PAIRS_OF_A_DISTANCE;
        let target = source + ahead;
        let [s, t] = [source, target].map(|i| i as usize);
        let overlap = overlap(&voxels[s], &voxels[t], &poses[t].inverse().compose(&poses[s]), SAME_VOXEL_M);
        listed.push(Listed { group: name.clone(), source, target, overlap });
    }
    Ok(listed)
}
