//! Meshes of generators: where their own layout puts them, and where alignments do.

use std::fs;

use super::benchmark::{LOOSE, STRICT};
use super::scene_bench::{BenchObject, BenchScene};
use super::statistics::{cell, median};
use crate::baselines::icp::{classical, solve};
use crate::case_folder::{json, pose};
use crate::files::entries;
use crate::prelude::*;
use sim3align::align::align;
use sim3align::align::evaluate::{EvaluateOptions, Evaluation, evaluate};
use sim3align::evidence::Evidence;
use sim3align::evidence::clouds::Sampling;
use sim3align::precise::options::Proportions;
use sim3align::register::icp::IcpMetric;

/// The file with a generator's own placement, beside that of the truth.
const PLACEMENT: &str = "sam3d.json";
/// Largest distance of correspondences of ICP, relative to the diameter of the mesh; and its iterations.
const REACH: f64 = 0.1;
const ITERATIONS: usize = 200;

/// The rows of the table.
pub const ROWS: [&str; 4] = ["the generator's own", "ICP from it", "align", "align, proportions"];

/// What was measured of an object, by row; `None` where there is no pose.
pub type Record = [Option<Evaluation>; ROWS.len()];

/// The records of a scene folder, of the objects whose true pose is known.
///
/// # Errors
/// Those of the readers.
pub fn records(folder: &Path, options: &AlignOptions) -> Result<Vec<(String, Record)>> {
    let scene = BenchScene::read(folder)?;
    let folders = entries(&folder.join("objects")).into_iter().filter(|path| path.is_dir());
    let mut records = Vec::new();
    for (k, (object, folder)) in scene.objects.iter().zip(folders).enumerate() {
        let own = fs::read(folder.join(PLACEMENT)).ok();
        let own = own.map(|bytes| pose::similarity(PLACEMENT, &json::parse(PLACEMENT, &bytes)?)).transpose()?;
        if object.truth.is_some() {
            records.push((object.name.clone(), record(&scene, k, object, own, options)?));
        }
    }
    Ok(records)
}

fn record(
    scene: &BenchScene,
    k: usize,
    object: &BenchObject,
    own: Option<Similarity>,
    options: &AlignOptions,
) -> Result<Record> {
    let BenchObject { mask, mesh, truth, .. } = object;
    let mut observation = Observation::new(scene.depth.clone(), mask.clone(), scene.camera)?;
    if let Some(others) = others(scene, k)? {
        observation = observation.with_others(others)?;
    }
    let judged = |mesh: &Mesh, pose: &Similarity| {
        evaluate(&observation, mesh, pose, &EvaluateOptions::against(truth.as_ref())).ok()
    };
    let icp = own.and_then(|own| from_placement(&observation, mesh, &own));
    let options = AlignOptions { proportions: Proportions::Full, ..options.clone() };
    let found = align(&observation, mesh, &options, &mut Silent).ok();
    let stretched = found.as_ref().and_then(|found| found.proportions.as_ref()).and_then(|found| {
        let by = DMat3::from_cols_array_2d(&found.stretch);
        let positions = mesh.positions().iter().map(|p| (by * p.as_dvec3()).as_vec3()).collect();
        let mesh = Mesh::new(positions, mesh.triangles().to_vec()).ok()?;
        judged(&mesh, &Similarity::from_column_major(&found.camera_from_stretched.matrix).ok()?)
    });
    Ok([
        own.and_then(|own| judged(mesh, &own)),
        icp.and_then(|pose| judged(mesh, &pose)),
        found.and_then(|found| judged(mesh, &Similarity::from_column_major(&found.camera_from_mesh.matrix).ok()?)),
        stretched,
    ])
}

/// Point-to-point ICP from a placement, at its scale.
fn from_placement(observation: &Observation, mesh: &Mesh, own: &Similarity) -> Option<Similarity> {
    let sampling = Sampling { max_points: 20_000, surface_samples: 10_000, seed: 0 };
    let evidence = Evidence::of(observation, mesh, &sampling).ok()?;
    let reach = REACH * own.scale * f64::from(Bounds::of(mesh.positions())?.diagonal());
    let settings = classical(IcpMetric::PointToPoint, reach as f32, ITERATIONS);
    let tree = KdTree::new(&evidence.observed.points);
    let refined = solve(&evidence.reconstructed, &evidence.observed, &tree, own, &settings).ok()?;
    Some(refined.target_from_source)
}

/// The pixels of all objects but one; `None` if there are no others.
fn others(scene: &BenchScene, k: usize) -> Result<Option<Mask>> {
    let masks: Vec<&Mask> =
        scene.objects.iter().enumerate().filter(|(j, _)| *j != k).map(|(_, object)| &object.mask).collect();
    let Some(first) = masks.first() else { return Ok(None) };
    let is_other = |i: usize| u8::from(masks.iter().any(|mask| mask.data()[i] != 0));
    Image::new("mask", first.width(), first.height(), (0..first.data().len()).map(is_other).collect()).map(Some)
}

/// A table with a row per method: medians over the objects.
pub fn table(records: &[(String, Record)]) -> String {
    let mut lines = vec![
        "| method | n | strict | loose | scale % | rotation ° | place % | ADD-S % | ADD-S@0.1 | 3D IoU | ICP-Rot ° | IoU | depth mm |"
            .to_owned(),
        format!("|---{}|", "|---".repeat(12)),
    ];
    for (k, name) in ROWS.iter().enumerate() {
        let all: Vec<&Evaluation> = records.iter().filter_map(|(_, record)| record[k].as_ref()).collect();
        let of = |digits: usize, value: &dyn Fn(&Evaluation) -> Option<f64>| {
            cell(median(all.iter().filter_map(|each| value(each)).collect()), digits)
        };
        let share = |holds: &dyn Fn(&Evaluation) -> bool| {
            let count = all.iter().filter(|each| holds(each)).count();
            cell((!all.is_empty()).then(|| 100.0 * count as f64 / records.len() as f64), 1)
        };
        // The truth is that of the mesh as it is: a stretched one has no errors against it.
        let is_stretched = k + 1 == ROWS.len();
        let mut cells = vec![(*name).to_owned(), all.len().to_string()];
        if is_stretched {
            cells.extend(core::iter::repeat_n("–".to_owned(), 9));
        } else {
            let errors = |each: &Evaluation| each.errors;
            let layout = |each: &Evaluation| each.layout;
            cells.extend([
                share(&|each| errors(each).is_some_and(|errors| STRICT.holds(&errors))),
                share(&|each| errors(each).is_some_and(|errors| LOOSE.holds(&errors))),
                of(1, &|each| Some(100.0 * errors(each)?.scale_error)),
                of(1, &|each| Some(errors(each)?.rotation_error_deg)),
                of(1, &|each| Some(100.0 * errors(each)?.translation_error_relative)),
                of(2, &|each| Some(100.0 * layout(each)?.add_s_relative)),
                share(&|each| layout(each).is_some_and(|layout| layout.is_found)),
                of(3, &|each| Some(layout(each)?.box_iou)),
                of(1, &|each| Some(layout(each)?.icp_rotation_deg)),
            ]);
        }
        cells.extend([of(3, &|each| each.metrics.iou), of(1, &|each| each.metrics.depth_mae_mm)]);
        lines.push(format!("| {} |", cells.join(" | ")));
    }
    lines.join("\n")
}
