//! Rooms in 3DMatch's layout.

use nalgebra::{Matrix4, Matrix6};

use super::depth_camera::{CAMERA_STREAM, Stand, fragment};
use super::overlap::{covered, information, overlap};
use super::pair::{Listed, write_set};
use super::room::Room;
use super::trajectory::{Block, text};
use crate::case_folder::write::ply_points;
use crate::files::write;
use crate::prelude::*;

/// Points of two fragments that are this near to each other show the same surface.
pub const SAME_SURFACE_M: f32 = 0.0375;

/// Fragments of a scene.
const FRAGMENTS: u32 = 16;

/// Least overlaps of the kinds of pairs, the first that holds counts.
pub const BINS: [f64; 3] = [0.6, 0.3, 0.1];

/// Pairs of each kind that a scene has at most.
const PAIRS_OF_A_KIND: usize = 8;

/// The fragments of a scene, and what is known of its pairs.
#[derive(Debug, Clone)]
pub struct RoomScene {
    /// Each in the frame of its first camera.
    pub fragments: Vec<Vec<Vec3>>,
    /// Target from source, for each pair.
    pub poses: Vec<Block<4>>,
    /// Information, for each pair.
    pub information: Vec<Block<6>>,
    /// Overlap, for each pair.
    pub overlaps: Vec<f64>,
}

impl RoomScene {
    /// The scene of a seed.
    ///
    /// # Errors
    /// Only in case of a bug in the generator.
    pub fn new(seed: u64) -> Result<Self> {
        let room = Room::new(seed)?;
        let random = &mut Random::new(seed, CAMERA_STREAM);
        let start = between(random, 0.0, TAU);
        let seen: Vec<(Vec<Vec3>, Similarity)> = (0..FRAGMENTS)
            .map(|i| {
                let way = start + TAU * f64::from(i) / f64::from(FRAGMENTS);
                let (sine, cosine) = libm::sincos(way);
                let reach = room.half * between(random, 0.25, 0.5);
                let stand = Stand {
                    eye: DVec3::new(reach.x * cosine, reach.y * sine, between(random, 1.1, 1.6)),
                    // Across the room, so that what is seen is some 2 to 4 m away.
                    yaw: way + 0.5 * TAU + between(random, -0.35, 0.35),
                    pitch: between(random, -0.45, -0.1),
                };
                fragment(&room.mesh, stand, seed ^ (u64::from(i) + 1) << 32)
            })
            .collect::<Result<_>>()?;
        let mut scene =
            Self { fragments: Vec::new(), poses: Vec::new(), information: Vec::new(), overlaps: Vec::new() };
        let mut count = [0; BINS.len()];
        for (target, source) in all_pairs(random) {
            let [(target_points, room_from_target), (source_points, room_from_source)] =
                [target, source].map(|i| &seen[i as usize]);
            let pose = room_from_target.inverse().compose(room_from_source);
            let share = overlap(source_points, target_points, &pose, SAME_SURFACE_M);
            let Some(kind) = BINS.iter().position(|least| share >= *least) else { continue };
            if count[kind] == PAIRS_OF_A_KIND {
                continue;
            }
            count[kind] += 1;
            let near = covered(source_points, &KdTree::new(target_points), &pose, SAME_SURFACE_M);
            let matrix: Matrix6<f64> = information(near.into_iter().map(|i| source_points[i]));
            let fragments = FRAGMENTS;
            scene.poses.push(Block {
                target,
                source,
                fragments,
                matrix: Matrix4::from_column_slice(&pose.to_column_major()),
            });
            scene.information.push(Block { target, source, fragments, matrix });
            scene.overlaps.push(share);
        }
        scene.fragments = seen.into_iter().map(|(points, _)| points).collect();
        Ok(scene)
    }

    fn write(&self, root: &Path, name: &str) -> Result<Vec<Listed>> {
        for (i, points) in self.fragments.iter().enumerate() {
            write(&root.join(name).join(format!("cloud_bin_{i}.ply")), &ply_points(points))?;
        }
        let folder = root.join(format!("{name}-evaluation"));
        write(&folder.join("gt.log"), text(&self.poses).as_bytes())?;
        write(&folder.join("gt.info"), text(&self.information).as_bytes())?;
        let listed = |(block, overlap): (&Block<4>, &f64)| Listed {
            group: name.to_owned(),
            source: block.source,
            target: block.target,
            overlap: *overlap,
        };
        Ok(self.poses.iter().zip(&self.overlaps).map(listed).collect())
    }
}

/// All pairs of fragments that are not consecutive, in random order.
fn all_pairs(random: &mut Random) -> Vec<(u32, u32)> {
    let mut pairs: Vec<(u32, u32)> = (0..FRAGMENTS).flat_map(|i| (i + 2..FRAGMENTS).map(move |j| (i, j))).collect();
    for i in (1..pairs.len()).rev() {
        pairs.swap(i, random.below(i + 1));
    }
    pairs
}

/// Writes `scenes` rooms: `room-<n>/cloud_bin_<i>.ply`, `room-<n>-evaluation/gt.log` and `gt.info`, `pairs.json`.
///
/// # Errors
/// [`InvalidArgument`](sim3align_geometry::error::ErrorCode::InvalidArgument) if a file cannot be written.
pub fn write_rooms(root: &Path, seed: u64, scenes: u32) -> Result<()> {
    write_set(root, scenes, |i| {
        let scene = RoomScene::new(seed.wrapping_mul(0x1_0001).wrapping_add(u64::from(i)))?;
        scene.write(root, &format!("room-{i:02}"))
    })
}
