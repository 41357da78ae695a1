//! Calls with drawn inputs, and what their answers have to fulfil.

use sim3align::align::evaluate::{EvaluateOptions, evaluate as evaluate_pose};
use sim3align::align::{align as align_one, align_paper};
use sim3align::error::{Error, ErrorCode};
use sim3align::geometry::depth_kind::DepthKind;
use sim3align::geometry::similarity::Similarity;
use sim3align::options::Choice;
use sim3align::paper::options::PaperOptions;
use sim3align::precise::drawing::prepared_mesh::PreparedMesh;
use sim3align::precise::options::{AlignOptions, Quality};
use sim3align::progress::Silent;
use sim3align::register::options::{EstimateSim3Options, RegisterOptions};
use sim3align::register::report::Registration;
use sim3align::report::Sim3;
use sim3align::track::TrackOptions;
use sim3align::track::tracker::Tracker;
use sim3align::views::ViewsOptions;
use sim3align::views::{View, align_views};
use sim3align_formats::depth::{DepthReadOptions, read_depth, read_depth_file};
use sim3align_formats::mask::read_mask;
use sim3align_formats::mesh::{MeshReadOptions, external_resources, read_colored_mesh};
use sim3align_formats::photo::{MAX_PHOTO_PIXELS, read_photo};
use sim3align_formats::splats::read_splats;

use crate::RESULTS;
use crate::entropy::Entropy;
use crate::files::file;
use crate::images::{frame, observation};
use crate::meshes::{clouds, colored_mesh, mesh};
use crate::options::{options, transform};

type Checked = Result<(), String>;

fn require(is_met: bool, fault: impl FnOnce() -> String) -> Checked {
    if is_met { Ok(()) } else { Err(fault()) }
}

/// A result fulfils the check; an error has code, words and remedy, and is not the package's own.
fn check<T>(answer: Result<T, Error>, check: impl FnOnce(T) -> Checked) -> Checked {
    match answer {
        Ok(found) => {
            RESULTS.set(RESULTS.get() + 1);
            check(found)
        }
        Err(error) => {
            let words = [&*error.argument, &*error.found, &*error.expected, &*error.remedy];
            let is_typed = error.code != ErrorCode::Internal && words.iter().all(|part| !part.is_empty());
            require(is_typed, || format!("untyped: {} {error}", error.code.as_str()))
        }
    }
}

fn finite(name: &str, numbers: &[f64]) -> Checked {
    require(numbers.iter().all(|x| x.is_finite()), || format!("{name}: {numbers:?}"))
}

fn share(name: &str, number: f64) -> Checked {
    require((0.0..=1.0).contains(&number), || format!("{name}: {number}"))
}

/// A similarity with a scale above 0.
fn pose(pose: &Sim3) -> Checked {
    finite("matrix", &pose.matrix)?;
    let length: f64 = pose.rotation.iter().map(|x| x * x).sum();
    let is_similarity = pose.scale > 0.0 && pose.scale.is_finite() && (length - 1.0).abs() < 1e-6;
    require(is_similarity, || format!("scale {}, quaternion of length² {length}", pose.scale))
}

/// All readers, on one damaged file.
pub fn readers(e: &mut Entropy<'_>) -> Checked {
    let bytes = file(e);
    let depth_scale = e.pick(&[None, None, Some(0.001), Some(0.0), Some(f64::NAN), Some(1e300)]);
    let options = DepthReadOptions { depth_scale, integer_depth_scale: None };
    let is_depth = |z: &f32| z.is_finite() && *z >= 0.0;
    let resource = |_: &str| Some(bytes.clone());
    check(
        read_colored_mesh(&bytes, &MeshReadOptions { format: None, resources: Some(&resource), images: None }),
        |read| {
            let count = read.mesh.positions().len();
            let is_in_range = read.mesh.triangles().as_flattened().iter().all(|&i| (i as usize) < count);
            require(is_in_range, || "an index out of range".into())
        },
    )?;
    check(read_splats(&bytes, true), |read| {
        require(read.mesh.positions().iter().all(|p| p.is_finite()), || "Gaussians that are not finite".into())
    })?;
    check(external_resources(&bytes), |_| Ok(()))?;
    check(read_depth(&bytes, &options), |depth| require(depth.data().iter().all(is_depth), || "no depth".into()))?;
    let kind = e.pick(&[DepthKind::Metric, DepthKind::AffineInvariant]);
    check(read_depth_file(&bytes, &options, kind), |read| {
        let is_valid = kind != DepthKind::Metric || read.values.data().iter().all(is_depth);
        require(is_valid, || "no depth".into())
    })?;
    check(read_photo(&bytes), |photo| require(photo.data().len() <= MAX_PHOTO_PIXELS, || "a huge photo".into()))?;
    check(read_mask(&bytes).map(|read| read.object), |mask| {
        require(mask.width() * mask.height() == mask.data().len(), || "a mask of another size".into())
    })
}

/// Small images and meshes, mostly with little work.
pub fn align(e: &mut Entropy<'_>) -> Checked {
    aligned(e, false, 300)
}

/// Images and meshes of every size.
pub fn align_large(e: &mut Entropy<'_>) -> Checked {
    aligned(e, true, 200_000)
}

fn aligned(e: &mut Entropy<'_>, is_large: bool, most: usize) -> Checked {
    if e.once_in(8) {
        let chosen: PaperOptions = options(e, 5_000);
        let (observation, mesh) = (observation(e, is_large), mesh(e, most));
        let answer = observation.and_then(|seen| align_paper(&seen, &mesh?, &chosen, &mut Silent));
        return check(answer, |found| pose(&found.camera_from_mesh));
    }
    let mut chosen: AlignOptions = options(e, 20_000);
    if !e.once_in(8) {
        chosen.quality.set("fast");
        chosen.work_budget = Some(2.0 * e.size(1, 16) as f64);
    }
    let (observation, mesh) = (observation(e, is_large), mesh(e, most));
    let answer = observation.and_then(|seen| align_one(&seen, &mesh?, &chosen, &mut Silent));
    check(answer, |alignment| {
        pose(&alignment.camera_from_mesh)?;
        share("confidence", alignment.confidence)?;
        finite("score", &[alignment.diagnostics.score])?;
        alignment.alternatives.iter().try_for_each(|other| pose(&other.camera_from_mesh))?;
        let Some(u) = &alignment.uncertainty else { return Ok(()) };
        finite("uncertainty", &[u.scale, u.rotation_deg, u.lateral_m, u.distance_m])
    })
}

/// Numbers of views, and known, unknown and mixed camera poses.
pub fn views(e: &mut Entropy<'_>) -> Checked {
    let mut chosen: ViewsOptions = options(e, 5000);
    chosen.quality = if e.once_in(16) { Quality::Auto } else { Quality::Fast };
    let object = colored_mesh(e, 300);
    let known = e.below(3);
    let views = (0..e.pick(&[2, 1, 3, 2, 1, 3, 2, 0])).map(|_| {
        let world_from_camera = match known {
            0 => None,
            1 if e.once_in(16) => None,
            _ => Some(transform(e)),
        };
        Ok(View { frame: frame(e)?, world_from_camera })
    });
    let views: Result<Vec<View>, Error> = views.collect();
    let answer = views.and_then(|views| {
        let (mesh, colors) = object?;
        align_views(views, &PreparedMesh::new(mesh).with_colors(colors), &chosen, &mut Silent)
    });
    check(answer, |found| {
        pose(&found.world_from_mesh)?;
        share("confidence", found.confidence)?;
        found.views.iter().try_for_each(|view| {
            pose(&view.camera_from_mesh)?;
            share("confidence", view.confidence)
        })
    })
}

/// Frames and corrections; an error leaves the tracker usable.
pub fn track(e: &mut Entropy<'_>) -> Checked {
    let mut chosen: TrackOptions = options(e, 5000);
    chosen.quality = if e.once_in(16) { Quality::Auto } else { Quality::Fast };
    let tracker = colored_mesh(e, 300)
        .and_then(|(mesh, colors)| Tracker::new(PreparedMesh::new(mesh).with_colors(colors), chosen));
    let Ok(mut tracker) = tracker else { return check(tracker, |_| Ok(())) };
    let (mut last, mut count) = (None, 0);
    for _ in 0..e.size(1, 5) {
        if e.once_in(5) {
            let frame = e.pick(&[None, Some(0), Some(count), Some(usize::MAX)]);
            let corrected = tracker.correct(&transform(e), frame);
            check(corrected, |frames| frames.iter().try_for_each(|frame| pose(&frame.camera_from_mesh)))?;
            continue;
        }
        // As a video goes on: the frame before, without its mask.
        let next = match last.take() {
            Some(frame) if e.once_in(2) => Ok(frame),
            _ => frame(e),
        };
        last = next.as_ref().ok().cloned();
        last.iter_mut().for_each(|frame| frame.mask = None);
        check(next.and_then(|frame| tracker.next(&frame, &mut Silent)), |found| {
            require(found.frame == count, || format!("frame {} instead of {count}", found.frame))?;
            count += 1;
            pose(&found.camera_from_mesh)?;
            share("confidence", found.confidence)?;
            finite("scaleSd, score", &[found.scale_sd, found.score])
        })?;
    }
    Ok(())
}

/// Any view, mesh and pose.
pub fn evaluate(e: &mut Entropy<'_>) -> Checked {
    let is_large = e.once_in(16);
    let chosen: EvaluateOptions = options(e, 20_000);
    let (at, seen, mesh): (Similarity, _, _) = (transform(e), observation(e, is_large), mesh(e, 2_000));
    check(seen.and_then(|seen| evaluate_pose(&seen, &mesh?, &at, &chosen)), |found| {
        let m = &found.metrics;
        let shares = [m.boundary_f, m.iou, m.fitness, m.normal_consistency];
        shares.into_iter().flatten().try_for_each(|value| share("metric", value))?;
        let lengths = [m.center_drift_px, m.chamfer_m, m.uni_chamfer_m, m.depth_mae_m];
        let is_length = |x: f64| require(x.is_finite() && x >= 0.0, || format!("a length of {x}"));
        lengths.into_iter().flatten().try_for_each(is_length)
    })
}

fn registration(found: Registration) -> Checked {
    finite("fitness, residual", &[found.fitness, found.residual])?;
    pose(&found.target_from_source)
}

/// Two clouds.
pub fn register(e: &mut Entropy<'_>) -> Checked {
    let chosen: RegisterOptions = options(e, 20_000);
    let most = if e.once_in(32) { 100_000 } else { 1_000 };
    let [source, target] = clouds(e, most);
    check(sim3align::register::register(&source, &target, &chosen, &mut Silent), registration)
}

/// Two clouds with correspondences, some of them wrong or out of range.
pub fn estimate_sim3(e: &mut Entropy<'_>) -> Checked {
    let chosen: EstimateSim3Options = options(e, 20_000);
    let [source, target] = clouds(e, 1_000);
    let matching = e.pick(&[1.0, 0.5, 0.0]);
    let mut random = e.noise();
    let mut pair = || {
        let i = random.below(source.len() / 3);
        [i as u32, if random.uniform() < matching { i } else { random.below(target.len() / 3) } as u32]
    };
    let mut pairs: Vec<u32> = (0..e.size(1, 1_000)).flat_map(|_| pair()).collect();
    match e.below(16) {
        14 => drop(pairs.pop()),
        15 => pairs.iter_mut().take(1).for_each(|i| *i = u32::MAX),
        _ => {}
    }
    check(sim3align::register::estimate_sim3(&source, &target, &pairs, &chosen, &mut Silent), registration)
}
