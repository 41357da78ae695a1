//! Registers the pairs on several threads.

use std::path::absolute;

use serde_json::json;
use sim3align_geometry::voxel_grid::voxel_downsample;
use sim3align_lab::bench::records::RecordFile;
use sim3align_lab::clouds::cloud_file::read_cloud;
use sim3align_lab::clouds::overlap::overlap;
use sim3align_lab::clouds::pair::Pair;
use sim3align_lab::clouds::{kitti, three_d_match};
use sim3align_lab::parallel::parallel_map;

use super::super::{Failure, print_progress, thread_count, usage, write_file};
use super::method::Method;
use super::table::{self, Record};
use sim3align_lab::prelude::*;

/// Registers the pairs of a data set.
#[derive(clap::Args)]
pub struct Arguments {
    /// 3DMatch: <scene>/cloud_bin_<i>.ply with <scene>-evaluation/gt.log, <scene>/gt.log or
    /// benchmarks/<name>/<scene>/gt.log; KITTI: sequences/<SS>/velodyne, calib.txt and poses/<SS>.txt
    #[arg(long)]
    data: PathBuf,
    /// Which of benchmarks/<name>: 3DMatch or 3DLoMatch; needed where there are several
    #[arg(long)]
    benchmark: Option<String>,
    /// `register` (default), or NAME=import:DIR: DIR/<id>.json from another program
    #[arg(long = "method")]
    methods: Vec<String>,
    /// An option of register() by its JavaScript name, NAME=VALUE
    #[arg(long = "option")]
    options: Vec<String>,
    /// Takes the first pair and every N-th after it
    #[arg(long, default_value_t = 1)]
    every: usize,
    /// Measures the overlap where it is not listed, for the table's bins
    #[arg(long)]
    measure_overlap: bool,
    /// One JSON line for each pair and method; pairs that the file already has are skipped
    #[arg(long)]
    records: Option<PathBuf>,
    /// Writes [{ id, source, target, voxelSizeM }] for other programs, and runs nothing
    #[arg(long)]
    pairs_json: Option<PathBuf>,
    /// All by default
    #[arg(long)]
    threads: Option<usize>,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let is_kitti = kitti::is_layout(&arguments.data);
    let all = if is_kitti {
        kitti::pairs(&arguments.data)?
    } else {
        three_d_match::pairs(&arguments.data, arguments.benchmark.as_deref())?
    };
    let pairs: Vec<Pair> = all.into_iter().step_by(arguments.every.max(1)).collect();
    if pairs.is_empty() {
        return Err("no pair left to run".into());
    }
    if let Some(path) = &arguments.pairs_json {
        let list = pairs.iter().map(|pair| {
            let (source, target) = (absolute(&pair.source)?, absolute(&pair.target)?);
            Ok(json!({ "id": pair.id, "source": source, "target": target, "voxelSizeM": pair.voxel_size_m }))
        });
        let list: Vec<_> = list.collect::<Result<_, Failure>>()?;
        return write_file(path, json!(list).to_string());
    }
    let names = if arguments.methods.is_empty() { vec!["register".into()] } else { arguments.methods.clone() };
    let methods = names.iter().map(|name| Method::from_name(name, &arguments.options));
    let methods: Vec<Method> = methods.collect::<Result<_, _>>().map_err(usage)?;
    let records = arguments.records.as_deref().map(RecordFile::open).transpose()?;
    let work = |pair: &Pair| run_pair(pair, &methods, arguments.measure_overlap, records.as_ref());
    let threads = thread_count(arguments.threads);
    let made = parallel_map(threads, &pairs, work, |done| print_progress(done, pairs.len()))?;
    let all: Vec<Record> = made.into_iter().flatten().collect();
    let names: Vec<&str> = methods.iter().map(Method::name).collect();
    print!("{}", table::report(&all, &names));
    Ok(())
}

fn run_pair(
    pair: &Pair,
    methods: &[Method],
    measures_overlap: bool,
    records: Option<&RecordFile<Record>>,
) -> Result<Vec<Record>> {
    let known: Vec<Option<Record>> = methods.iter().map(|method| records?.get(&method.key(pair)?).cloned()).collect();
    if known.iter().all(Option::is_some) {
        return Ok(known.into_iter().flatten().collect());
    }
    let (source, target) = (read_cloud(&pair.source)?, read_cloud(&pair.target)?);
    let measured = |size: f32| {
        let voxels = |points: &[Vec3]| voxel_downsample(&Cloud::from_points(points.to_vec()), 0.5 * size).points;
        overlap(&voxels(&source), &voxels(&target), &pair.target_from_source, 0.75 * size)
    };
    let share = pair.overlap.or_else(|| measures_overlap.then(|| measured(pair.voxel_size_m as f32)));
    let mut made = Vec::new();
    for (method, known) in methods.iter().zip(known) {
        if let Some(record) = known {
            made.push(record);
            continue;
        }
        let answer = method.run(pair, &source, &target);
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
            seconds: answer.seconds,
            matrix: answer.target_from_source.as_ref().ok().map(Similarity::to_column_major),
        };
        if let (Some(key), Some(file)) = (method.key(pair), records) {
            file.add(&key, &record)?;
        }
        made.push(record);
    }
    Ok(made)
}
