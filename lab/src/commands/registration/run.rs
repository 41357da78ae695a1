//! Registers the pairs on several threads.

use std::path::absolute;

use serde_json::json;
use sim3align_geometry::rotations::super_fibonacci;
use sim3align_geometry::voxel_grid::voxel_downsample;
use sim3align_lab::bench::records::RecordFile;
use sim3align_lab::clouds::cloud_file::read_cloud;
use sim3align_lab::clouds::overlap::overlap;
use sim3align_lab::clouds::pair::Pair;
use sim3align_lab::clouds::{kitti, three_d_match};
use sim3align_lab::parallel::parallel_map;

use super::super::{Failure, print_progress, write_file};
use super::method::Method;
use super::settings::Settings;
use super::table::{self, Record};
use sim3align_lab::prelude::*;

/// Random stream of `--moved`.
const MOVED_STREAM: u64 = 0x6d6f_7665;
/// Random stream of `--scaled`.
const SCALED_STREAM: u64 = 0x7363_616c;

pub fn run(settings: &Settings) -> Result<(), Failure> {
    let mut pairs = pairs(settings)?;
    pairs.retain(|pair| settings.only.as_ref().is_none_or(|text| pair.id.contains(text)));
    let pairs: Vec<Pair> = pairs.into_iter().step_by(settings.every).collect();
    if pairs.is_empty() {
        return Err("no pair left to run".into());
    }
    if let Some(path) = &settings.pairs_json {
        let list = pairs.iter().map(|pair| {
            let (source, target) = (absolute(&pair.source)?, absolute(&pair.target)?);
            Ok(json!({ "id": pair.id, "source": source, "target": target, "voxelSizeM": pair.voxel_size_m }))
        });
        let list: Vec<_> = list.collect::<Result<_, Failure>>()?;
        return write_file(path, json!(list).to_string());
    }
    let records = settings.records.as_deref().map(RecordFile::open).transpose()?;
    let work = |pair: &Pair| run_pair(pair, settings, records.as_ref());
    let made = parallel_map(settings.threads, &pairs, work, |done| print_progress(done, pairs.len()))?;
    let all: Vec<Record> = made.into_iter().flatten().collect();
    let methods: Vec<&str> = settings.methods.iter().map(Method::name).collect();
    print!("{}", table::report(&all, &methods));
    if let Some(path) = &settings.json {
        write_file(path, format!("{}\n", json!(all)))?;
    }
    Ok(())
}

fn pairs(settings: &Settings) -> Result<Vec<Pair>> {
    if settings.is_kitti.unwrap_or_else(|| kitti::is_layout(&settings.data)) {
        kitti::pairs(&settings.data)
    } else {
        three_d_match::pairs(&settings.data, settings.benchmark.as_deref())
    }
}

fn run_pair(pair: &Pair, settings: &Settings, records: Option<&RecordFile<Record>>) -> Result<Vec<Record>> {
    let known = |method: &Method| {
        records?.get(&method.key(pair, settings.moved, settings.scaled)).filter(|_| method.needs_clouds()).cloned()
    };
    let missing = settings.methods.iter().any(|method| method.needs_clouds() && known(method).is_none());
    let overlap_of = |method| known(method)?.overlap;
    let measured = pair.overlap.or_else(|| settings.methods.iter().find_map(overlap_of));
    let measure = settings.measure_overlap && measured.is_none();
    let (source, target) = if missing || measure {
        (read_cloud(&pair.source)?, read_cloud(&pair.target)?)
    } else {
        (Vec::new(), Vec::new())
    };
    let share = measured.or_else(|| {
        let voxels =
            |points: &[Vec3]| voxel_downsample(&Cloud::from_points(points.to_vec()), 0.5 * pair.voxel_size_m as f32);
        let (a, b) = (voxels(&source).points, voxels(&target).points);
        measure.then(|| overlap(&a, &b, &pair.target_from_source, 0.75 * pair.voxel_size_m as f32))
    });
    // Transforms each cloud randomly, and converts the result back to the original frames.
    let (source_move, target_move) = (moved(settings.moved, &pair.id, 0), moved(settings.moved, &pair.id, 1));
    let source_move = scaled(settings.scaled, &pair.id).compose(&source_move);
    let [source, target] = [(source, source_move), (target, target_move)]
        .map(|(points, pose)| points.iter().map(|&p| vec3(&pose.apply(vector3(p)))).collect::<Vec<Vec3>>());
    let mut made = Vec::new();
    for method in &settings.methods {
        if let Some(record) = known(method) {
            made.push(Record { overlap: share.or(record.overlap), ..record });
            continue;
        }
        let mut answer = method.run(pair, &source, &target);
        if method.needs_clouds() {
            answer.target_from_source =
                answer.target_from_source.map(|pose| target_move.inverse().compose(&pose).compose(&source_move));
        }
        let errors = answer.target_from_source.as_ref().ok().map(|pose| pair.errors(pose));
        let record = Record {
            id: pair.id.clone(),
            group: pair.group.clone(),
            method: method.name().to_owned(),
            overlap: share,
            distance_m: pair.distance_m(),
            success: errors.is_some_and(|errors| errors.success),
            rotation_deg: errors.map(|errors| errors.rotation_deg),
            scale: errors.map(|errors| errors.scale),
            translation_m: errors.map(|errors| errors.translation_m),
            rmse_m: errors.and_then(|errors| errors.rmse_m),
            error: answer.target_from_source.as_ref().err().cloned(),
            seconds: Some(answer.seconds).filter(|seconds| seconds.is_finite()),
            matrix: answer.target_from_source.as_ref().ok().map(Similarity::to_column_major),
        };
        if let (true, Some(file)) = (method.needs_clouds(), records) {
            file.add(&method.key(pair, settings.moved, settings.scaled), &record)?;
        }
        made.push(record);
    }
    Ok(made)
}

/// A random scaling for a pair; the identity for seed 0.
fn scaled(seed: u64, id: &str) -> Similarity {
    let mut random = Random::new(seed ^ hash(id, 0) << 8, SCALED_STREAM);
    let scale = if seed == 0 { 1.0 } else { libm::pow(10.0, 2.0 * random.uniform() - 1.0) };
    Similarity { scale, ..Similarity::identity() }
}

fn hash(id: &str, start: u64) -> u64 {
    id.bytes().fold(start, |sum, byte| sum.wrapping_mul(31).wrapping_add(u64::from(byte)))
}

/// A random rigid transform for a pair; the identity for seed 0.
fn moved(seed: u64, id: &str, side: u64) -> Similarity {
    if seed == 0 {
        return Similarity::identity();
    }
    let mut random = Random::new(seed ^ hash(id, side) << 8, MOVED_STREAM);
    const ROTATIONS: usize = 1 << 20;
    let [x, y, z, w] = super_fibonacci(random.below(ROTATIONS), ROTATIONS).to_array();
    let matrix = Similarity::rotation_from_xyzw(&[x, y, z, w]);
    let shift = Vector3::from_fn(|_, _| 60.0 * random.uniform() - 30.0);
    matrix.and_then(|matrix| Similarity::from_parts(1.0, matrix, shift)).unwrap_or_else(|_| Similarity::identity())
}
