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

/// The result, if there is one. An error has code, words and remedy, and is not the package's own.
fn answered<T>(answer: Result<T, Error>) -> Option<T> {
    match answer {
        Ok(found) => {
            RESULTS.set(RESULTS.get() + 1);
            Some(found)
        }
        Err(error) => {
            let words = [&*error.argument, &*error.found, &*error.expected, &*error.remedy];
            let is_typed = error.code != ErrorCode::Internal && words.iter().all(|part| !part.is_empty());
            assert!(is_typed, "untyped: {} {error}", error.code.as_str());
            None
        }
    }
}

fn assert_finite(numbers: &[f64]) {
    assert!(numbers.iter().all(|x| x.is_finite()), "{numbers:?}");
}

fn assert_share(number: f64) {
    assert!((0.0..=1.0).contains(&number), "a share of {number}");
}

/// A similarity with a scale above 0.
fn assert_pose(pose: &Sim3) {
    assert_finite(&pose.matrix);
    let length: f64 = pose.rotation.iter().map(|x| x * x).sum();
    let is_similarity = pose.scale > 0.0 && pose.scale.is_finite() && (length - 1.0).abs() < 1e-6;
    assert!(is_similarity, "scale {}, quaternion of length² {length}", pose.scale);
}

/// All readers, on one damaged file.
pub fn readers(e: &mut Entropy<'_>) {
    let bytes = file(e);
    let depth_scale = e.pick(&[None, None, Some(0.001), Some(0.0), Some(f64::NAN), Some(1e300)]);
    let options = DepthReadOptions { depth_scale, ..DepthReadOptions::default() };
    let is_depth = |z: &f32| z.is_finite() && *z >= 0.0;
    let resource = |_: &str| Some(bytes.clone());
    let mesh_options = MeshReadOptions { format: None, resources: Some(&resource), ..MeshReadOptions::default() };
    if let Some(read) = answered(read_colored_mesh(&bytes, &mesh_options)) {
        let count = read.mesh.positions().len();
        assert!(read.mesh.triangles().as_flattened().iter().all(|&i| (i as usize) < count), "an index out of range");
    }
    if let Some(read) = answered(read_splats(&bytes, true)) {
        assert!(read.mesh.positions().iter().all(|p| p.is_finite()), "Gaussians that are not finite");
    }
    answered(external_resources(&bytes));
    if let Some(depth) = answered(read_depth(&bytes, &options)) {
        assert!(depth.data().iter().all(is_depth), "no depth");
    }
    let kind = e.pick(&[DepthKind::Metric, DepthKind::AffineInvariant]);
    if let Some(read) = answered(read_depth_file(&bytes, &options, kind)) {
        assert!(kind != DepthKind::Metric || read.values.data().iter().all(is_depth), "no depth");
    }
    if let Some(photo) = answered(read_photo(&bytes)) {
        assert!(photo.data().len() <= MAX_PHOTO_PIXELS, "a huge photo");
    }
    if let Some(mask) = answered(read_mask(&bytes).map(|read| read.object)) {
        assert_eq!(mask.width() * mask.height(), mask.data().len());
    }
}

/// Small images and meshes, mostly with little work.
pub fn align(e: &mut Entropy<'_>) {
    aligned(e, false, 300);
}

/// Images and meshes of every size.
pub fn align_large(e: &mut Entropy<'_>) {
    aligned(e, true, 200_000);
}

fn aligned(e: &mut Entropy<'_>, is_large: bool, most: usize) {
    if e.once_in(8) {
        let chosen: PaperOptions = options(e, 5_000);
        let (observation, mesh) = (observation(e, is_large), mesh(e, most));
        let answer = observation.and_then(|seen| align_paper(&seen, &mesh?, &chosen, &mut Silent));
        answered(answer).iter().for_each(|found| assert_pose(&found.camera_from_mesh));
        return;
    }
    let mut chosen: AlignOptions = options(e, 20_000);
    if !e.once_in(8) {
        chosen.quality.set("fast");
        chosen.work_budget = Some(2.0 * e.size(1, 16) as f64);
    }
    let (observation, mesh) = (observation(e, is_large), mesh(e, most));
    let answer = observation.and_then(|seen| align_one(&seen, &mesh?, &chosen, &mut Silent));
    let Some(alignment) = answered(answer) else { return };
    assert_pose(&alignment.camera_from_mesh);
    assert_share(alignment.confidence);
    assert_finite(&[alignment.diagnostics.score]);
    alignment.alternatives.iter().for_each(|other| assert_pose(&other.camera_from_mesh));
    if let Some(u) = &alignment.uncertainty {
        assert_finite(&[u.scale, u.rotation_deg, u.lateral_m, u.distance_m]);
    }
}

/// Numbers of views, and known, unknown and mixed camera poses.
pub fn views(e: &mut Entropy<'_>) {
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
    let Some(found) = answered(answer) else { return };
    assert_pose(&found.world_from_mesh);
    assert_share(found.confidence);
    for view in &found.views {
        assert_pose(&view.camera_from_mesh);
        assert_share(view.confidence);
    }
}

/// Frames and corrections; an error leaves the tracker usable.
pub fn track(e: &mut Entropy<'_>) {
    let mut chosen: TrackOptions = options(e, 5000);
    chosen.quality = if e.once_in(16) { Quality::Auto } else { Quality::Fast };
    let tracker = colored_mesh(e, 300)
        .and_then(|(mesh, colors)| Tracker::new(PreparedMesh::new(mesh).with_colors(colors), chosen));
    let Some(mut tracker) = answered(tracker) else { return };
    let (mut last, mut count) = (None, 0);
    for _ in 0..e.size(1, 5) {
        if e.once_in(5) {
            let frame = e.pick(&[None, Some(0), Some(count), Some(usize::MAX)]);
            let corrected = answered(tracker.correct(&transform(e), frame));
            corrected.iter().flatten().for_each(|frame| assert_pose(&frame.camera_from_mesh));
            continue;
        }
        // As a video goes on: the frame before, without its mask.
        let next = match last.take() {
            Some(frame) if e.once_in(2) => Ok(frame),
            _ => frame(e),
        };
        last = next.as_ref().ok().cloned();
        last.iter_mut().for_each(|frame| frame.mask = None);
        let Some(found) = answered(next.and_then(|frame| tracker.next(&frame, &mut Silent))) else { continue };
        assert_eq!(found.frame, count);
        count += 1;
        assert_pose(&found.camera_from_mesh);
        assert_share(found.confidence);
        assert_finite(&[found.scale_sd, found.score]);
    }
}

/// Any view, mesh and pose.
pub fn evaluate(e: &mut Entropy<'_>) {
    let is_large = e.once_in(16);
    let chosen: EvaluateOptions = options(e, 20_000);
    let (at, seen, mesh): (Similarity, _, _) = (transform(e), observation(e, is_large), mesh(e, 2_000));
    let Some(found) = answered(seen.and_then(|seen| evaluate_pose(&seen, &mesh?, &at, &chosen))) else { return };
    let m = &found.metrics;
    [m.boundary_f, m.iou, m.fitness, m.normal_consistency].into_iter().flatten().for_each(assert_share);
    for length in [m.center_drift_px, m.chamfer_m, m.uni_chamfer_m, m.depth_mae_m].into_iter().flatten() {
        assert!(length.is_finite() && length >= 0.0, "a length of {length}");
    }
}

fn check_registration(answer: Result<Registration, Error>) {
    let Some(found) = answered(answer) else { return };
    assert_finite(&[found.fitness, found.residual]);
    assert_pose(&found.target_from_source);
}

/// Two clouds.
pub fn register(e: &mut Entropy<'_>) {
    let chosen: RegisterOptions = options(e, 20_000);
    let most = if e.once_in(32) { 100_000 } else { 1_000 };
    let [source, target] = clouds(e, most);
    check_registration(sim3align::register::register(&source, &target, &chosen, &mut Silent));
}

/// Two clouds with correspondences, some of them wrong or out of range.
pub fn estimate_sim3(e: &mut Entropy<'_>) {
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
    check_registration(sim3align::register::estimate_sim3(&source, &target, &pairs, &chosen, &mut Silent));
}
