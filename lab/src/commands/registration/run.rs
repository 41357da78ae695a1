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

use super::super::{Failure, print_progress, write_file};
use super::method::Method;
use super::settings::Settings;
use super::table::{self, Record};
use sim3align_lab::prelude::*;

pub fn run(settings: &Settings) -> Result<(), Failure> {
    let pairs: Vec<Pair> = pairs(settings)?.into_iter().step_by(settings.every).collect();
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
    let known = |method: &Method| records?.get(&method.key(pair)?).cloned();
    let (source, target) = (read_cloud(&pair.source)?, read_cloud(&pair.target)?);
    let measured = |size: f32| {
        let voxels = |points: &[Vec3]| voxel_downsample(&Cloud::from_points(points.to_vec()), 0.5 * size).points;
        overlap(&voxels(&source), &voxels(&target), &pair.target_from_source, 0.75 * size)
    };
    let share = pair.overlap.or_else(|| settings.measure_overlap.then(|| measured(pair.voxel_size_m as f32)));
    let mut made = Vec::new();
    for method in &settings.methods {
        if let Some(record) = known(method) {
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
