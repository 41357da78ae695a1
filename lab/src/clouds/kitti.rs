//! KITTI odometry: sweeps of a lidar on a car, and where the car was (Geiger et al., CVPR 2012), as pairs after Choy et
//! al. (FCGF, ICCV 2019).

use std::fmt::Write;

use super::pair::{Criterion, Listed, Pair, read_list};
use crate::files::{corrupt, entries, read};
use crate::prelude::*;
use sim3align_formats::text::{lines, number, quoted, words};

/// Voxel size of the baselines.
const VOXEL_SIZE_M: f64 = 0.3;

/// The sequences that are tested on.
const SEQUENCES: [&str; 3] = ["08", "09", "10"];

/// The sweeps of a pair are the last ones that are no further apart.
const APART_M: f64 = 10.0;

/// A pair that all who follow the protocol leave out: sequence, source, target.
const WRONG: (&str, [usize; 2]) = ("08", [15, 58]);

/// Number of frames ahead within which the second sweep is looked for.
const AHEAD: usize = 100;

/// A sequence: the pose of each of its sweeps.
struct Sequence {
    name: String,
    folder: PathBuf,
    /// Camera 0 from lidar.
    camera_from_lidar: Similarity,
    /// First camera from camera 0 at each frame.
    poses: Vec<Similarity>,
}

/// The pairs of `sequences/<SS>/velodyne/<frame>.bin`, `sequences/<SS>/calib.txt` and `poses/<SS>.txt`: those that
/// `pairs.json` lists, where there is one; else frame i, the last frame before the first that is more than 10 m away,
/// and on from the frame after it, but for one pair of sequence 08 whose poses are known to be wrong. Of the sequences
/// that are there, 08 to 10; all, where none of these is.
///
/// # Errors
/// [`ErrorCode::InvalidArgument`] where there is no sequence or a file is missing, [`ErrorCode::CorruptFile`],
/// [`ErrorCode::InvalidTransform`].
pub fn pairs(root: &Path) -> Result<Vec<Pair>> {
    let listed = read_list(root)?;
    let names = |path: &PathBuf| Some(path.file_name()?.to_str()?.to_owned());
    let present: Vec<String> = sequence_folders(root).iter().filter_map(names).collect();
    let tested: Vec<String> = present.iter().filter(|name| SEQUENCES.contains(&name.as_str())).cloned().collect();
    let chosen = if tested.is_empty() || listed.is_some() { present } else { tested };
    if chosen.is_empty() {
        let (argument, found) = (root.display().to_string(), "no sequence");
        let expected = "sequences/<SS>/velodyne, sequences/<SS>/calib.txt and poses/<SS>.txt";
        let remedy = "Name the folder that holds sequences and poses.";
        return Err(Error::new(ErrorCode::InvalidArgument, argument, found, expected, remedy));
    }
    let mut pairs = Vec::new();
    for name in chosen {
        let sequence = Sequence::read(root, name)?;
        match &listed {
            Some(listed) => {
                for Listed { source, target, overlap, .. } in listed.iter().filter(|l| l.group == sequence.name) {
                    pairs.push(sequence.pair(*source as usize, *target as usize, Some(*overlap))?);
                }
            }
            None => {
                for [source, target] in ten_metres_apart(&sequence.poses) {
                    let wrong = (sequence.name.as_str(), [source, target]) == WRONG;
                    if !wrong && sequence.sweep(source).is_file() && sequence.sweep(target).is_file() {
                        pairs.push(sequence.pair(source, target, None)?);
                    }
                }
            }
        }
    }
    Ok(pairs)
}

/// Whether a folder looks like KITTI's.
pub fn is_layout(root: &Path) -> bool {
    !sequence_folders(root).is_empty()
}

fn sequence_folders(root: &Path) -> Vec<PathBuf> {
    let mut folders = entries(&root.join("sequences"));
    folders.retain(|folder| folder.join("velodyne").is_dir());
    folders
}

/// Frame i, the one before the first later one more than 10 m away, and on from the frame after it.
fn ten_metres_apart(poses: &[Similarity]) -> Vec<[usize; 2]> {
    let mut pairs = Vec::new();
    let mut i = 0;
    while let Some(from) = poses.get(i) {
        let is_apart = |pose: &Similarity| (pose.translation - from.translation).norm() > APART_M;
        match poses.iter().skip(i).take(AHEAD).position(is_apart) {
            Some(ahead) if ahead > 1 => {
                pairs.push([i, i + ahead - 1]);
                i += ahead;
            }
            _ => i += 1,
        }
    }
    pairs
}

impl Sequence {
    fn read(root: &Path, name: String) -> Result<Self> {
        let folder = root.join("sequences").join(&name);
        let calibration = folder.join("calib.txt");
        let bytes = read(&calibration)?;
        let tr = lines(&bytes).find_map(|line| {
            let mut words = words(line);
            matches!(words.next(), Some(b"Tr:" | b"Tr_velo_to_cam:")).then(|| words.collect::<Vec<_>>())
        });
        let tr = tr.ok_or_else(|| corrupt(&calibration, "no line Tr:", "Tr: and 12 numbers"))?;
        let camera_from_lidar = three_by_four(&calibration, &tr)?;
        let path = root.join("poses").join(format!("{name}.txt"));
        let bytes = read(&path)?;
        let rows = lines(&bytes).map(|line| words(line).collect::<Vec<_>>()).filter(|row| !row.is_empty());
        let poses = rows.map(|row| three_by_four(&path, &row)).collect::<Result<_>>()?;
        Ok(Self { name, folder, camera_from_lidar, poses })
    }

    fn sweep(&self, frame: usize) -> PathBuf {
        self.folder.join("velodyne").join(format!("{frame:06}.bin"))
    }

    fn pair(&self, source: usize, target: usize, overlap: Option<f64>) -> Result<Pair> {
        let pose = |frame: usize| {
            self.poses.get(frame).map(|pose| pose.compose(&self.camera_from_lidar)).ok_or_else(|| {
                let found = format!("{} poses", self.poses.len());
                corrupt(&self.folder, found, format!("one of frame {frame}"))
            })
        };
        Ok(Pair {
            id: format!("{}-{source:06}-{target:06}", self.name),
            group: self.name.clone(),
            source: self.sweep(source),
            target: self.sweep(target),
            target_from_source: pose(target)?.inverse().compose(&pose(source)?),
            criterion: Criterion::Errors,
            voxel_size_m: VOXEL_SIZE_M,
            overlap,
        })
    }
}

fn three_by_four(path: &Path, row: &[&[u8]]) -> Result<Similarity> {
    let numbers: Vec<f64> = row
        .iter()
        .map(|word| number(word).ok_or_else(|| corrupt(path, quoted(word), "a number")))
        .collect::<Result<_>>()?;
    let &[a, b, c, x, d, e, f, y, g, h, i, z] = numbers.as_slice() else {
        return Err(corrupt(path, format!("{} numbers", numbers.len()), "12: the rows of a 3×4 matrix"));
    };
    let pose = Similarity::from_parts(1.0, Matrix3::new(a, b, c, d, e, f, g, h, i), [x, y, z].into());
    pose.map_err(|error| error.about(path.display().to_string()))
}

/// A pose as one line of 12 numbers.
pub fn line(pose: &Similarity) -> String {
    let mut out = String::new();
    for row in 0..3 {
        let r = pose.rotation.matrix();
        for x in [r[(row, 0)], r[(row, 1)], r[(row, 2)], pose.translation[row]] {
            let _ = write!(out, "{}{x:.12e}", if out.is_empty() { "" } else { " " });
        }
    }
    out
}
