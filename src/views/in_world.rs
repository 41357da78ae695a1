//! The result of views with known camera poses: the best pose, which views it rests on, and how certain it is.

use std::rc::Rc;

use super::View;
use super::by_color::Photos;
use super::common_size::with_shape_error;
use super::joint::JointScore;
use super::predicted_mask::with_predicted_mask;
use super::report::{ViewRole, WorldFrame, WorldUncertainty};
use super::searched_view::SearchedView;
use super::stretch::stretch;
use super::summary::{Summary, SummaryView};
use super::view_set::{Part, Ranked, ViewSet};
use super::world_pose::{OF_SCALE, PlacedCamera, WorldPose};
use crate::error::Result;
use crate::geometry::similarity::Similarity;
use crate::precise::drawing::pose::MeshFrame;
use crate::precise::drawing::prepared_mesh::PreparedMesh;
use crate::precise::no_candidate;
use crate::precise::observation::clean::CleanObservation;
use crate::precise::options::Proportions;
use crate::precise::scoring::appearance::PhotoCells;
use crate::precise::scoring::conditioning::{
    Conditioning, Covariance, at_known, covariance, deviation, fix_roll, widest,
};
use crate::precise::scoring::score::Score;
use crate::precise::search::problem::Search;
use crate::precise::search::ranking::Candidate;
use crate::precise::search::recipe::{FINE, SURE};
use crate::precise::verdict::color::{Judgment, cells};
use crate::precise::verdict::conclusion::{Reliability, reliability};
use crate::report::{Alternative, Sim3};

/// Times that the mask of a view without one is predicted.
const PREDICTIONS: usize = 2;

/// The result on the evidence of all views.
///
/// # Errors
/// [`NoConsensus`](crate::error::ErrorCode::NoConsensus) if no pose is in front of a camera and overlaps a mask.
pub fn in_world(
    searched: &[SearchedView],
    views: &[View],
    mesh: &PreparedMesh<'_>,
    freedom: Proportions,
) -> Result<Summary> {
    let cameras: Vec<PlacedCamera> = views.iter().map(View::camera).collect();
    let parts: Vec<Part<'_>> = searched.iter().map(SearchedView::part).collect();
    let mut used = ViewSet {
        lock_scale: parts.first().is_some_and(|part| part.search.settings.lock_scale),
        renders: parts.iter().map(|part| part.search.renders).sum(),
        parts: parts.clone(),
    };
    let mut ranked = used.join(searched.iter().flat_map(SearchedView::hypotheses).collect());

    // The views that the best pose contradicts are left out.
    let scores = &ranked.first().ok_or_else(no_candidate)?.score.views;
    let agrees = |(part, score): (&Part<'_>, &Score)| parts.len() == 1 || !part.contradicts(score.total);
    let agrees: Vec<bool> = parts.iter().zip(scores).map(agrees).collect();
    let mut roles = vec![ViewRole::Unusable; views.len()];
    for (part, agrees) in parts.iter().zip(&agrees) {
        roles[part.index] = if *agrees { ViewRole::Used } else { ViewRole::Contradicting };
    }
    if agrees.contains(&false) {
        used.parts = parts.iter().zip(&agrees).filter(|(_, agrees)| **agrees).map(|(part, _)| *part).collect();
        ranked = used.rank(&ranked);
    }

    // Views without a mask: it follows from the pose, and the pose from it.
    let mut unmasked: Vec<(usize, Search)> = Vec::new();
    for _ in 0..PREDICTIONS {
        let (Some(best), Some(first)) = (ranked.first(), used.parts.first()) else { break };
        if views.iter().all(|view| view.frame.mask.is_some()) {
            break;
        }
        unmasked = predicted(&best.pose, views, &cameras, first.search);
        let mut all = used.clone();
        all.parts.extend(unmasked.iter().map(|(k, search)| unmasked_part(*k, search, &cameras)));
        ranked = all.rank(&ranked);
        used.renders = all.renders;
    }
    used.parts.extend(unmasked.iter().map(|(k, search)| unmasked_part(*k, search, &cameras)));
    unmasked.iter().for_each(|(k, _)| roles[*k] = ViewRole::Used);

    if let Some(best) = ranked.first_mut()
        && let Some(pose) = used.canonical(&best.pose)
    {
        best.pose = pose;
    }

    let mut size_sd = None;
    if let Some(best) = ranked.first_mut()
        && used.parts.len() > 1
        && !used.lock_scale
        && let Some((pose, sd)) = used.fused_size(best.pose)
    {
        best.pose = pose;
        size_sd = Some(sd);
    }
    let verdict = verdict(&mut used, ranked, size_sd, views, mesh)?;
    let shown = |k: usize| {
        let part = parts.iter().chain(&used.parts).find(|part| part.index == k)?;
        Some(part.search.score(&part.camera.see(&verdict.best.pose)?))
    };
    let shown: Vec<Score> = (0..views.len()).map(|k| shown(k).unwrap_or_default()).collect();
    let proportions = stretch(&used, mesh.mesh(), &verdict.best.pose, freedom);
    Ok(Summary { proportions, ..summary(verdict, &used, views, &cameras, roles, shown)? })
}

/// The best pose, and how far it can be trusted.
struct Verdict {
    best: Ranked,
    /// At its size, if that is fixed.
    conditioning: Option<Conditioning>,
    color: Option<Judgment>,
    /// In the camera of the first view.
    reliability: Reliability,
}

/// The verdict on the `ranked` poses. `size_sd` is the standard deviation of the size, where it does not follow from the score.
fn verdict(
    used: &mut ViewSet<'_>,
    mut ranked: Vec<Ranked>,
    size_sd: Option<f64>,
    views: &[View],
    mesh: &PreparedMesh<'_>,
) -> Result<Verdict> {
    let first = *used.parts.first().ok_or_else(no_candidate)?;
    let mut joint = used.on_fine_grids();
    let is_fixed = used.lock_scale;
    let mut conditioned = |best: &Ranked| {
        let score = joint.score(&best.pose);
        let mut equations = joint.equations(&best.pose, &score);
        let free_axis = first.search.equivalence.free_axis(best.pose.rotation);
        free_axis.into_iter().for_each(|axis| fix_roll(&mut equations, axis));
        let covariance = covariance(&equations);
        let free = covariance.map(|covariance| conditioning(&covariance, &best.pose));
        let free = free.map(|own| Conditioning { scale: size_sd.unwrap_or(own.scale), ..own });
        let fixed = covariance.filter(|_| is_fixed).map(|covariance| Conditioning {
            scale: 0.0,
            ..conditioning(&at_known(&covariance, &OF_SCALE), &best.pose)
        });
        (score, free, fixed.or(free))
    };
    let (mut score, mut free, mut conditioning) = conditioned(ranked.first().ok_or_else(no_candidate)?);
    let is_size_known = is_fixed || size_sd.is_some();
    let judged = by_color(used, views, mesh, (&ranked, free.as_ref()), is_size_known);
    if let Some((_, Some(chosen))) = &judged {
        (score, free, conditioning) = conditioned(chosen);
        ranked.insert(0, chosen.clone());
    }
    let color = judged.map(|(judgment, _)| judgment);
    let best = ranked.first().ok_or_else(no_candidate)?;
    let mut candidates: Vec<Candidate> = ranked.iter().filter_map(|ranked| first.candidate(ranked)).collect();
    if let Some(first) = candidates.first_mut() {
        first.score = mean_score(&score, best.score.total);
    }
    let reliability = reliability(&candidates, color.as_ref(), free.as_ref(), first.search)?;
    Ok(Verdict { best: best.clone(), conditioning, color, reliability })
}

/// The result, with the role of each view and its score.
fn summary(
    verdict: Verdict,
    used: &ViewSet<'_>,
    views: &[View],
    cameras: &[PlacedCamera],
    roles: Vec<ViewRole>,
    shown: Vec<Score>,
) -> Result<Summary> {
    let Verdict { best, conditioning, color, reliability } = verdict;
    let Reliability { mut confidence, alternatives } = reliability;
    let first = used.parts.first().ok_or_else(no_candidate)?;
    let seen = roles.iter().zip(&shown).filter(|(role, _)| **role == ViewRole::Used);
    let depths = seen.map(|(_, score)| f64::from(score.depth));
    // Together they are as certain as the one whose depth is known best.
    let of_used = views.iter().zip(&roles).filter(|(_, role)| **role == ViewRole::Used);
    let is_sure = confidence.shape >= SURE;
    confidence.relief_deviation = of_used.map(|(view, _)| view.frame.relief_deviation).fold(f64::INFINITY, f64::min);
    let turn_confidence = confidence.turn;
    let shape_confidence = confidence.up_to_symmetry().min(share_of_used(&roles));
    let world_from_mesh = best.pose.similarity(&first.search.mesh.frame);
    let of_view = |(k, (role, score)): (usize, (ViewRole, Score))| {
        let world_from_camera = cameras[k].world_from_camera();
        SummaryView {
            camera_from_mesh: world_from_camera.inverse().compose(&world_from_mesh),
            // The camera pose of a view that contradicts may be the cause, and the pose in it follows from that.
            shape_confidence: if role == ViewRole::Contradicting { 0.0 } else { shape_confidence },
            turn_confidence,
            role,
            world_from_camera,
            rotation_sd_deg: Some(0.0),
            position_sd_m: Some(0.0),
            score,
            color: color.as_ref().filter(|_| views[k].frame.photo.is_some()).map(|color| color.report),
        }
    };
    Ok(Summary {
        world_from_mesh,
        world: WorldFrame::Given,
        shape_confidence,
        turn_confidence,
        is_sure,
        symmetry: first.search.equivalence.axes(),
        alternatives: alternatives.into_iter().map(|other| moved(other, &first.camera.world_from_camera())).collect(),
        proportions: None,
        uncertainty: conditioning.map(|own| WorldUncertainty {
            scale: with_shape_error(own.scale, depths),
            rotation_deg: own.rotation.0.to_degrees(),
            rotation_axis: own.rotation.1.to_array(),
            free_axis: first.search.equivalence.free_axis(best.pose.rotation).map(|axis| axis.to_array()),
            position_m: own.position_m,
        }),
        views: roles.into_iter().zip(shown).enumerate().map(of_view).collect(),
        score: f64::from(best.score.total),
        converged: best.converged,
        renders: used.renders,
        effort: first.search.settings.effort,
    })
}

/// The probability that the views that agree are the right ones, as far as the camera poses tell: 1 for a majority, otherwise
/// their share of all that have evidence.
fn share_of_used(roles: &[ViewRole]) -> f64 {
    let count = |role| roles.iter().filter(|other| **other == role).count() as f64;
    let (used, contradicting) = (count(ViewRole::Used), count(ViewRole::Contradicting));
    if used > contradicting { 1.0 } else { used / (used + contradicting) }
}

/// The verdict of colour on the best pose; `None` without colours.
fn by_color(
    used: &mut ViewSet<'_>,
    views: &[View],
    mesh: &PreparedMesh<'_>,
    (ranked, conditioning): (&[Ranked], Option<&Conditioning>),
    lock_scale: bool,
) -> Option<(Judgment, Option<Ranked>)> {
    let colors = mesh.colors()?;
    let photo = |part: &Part<'_>| views[part.index].frame.photo.as_ref().map(|photo| cells(photo, part.search));
    let photos: Vec<Option<PhotoCells>> = used.parts.iter().map(photo).collect();
    photos.iter().flatten().next()?;
    let mut photos = Photos { views: ViewSet { lock_scale, ..used.clone() }, photos: &photos, colors };
    let judged = photos.judge(ranked, conditioning);
    used.renders = photos.views.renders;
    judged
}

/// The evidence of the views without a mask, where the pose predicts one with enough readings.
fn predicted(pose: &WorldPose, views: &[View], cameras: &[PlacedCamera], like: &Search) -> Vec<(usize, Search)> {
    let mesh = &like.mesh;
    let mut evidence = Vec::new();
    for (k, (view, camera)) in views.iter().zip(cameras).enumerate() {
        if view.frame.mask.is_some() {
            continue;
        }
        let Some(seen) = camera.see(pose) else { continue };
        let camera_from_frame = seen.similarity(&MeshFrame::NORMALIZED);
        let frame = with_predicted_mask(view.frame.clone(), &mesh.fine, &camera_from_frame);
        let Ok(Some(observation)) = frame.observation() else { continue };
        let mut search = Search::new(Rc::new(CleanObservation::new(&observation)), mesh.clone(), like.settings);
        search.assume(like.prior);
        search.equivalence = like.equivalence.clone();
        if search.grid(FINE).mask_cells > 0 {
            evidence.push((k, search));
        }
    }
    evidence
}

fn unmasked_part<'a>(index: usize, search: &'a Search, cameras: &[PlacedCamera]) -> Part<'a> {
    Part { index, search, camera: cameras[index], own: None }
}

/// The conditioning of a world pose; its positions are those of the centre of the mesh along the least determined axis.
fn conditioning(covariance: &Covariance, pose: &WorldPose) -> Conditioning {
    let position_m = libm::exp(pose.log_scale) * widest(covariance, 4).0;
    Conditioning {
        scale: deviation(covariance[3][3]),
        rotation: widest(covariance, 0),
        lateral_m: position_m,
        distance_m: position_m,
        position_m,
    }
}

/// The means of the terms over all views, and the total of all.
fn mean_score(score: &JointScore, total: f32) -> Score {
    let count = score.views.len().max(1) as f32;
    let mean = |term: fn(&Score) -> f32| score.views.iter().map(term).sum::<f32>() / count;
    Score {
        total,
        overlap: mean(|s| s.overlap),
        coverage: mean(|s| s.coverage),
        depth: mean(|s| s.depth),
        normals: mean(|s| s.normals),
        outline: mean(|s| s.outline),
        hidden: mean(|s| s.hidden),
        ..Score::default()
    }
}

/// An alternative in the world instead of a camera.
fn moved(other: Alternative, world_from_camera: &Similarity) -> Alternative {
    let Sim3 { matrix, .. } = &other.camera_from_mesh;
    let moved =
        Similarity::from_column_major(matrix).map(|camera_from_mesh| world_from_camera.compose(&camera_from_mesh));
    match moved {
        Ok(world_from_mesh) => Alternative { camera_from_mesh: (&world_from_mesh).into(), ..other },
        Err(_) => other,
    }
}
