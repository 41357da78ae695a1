//! 3DMatch and 3DLoMatch: fragments of RGB-D scans, and the pairs of them that overlap (Zeng et al., CVPR 2017;
//! Huang et al., CVPR 2021).

use std::collections::BTreeMap;

use nalgebra::Matrix6;

use super::pair::{Criterion, Pair, read_list};
use super::trajectory::{Block, read_blocks};
use crate::files::{corrupt, entries};
use crate::prelude::*;

/// Voxel size of the baselines.
const VOXEL_SIZE_M: f64 = 0.05;

/// The folders of a scene's fragments and of its ground truth.
struct Scene {
    name: String,
    fragments: PathBuf,
    ground_truth: PathBuf,
}

/// The pairs of a folder of scenes: `<scene>/cloud_bin_<i>.ply` with `<scene>-evaluation/gt.log` and `gt.info`, or with
/// both beside the fragments, or below `benchmarks/<name>/<scene>`, where `benchmark` chooses among several names
/// (`3DMatch`, `3DLoMatch`). Consecutive fragments are left out, as the protocol has it.
///
/// # Errors
/// [`ErrorCode::InvalidArgument`] where there is no scene or a file is missing, [`ErrorCode::CorruptFile`] where
/// `gt.log` and `gt.info` disagree or hold something else, [`ErrorCode::InvalidTransform`].
pub fn pairs(root: &Path, benchmark: Option<&str>) -> Result<Vec<Pair>> {
    let overlaps: BTreeMap<(String, u32, u32), f64> = read_list(root)?
        .into_iter()
        .flatten()
        .map(|listed| ((listed.group, listed.source, listed.target), listed.overlap))
        .collect();
    let scenes = scenes(root, benchmark);
    if scenes.is_empty() {
        return Err(Error::new(
            ErrorCode::InvalidArgument,
            root.display().to_string(),
            "no scene",
            "<scene>/cloud_bin_0.ply with <scene>-evaluation/gt.log, <scene>/gt.log or benchmarks/<name>/<scene>/gt.log",
            "Name the folder that holds the scenes.",
        ));
    }
    let mut pairs = Vec::new();
    for scene in scenes {
        let (log, info) = (scene.ground_truth.join("gt.log"), scene.ground_truth.join("gt.info"));
        let poses: Vec<Block<4>> = read_blocks(&log)?;
        let information: BTreeMap<(u32, u32), Matrix6<f64>> =
            read_blocks(&info)?.into_iter().map(|block| ((block.source, block.target), block.matrix)).collect();
        for block in poses.iter().filter(|block| block.source > block.target.saturating_add(1)) {
            let (source, target) = (block.source, block.target);
            let found = || format!("nothing about {target} {source}");
            let matrix =
                information.get(&(source, target)).ok_or_else(|| corrupt(&info, found(), "what gt.log has"))?;
            if matrix[(0, 0)].is_nan() || matrix[(0, 0)] <= 0.0 {
                return Err(corrupt(&info, format!("{} corresponding points", matrix[(0, 0)]), "more than none"));
            }
            let cloud = |i: u32| scene.fragments.join(format!("cloud_bin_{i}.ply"));
            pairs.push(Pair {
                id: format!("{}-{target}-{source}", scene.name),
                source: cloud(source),
                target: cloud(target),
                target_from_source: rigid(&log, block)?,
                criterion: Criterion::Rmse(Box::new(*matrix)),
                voxel_size_m: VOXEL_SIZE_M,
                overlap: overlaps.get(&(scene.name.clone(), source, target)).copied(),
                group: scene.name.clone(),
            });
        }
    }
    Ok(pairs)
}

fn scenes(root: &Path, benchmark: Option<&str>) -> Vec<Scene> {
    let mut benchmarks = entries(&root.join("benchmarks"));
    benchmarks.retain(|folder| benchmark.is_none_or(|name| folder.file_name().is_some_and(|n| n == name)));
    let scene = |fragments: PathBuf| {
        let name = fragments.file_name()?.to_str()?.to_owned();
        if !fragments.join("cloud_bin_0.ply").is_file() {
            return None;
        }
        let beside = [fragments.with_file_name(format!("{name}-evaluation")), fragments.clone()];
        let mut places = benchmarks.iter().map(|folder| folder.join(&name)).chain(beside);
        let ground_truth = places.find(|folder| folder.join("gt.log").is_file())?;
        Some(Scene { name, fragments, ground_truth })
    };
    let folders = entries(root).into_iter().chain(entries(&root.join("fragments")));
    folders.filter_map(scene).collect()
}

fn rigid(path: &Path, block: &Block<4>) -> Result<Similarity> {
    let m = &block.matrix;
    let last_row = m.row(3) - nalgebra::RowVector4::new(0.0, 0.0, 0.0, 1.0);
    if last_row.amax() > 1e-6 {
        return Err(corrupt(path, format!("{} as last row", m.row(3)), "0 0 0 1"));
    }
    let pose = Similarity::from_parts(1.0, m.fixed_view::<3, 3>(0, 0).into(), m.fixed_view::<3, 1>(0, 3).into());
    pose.map_err(|error| error.about(path.display().to_string()))
}
