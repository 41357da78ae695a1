//! The calls of the benchmark, and the errors of their poses.

use super::imported::imported;
use super::result::{Meter, ResultRow, by_name, codes, described, three};
use super::row::{Call, Row};
use super::variants::varied;
use crate::case::{Case, CaseFrame, CaseObject};
use crate::clouds::Pair;
use crate::effects::monocular::DepthModel;
use crate::prelude::*;
use sim3align::align::evaluate::{EvaluateOptions, evaluate};
use sim3align::align::search::Request;
use sim3align::align::{align_paper, align_prepared};
use sim3align::calibrate::{Calibrated, Object, calibrate};
use sim3align::metrics::pose_error::pose_errors;
use sim3align::register::register;
use sim3align::report::{Preset, Sim3};
use sim3align::scene::plane::SupportChoice;
use sim3align::scene::task::{PlacedObject, Scene, SceneObject, align_scene};
use sim3align::scheduler::{Scheduler, finished};
use sim3align::track::TrackOptions;
use sim3align::track::tracker::Tracker;
use sim3align::views::ViewsOptions;
use sim3align::views::align_views;

/// Fraction of the object that a frame of a video must show for it to count.
const SHOWN: f64 = 0.4;
/// Largest errors of a registered pair: the root mean squared distance of the benchmark 3DMatch, metres; and of a free scale,
/// which is as much at 4 m, the range of a depth camera.
const RMSE_M: f64 = 0.2;
const SCALE: f64 = 0.05;

/// The results of a row for a case.
pub fn run(case: &Case, row: &Row) -> Vec<ResultRow> {
    let outcome = varied(case, row).and_then(|case| match (&row.import, row.call) {
        (None, Call::Scene) => scene(&case, row),
        (None, Call::Views) => views(&case, row),
        (None, Call::Track) => track(&case, row),
        _ => (0..case.objects.len()).map(|k| alone(&case, k, row)).collect(),
    });
    outcome.unwrap_or_else(|error| (0..case.objects.len()).map(|k| blank(case, 0, k).with_error(&error)).collect())
}

/// The result of a failure.
fn blank(case: &Case, frame: usize, k: usize) -> ResultRow {
    let mut name = if case.objects.len() > 1 { case.name_of(k) } else { case.name.clone() };
    if case.frames.len() > 1 {
        name = format!("{name}/{}", case.frames[frame].name);
    }
    let is_known = case.frames[frame].truths[k].is_some();
    let class = case.objects[k].class.clone();
    let row = ResultRow { name, tier: case.tier.clone(), class, tags: case.tags.clone(), ..ResultRow::default() };
    if is_known { row.with_errors(None) } else { row }
}

/// The result with the errors of a pose.
fn judged(result: ResultRow, object: &CaseObject, frame: &CaseFrame, k: usize, pose: &Similarity) -> ResultRow {
    let Some(truth) = &frame.truths[k] else { return result };
    let symmetry = object.symmetry.group(&object.mesh);
    let errors = symmetry.and_then(|symmetry| pose_errors(&object.mesh, pose, truth, &symmetry));
    result.with_errors(errors.ok().as_ref().map(three))
}

fn similarity(pose: &Sim3) -> Result<Similarity> {
    Similarity::from_column_major(&pose.matrix)
}

/// The options of a row for an object.
fn options_of(case: &Case, k: usize, row: &Row) -> AlignOptions {
    let initial = case.objects[k].initial.filter(|_| row.initial);
    AlignOptions { initial, ..row.precise.clone() }
}

/// One object alone.
fn alone(case: &Case, k: usize, row: &Row) -> Result<ResultRow> {
    let (frame, object, result) = (&case.frames[0], &case.objects[k], blank(case, 0, k));
    let meter = Meter::start();
    let observation = match row.model {
        None => frame.observation(k, row.color)?,
        Some(model) => calibrated(case, k, row, model)?,
    };
    let evaluated = |pose: &Similarity| evaluate(&observation, &object.mesh, pose, &EvaluateOptions::default()).ok();
    let outcome = match (&row.import, row.preset) {
        (Some(folder), _) => {
            let (pose, seconds) = imported(&result.name, folder);
            let result = ResultRow { ms: seconds.map(|seconds| 1000.0 * seconds), ..result };
            pose.map_err(|error| ResultRow { error: Some(error), ..result.clone() }).map(|pose| {
                let found = evaluated(&pose);
                let metrics = found.as_ref().map(|found| by_name(&found.metrics));
                let collapsed = found.is_some_and(|found| found.diagnostics.collapsed);
                (ResultRow { metrics, collapsed, ..result }, pose)
            })
        }
        (None, preset) => {
            let found = match preset {
                Preset::Precise => {
                    let request = Request::new(options_of(case, k, row))?;
                    align_prepared(&observation, &object.prepared(row.color), request, &mut Silent)
                        .map(|found| (result.clone().with_alignment(&found), found.camera_from_mesh))
                }
                Preset::Paper => {
                    let mesh = object.surplus.as_ref().unwrap_or(&object.mesh);
                    align_paper(&observation, mesh, &row.paper, &mut Silent)
                        .map(|found| (result.clone().with_paper_alignment(&found), found.camera_from_mesh))
                }
            };
            let (ms, work) = meter.cost();
            let pose = found.and_then(|(result, pose)| Ok((ResultRow { ms, work, ..result }, similarity(&pose)?)));
            pose.map_err(|error| ResultRow { ms, work, ..result }.with_error(&error))
        }
    };
    // The metrics of the true pose are those of depth in its unit.
    let truth = frame.truths[k].as_ref().filter(|_| row.model.is_none()).and_then(evaluated);
    let truth_metrics = truth.map(|found| by_name(&found.metrics));
    let result = match outcome {
        Ok((result, pose)) if row.model.is_some() => {
            let pose = as_seen(&pose, &observation.camera(), case, k);
            judged(result, object, frame, k, &pose)
        }
        Ok((result, pose)) => judged(result, object, frame, k, &pose),
        Err(failed) => failed,
    };
    Ok(ResultRow { truth_metrics, ..result })
}

/// An object in depth as a depth model gives it, calibrated.
fn calibrated(case: &Case, k: usize, row: &Row, model: DepthModel) -> Result<Observation> {
    let frame = &case.frames[0];
    let mask = frame.observation(k, false)?.mask().clone();
    let view = model.predict(&case.name, frame.exact.as_ref().unwrap_or(&frame.depth), &mask, frame.camera)?;
    let (mesh, options) = (case.objects[k].prepared(row.color), options_of(case, k, row));
    let object = Object { mask: &mask, others: frame.others(k), mesh: &mesh, options: &options };
    let Calibrated { depth, calibration, .. } =
        finished(calibrate(&view, &[object], &mut Silent, &Scheduler::unbounded()))?;
    let observation = Observation::new(depth, mask, calibration.camera)?;
    let observation = observation.with_relief_deviation(calibration.uncertainty.relief());
    match frame.photo.as_ref().filter(|_| row.color) {
        Some(photo) => observation.with_photo(photo.clone()),
        None => Ok(observation),
    }
}

/// The pose that looks the same through the true camera, at the true distance: the unit and the focal length of depth of a
/// depth model may be unknown, what shows in the image is not.
fn as_seen(pose: &Similarity, camera: &Pinhole, case: &Case, k: usize) -> Similarity {
    let (frame, mesh) = (&case.frames[0], &case.objects[k].mesh);
    let center = Bounds::of(mesh.positions()).map_or_else(Vector3::zeros, |bounds| vector3(bounds.center()));
    let (Some(truth), found) = (&frame.truths[k], pose.apply(center)) else { return *pose };
    let distance = truth.apply(center).z;
    let [u, v] = camera.project(vec3(&found));
    let focal = |camera: &Pinhole| (camera.fx * camera.fy).sqrt();
    let scale = pose.scale * focal(camera) / focal(&frame.camera) * distance / found.z;
    let place = vector3(frame.camera.back_project(u, v, distance));
    Similarity { scale, translation: place - pose.rotation * center * scale, ..*pose }
}

/// All objects of an image together.
fn scene(case: &Case, row: &Row) -> Result<Vec<ResultRow>> {
    let frame = &case.frames[0];
    let object = |k: usize| -> Result<SceneObject<'_>> {
        let mask = frame.observation(k, false)?.mask().clone();
        Ok(SceneObject { mask, mesh: case.objects[k].prepared(row.color), options: options_of(case, k, row) })
    };
    let scene = Scene {
        depth: frame.depth.clone(),
        camera: frame.camera,
        relief_deviation: 0.0,
        objects: (0..case.objects.len()).map(object).collect::<Result<_>>()?,
        occluders: Vec::new(),
        support: SupportChoice::Auto,
        snap: false,
    };
    let meter = Meter::start();
    let aligned = align_scene(&scene, &mut Silent)?;
    let (ms, work) = meter.cost();
    let ms = ms.map(|ms| ms / case.objects.len() as f64);
    let result = |(k, placed): (usize, Result<PlacedObject>)| {
        let result = ResultRow { ms, work, ..blank(case, 0, k) };
        let placed = match placed {
            Ok(placed) => placed,
            Err(error) => return Ok(result.with_error(&error)),
        };
        let pose = similarity(&placed.alignment.camera_from_mesh)?;
        Ok(judged(result.with_alignment(&placed.alignment), &case.objects[k], frame, k, &pose))
    };
    aligned.objects.into_iter().enumerate().map(result).collect()
}

/// One object in several images.
fn views(case: &Case, row: &Row) -> Result<Vec<ResultRow>> {
    let object = &case.objects[0];
    let shown: Vec<usize> = (0..case.frames.len()).filter(|k| case.frames[*k].visible >= SHOWN).collect();
    let every = shown.len().div_ceil(row.views.unwrap_or(usize::MAX)).max(1);
    let places: Vec<usize> = shown.into_iter().step_by(every).collect();
    let frames = || places.iter().map(|k| &case.frames[*k]);
    let mut views: Vec<_> = frames().map(|frame| frame.view(row.color)).collect();
    let is_known = row.cameras && views.iter().all(|view| view.world_from_camera.is_some());
    if !is_known {
        views.iter_mut().for_each(|view| view.world_from_camera = None);
    }
    let AlignOptions { quality, seed, .. } = row.precise;
    let symmetry = object.symmetry.clone();
    let options = ViewsOptions { metrics: false, symmetry, quality, seed, ..ViewsOptions::default() };
    let meter = Meter::start();
    let found = align_views(views, &object.prepared(row.color), &options, &mut Silent)?;
    let (ms, work) = meter.cost();
    let mut results = Vec::new();
    for (view, &k) in found.views.iter().zip(&places) {
        let warnings = codes(&found.warnings);
        let scale_sd = found.uncertainty.as_ref().map(|found| found.scale);
        let result = ResultRow { confidence: Some(view.confidence), scale_sd, ms, work, warnings, ..blank(case, k, 0) };
        results.push(judged(result, object, &case.frames[k], 0, &similarity(&view.camera_from_mesh)?));
    }
    Ok(results)
}

/// One object through a video.
fn track(case: &Case, row: &Row) -> Result<Vec<ResultRow>> {
    let object = &case.objects[0];
    let mesh = object.prepared(row.color);
    let AlignOptions { quality, seed, .. } = row.precise;
    let mut tracker = Tracker::new(&mesh, TrackOptions { quality, seed, ..TrackOptions::default() })?;
    let mut results = Vec::new();
    for (k, frame) in case.frames.iter().enumerate() {
        let mut seen = frame.view(row.color).frame;
        if row.masks.is_some_and(|masks| k >= masks) {
            seen.mask = None;
        }
        let meter = Meter::start();
        let found = tracker.next(&seen, &mut Silent);
        let (ms, work) = meter.cost();
        let result = ResultRow { ms, work, ..blank(case, k, 0) };
        let found = match found {
            Ok(found) => found,
            Err(error) => {
                results.push(result.with_error(&error));
                break;
            }
        };
        if frame.visible >= SHOWN {
            let result = ResultRow { confidence: Some(found.confidence), scale_sd: Some(found.scale_sd), ..result };
            results.push(judged(result, object, frame, 0, &similarity(&found.camera_from_mesh)?));
        }
    }
    Ok(results)
}

/// The result of a row for a pair of clouds: `register`, or another program's answer.
pub fn registered(pair: &Pair, row: &Row) -> ResultRow {
    let meter = Meter::start();
    let (pose, ms) = match &row.import {
        Some(folder) => {
            let (pose, seconds) = imported(&pair.name, folder);
            (pose, seconds.map(|seconds| 1000.0 * seconds))
        }
        None => {
            let [source, target] = [&pair.source, &pair.target]
                .map(|points| points.iter().flat_map(|p| p.to_array()).map(f64::from).collect::<Vec<_>>());
            let found = register(&source, &target, &row.register, &mut Silent);
            let pose = found.and_then(|found| similarity(&found.target_from_source));
            (pose.map_err(|error| described(&error)), meter.cost().0)
        }
    };
    let result = ResultRow { name: pair.name.clone(), class: pair.overlap.into(), ms, ..ResultRow::default() };
    let pose = match pose {
        Ok(pose) => pose,
        Err(error) => return ResultRow { error: Some(error), ..result.with_errors(None) },
    };
    let (truth, rmse) = (&pair.target_from_source, pair.rmse_m(&pose));
    let (scale, rotation) = ((pose.scale / truth.scale - 1.0).abs(), truth.rotation_angle_to(&pose).to_degrees());
    let diagonal = Bounds::of(&pair.source).map_or(1.0, |bounds| f64::from((bounds.max - bounds.min).length()));
    let is_right = Some(rmse <= RMSE_M && scale <= SCALE);
    ResultRow { strict: is_right, loose: is_right, errors: Some([scale, rotation, rmse / diagonal]), ..result }
}
