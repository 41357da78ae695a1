//! Pairs of overlapping point clouds with a known transform: scans of generated rooms, for `register`.

mod room;
mod scan;

use crate::case_folder::write::ply;
use crate::files::write;
use crate::prelude::*;
use room::Room;
use scan::{SENSOR_STREAM, looking, scan};

/// Largest distance of two points of the same surface, metres.
const SAME_SURFACE_M: f32 = 0.0375;
/// Scans of a room.
const SCANS: usize = 16;
/// Lower bounds of the overlap of the kinds of pairs, descending, with names; and the maximum number of pairs of a kind.
const OVERLAPS: [(f64, &str); 3] = [(0.6, "overlap ≥ 60 %"), (0.3, "overlap 30–60 %"), (0.1, "overlap 10–30 %")];
const PAIRS_OF_A_KIND: usize = 8;
/// Voxel size for other methods.
pub const VOXEL_SIZE_M: f64 = 0.05;

/// A pair of clouds.
#[derive(Debug)]
pub struct Pair {
    /// Name, valid as file name.
    pub name: String,
    /// The kind, by overlap.
    pub overlap: &'static str,
    /// The source cloud.
    pub source: Vec<Vec3>,
    /// The target cloud.
    pub target: Vec<Vec3>,
    /// The true transform.
    pub target_from_source: Similarity,
    /// Points of the source on surfaces of both clouds.
    common: Vec<Vec3>,
}

impl Pair {
    /// The root mean squared distance by which an estimate displaces the common surface, as in the benchmark 3DMatch,
    /// metres.
    pub fn rmse_m(&self, estimate: &Similarity) -> f64 {
        let squared =
            |p: &Vec3| (estimate.apply(vector3(*p)) - self.target_from_source.apply(vector3(*p))).norm_squared();
        (self.common.iter().map(squared).sum::<f64>() / self.common.len().max(1) as f64).sqrt()
    }

    /// Writes both clouds as PLY.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidArgument`] if a file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<()> {
        write(&folder.join(&self.name).join("source.ply"), &ply(&self.source, &[]))?;
        write(&folder.join(&self.name).join("target.ply"), &ply(&self.target, &[]))
    }
}

/// The pairs of scans of a room, which overlap by at least a tenth.
///
/// # Errors
/// [`ErrorCode::Internal`] in case of a bug in the generator.
pub fn pairs(seed: u64, index: usize) -> Result<Vec<Pair>> {
    let seed = mixed([seed, index as u64]);
    let (room, random) = (Room::new(seed)?, &mut Random::new(seed, SENSOR_STREAM));
    let start = between(random, 0.0, TAU);
    let mut scans = Vec::new();
    for i in 0..SCANS {
        let way = start + TAU * i as f64 / SCANS as f64;
        let reach = room.half * between(random, 0.25, 0.5);
        let eye = DVec3::new(reach.x * libm::cos(way), reach.y * libm::sin(way), between(random, 1.1, 1.6));
        // Across the room, so that what is seen is some 2 to 4 m away.
        let (yaw, pitch) = (way + 0.5 * TAU + between(random, -0.35, 0.35), between(random, -0.45, -0.1));
        scans.push((scan(&room.mesh, eye, yaw, pitch, mixed([seed, i as u64]))?, looking(eye, yaw, pitch)?));
    }
    let mut found = Vec::new();
    // Neighbouring scans are too easy.
    let mut places: Vec<(usize, usize)> = (0..SCANS).flat_map(|i| (i + 2..SCANS).map(move |j| (i, j))).collect();
    for i in (1..places.len()).rev() {
        places.swap(i, random.below(i + 1));
    }
    for (i, j) in places {
        let ((target, room_from_target), (source, room_from_source)) = (&scans[i], &scans[j]);
        let target_from_source = room_from_target.inverse().compose(room_from_source);
        let common = covered(source, target, &target_from_source);
        let back = covered(target, source, &target_from_source.inverse());
        let share = (common.len() + back.len()) as f64 / (source.len() + target.len()).max(1) as f64;
        let Some((_, overlap)) = OVERLAPS.into_iter().find(|(least, _)| share >= *least) else { continue };
        if found.iter().filter(|pair: &&Pair| pair.overlap == overlap).count() < PAIRS_OF_A_KIND {
            let name = format!("room-{index:02}-{i}-{j}");
            let (source, target) = (source.clone(), target.clone());
            found.push(Pair { name, overlap, source, target, target_from_source, common });
        }
    }
    Ok(found)
}

/// The source points near a target point.
fn covered(source: &[Vec3], target: &[Vec3], target_from_source: &Similarity) -> Vec<Vec3> {
    let (transform, tree) = (target_from_source.to_f32(), KdTree::new(target));
    let is_near = |p: &&Vec3| tree.nearest_within(transform.apply(**p), SAME_SURFACE_M).is_some();
    source.iter().filter(is_near).copied().collect()
}
