//! Unrelated views, without camera poses: one size for all of them, and a pose in each.

use super::View;
use super::common_size::{SILHOUETTE_ERROR, SizeEvidence, common_size, mean, refine_at, with_shape_error};
use super::report::{ViewRole, WorldFrame, WorldUncertainty};
use super::searched_view::SearchedView;
use super::summary::{Summary, SummaryView};
use crate::error::Result;
use crate::geometry::similarity::Similarity;
use crate::precise::no_candidate;
use crate::precise::scoring::conditioning::Conditioning;
use crate::precise::scoring::objective::Objective;
use crate::precise::search::problem::Search;
use crate::precise::search::ranking::Candidate;
use crate::precise::search::recipe::{COMMON_SIZE, FINE, SURE};
use crate::precise::verdict::alternatives::lead;
use crate::precise::verdict::color::Judgment;
use crate::precise::verdict::confidence::{Confidence, pose_probability};

/// Score below a view's best at which a pose of it is not tried at the common size.
const NEAR: f32 = 0.35;
/// Poses of a view tried at the common size.
const TRIED: usize = 5;
/// Number of other poses of a view that its lead is measured against.
const RIVALS: usize = 8;
/// Times that the size follows from the poses that were refined at the size before.
const ROUNDS: usize = 2;

/// The result of views with unknown camera poses.
pub struct CommonSize {
    /// Standard deviation of the size, relative.
    pub sd: f64,
    /// The pose of each searched view at this scale, and whether the view agrees with it.
    pub views: Vec<(Candidate, bool)>,
    /// Number of poses rendered.
    pub renders: usize,
}

/// Finds the common size; `None` if no view has a pose.
pub fn with_common_size(searched: &[SearchedView]) -> Option<CommonSize> {
    let [rank, polish] = COMMON_SIZE;
    let mut renders = 0;
    let likely: Vec<Vec<Candidate>> = searched.iter().map(likely).collect();
    let evidence: Vec<Vec<SizeEvidence>> = searched
        .iter()
        .zip(&likely)
        .map(|(view, candidates)| {
            let objective = fine(&view.rounds.search);
            renders += candidates.len();
            candidates
                .iter()
                .filter_map(|candidate| SizeEvidence::at(objective, &candidate.pose, SILHOUETTE_ERROR))
                .collect()
        })
        .collect();
    let fixed = searched.first()?.rounds.search.prior.fixed_scale().map(libm::log);
    let (mut size, mut sd, chosen) = common_size(&evidence, fixed)?;
    let agrees: Vec<bool> = chosen.iter().map(Option::is_some).collect();
    let mut poses: Vec<Candidate> = Vec::new();
    for round in 0..ROUNDS {
        poses = searched
            .iter()
            .enumerate()
            .map(|(k, view)| {
                // A view that contradicts keeps its own size.
                let tried = if round == 0 { likely[k].clone() } else { vec![poses[k]] };
                let refined = tried.into_iter().map(|candidate| {
                    let own = candidate.pose.size + candidate.pose.distance;
                    let at = if agrees[k] { size } else { own };
                    let refined = refine_at(view.rounds.search.objective(rank.grid), candidate.pose, at, rank.steps);
                    renders += refined.renders;
                    refined
                });
                best_of(refined)
            })
            .collect::<Option<Vec<_>>>()?;
        let evidence = searched.iter().zip(&poses).zip(&agrees).filter(|(_, agrees)| **agrees);
        let evidence: Vec<SizeEvidence> = evidence
            .filter_map(|((view, candidate), _)| {
                SizeEvidence::at(fine(&view.rounds.search), &candidate.pose, SILHOUETTE_ERROR)
            })
            .collect();
        if fixed.is_none() {
            (size, sd) = mean(evidence.iter().copied()).unwrap_or((size, sd));
        }
    }
    let views = searched.iter().zip(poses).zip(agrees).map(|((view, candidate), agrees)| {
        let own = candidate.pose.size + candidate.pose.distance;
        let search = &view.rounds.search;
        let refined =
            refine_at(search.objective(polish.grid), candidate.pose, if agrees { size } else { own }, polish.steps);
        renders += refined.renders;
        // The score stays that of the fine grid, because scores of different grids are not comparable.
        (Candidate { score: search.score(&refined.pose), renders: 0, ..refined }, agrees)
    });
    let views = views.collect();
    Some(CommonSize { sd, views, renders })
}

/// The result of views without camera poses. Its world is the camera of the first view that agrees with the size. A view
/// that was not searched has the pose of that view, without confidence.
///
/// # Errors
/// [`NoConsensus`](crate::error::ErrorCode::NoConsensus) if no view has a pose.
pub fn unrelated(searched: &[SearchedView], frames: &[View]) -> Result<Summary> {
    let common = with_common_size(searched).ok_or_else(no_candidate)?;
    let mut views: Vec<JudgedView> =
        searched.iter().zip(&common.views).map(|(view, pose)| judged(view, pose, common.sd, frames)).collect();
    let first = common.views.iter().position(|(_, agrees)| *agrees).unwrap_or(0);
    place_cameras(&mut views, first);

    let used = || views.iter().filter(|view| view.summary.role == ViewRole::Used);
    // Without a view that agrees, nothing is known.
    let shape_confidence = used().map(|view| view.summary.shape_confidence).reduce(f64::min).unwrap_or(0.0);
    let turn_confidence = used().filter_map(|view| view.summary.turn_confidence).reduce(f64::min);
    let is_sure = used().next().is_some() && used().all(|view| view.shape_confidence >= SURE);
    let depths = used().map(|view| f64::from(view.summary.score.depth));
    let search = &searched[first].rounds.search;
    let uncertainty = views[first].conditioning.as_ref().map(|own| WorldUncertainty {
        scale: with_shape_error(common.sd, depths),
        rotation_deg: own.rotation.0.to_degrees(),
        rotation_axis: own.rotation.1.to_array(),
        free_axis: search.equivalence.free_axis(common.views[first].0.pose.rotation).map(|axis| axis.to_array()),
        position_m: own.position_m,
    });
    let score = used().map(|view| f64::from(view.summary.score.total)).sum();

    let world_from_mesh = views[first].summary.camera_from_mesh;
    let mut all: Vec<SummaryView> = frames.iter().map(|_| SummaryView::unseen(world_from_mesh)).collect();
    searched.iter().zip(views).for_each(|(view, judged)| all[view.index] = judged.summary);
    Ok(Summary {
        world_from_mesh,
        world: WorldFrame::Camera,
        shape_confidence,
        turn_confidence,
        is_sure,
        symmetry: search.equivalence.axes(),
        alternatives: Vec::new(),
        proportions: None,
        uncertainty,
        score,
        converged: common.views.iter().all(|(candidate, _)| candidate.converged),
        renders: common.renders + searched.iter().map(|view| view.rounds.search.renders).sum::<usize>(),
        effort: search.settings.effort,
        views: all,
    })
}

/// A view with its pose at the common size, and the verdict on it.
struct JudgedView {
    summary: SummaryView,
    /// The probability that the pose is right, by shape.
    shape_confidence: f64,
    conditioning: Option<Conditioning>,
}

/// The verdict on the pose of a view, which agrees with the common size or not. `size_sd` is the standard deviation of its
/// logarithm.
fn judged(view: &SearchedView, (candidate, agrees): &(Candidate, bool), size_sd: f64, frames: &[View]) -> JudgedView {
    let search = &view.rounds.search;
    let is_fixed = search.settings.lock_scale;
    let free = search.conditioning(&candidate.pose).0;
    let conditioning = match free {
        // The size is as certain as all views together make it.
        Some(own) if *agrees && !is_fixed => Some(Conditioning { scale: size_sd, ..own }),
        own => own,
    };

    // All are scored with the mesh as it is, at the common size or their own.
    let others = view.rounds.candidates.get(1..).unwrap_or_default();
    let likely = others.get(..RIVALS).unwrap_or(others);
    let lead = lead(&search.equivalence, candidate, likely, |other| search.score(&other.pose).total);
    let color = view.color.as_ref();
    let lead = lead.max(color.map_or(f64::NEG_INFINITY, Judgment::lead));

    let confidence = Confidence {
        shape: if *agrees { pose_probability(candidate, lead, conditioning.as_ref()) } else { 0.0 },
        color: color.map_or(1.0, |color| color.probability),
        relief_deviation: frames[view.index].frame.relief_deviation,
        turn: color.and_then(|color| color.turn),
    };
    JudgedView {
        summary: SummaryView {
            camera_from_mesh: candidate.pose.similarity(&search.mesh.frame),
            shape_confidence: confidence.up_to_symmetry(),
            turn_confidence: confidence.turn,
            role: if *agrees { ViewRole::Used } else { ViewRole::Contradicting },
            world_from_camera: Similarity::identity(),
            rotation_sd_deg: Some(0.0),
            position_sd_m: Some(0.0),
            score: candidate.score,
            color: color.map(|color| color.report),
        },
        shape_confidence: confidence.shape,
        conditioning: if is_fixed { search.conditioning_as_fixed(&candidate.pose) } else { conditioning },
    }
}

/// Places the cameras relative to that of the first view: all see the mesh in the same pose.
fn place_cameras(views: &mut [JudgedView], first: usize) {
    let world_from_mesh = views[first].summary.camera_from_mesh;
    let reference = views[first].conditioning;
    for (_, JudgedView { summary, conditioning, .. }) in views.iter_mut().enumerate().filter(|(k, _)| *k != first) {
        let relative = world_from_mesh.compose(&summary.camera_from_mesh.inverse());
        summary.world_from_camera = Similarity { scale: 1.0, ..relative };

        let sd = |part: fn(&Conditioning) -> f64| {
            let (a, b) = (reference.as_ref().map(part)?, conditioning.as_ref().map(part)?);
            Some((a * a + b * b).sqrt())
        };
        let turn = sd(|own| own.rotation.0);
        let moved = sd(|own| own.position_m);
        summary.rotation_sd_deg = turn.map(f64::to_degrees);
        summary.position_sd_m = turn.zip(moved).map(|(turn, moved)| {
            // The camera swings about the object as far as the rotation of the object is uncertain.
            let swing = turn * summary.camera_from_mesh.translation.norm();
            (moved * moved + swing * swing).sqrt()
        });
    }
}

/// The poses of a view that may be right: the one that colour chooses, or all that shape allows.
fn likely(view: &SearchedView) -> Vec<Candidate> {
    let candidates = &view.rounds.candidates;
    let best = candidates.first().map_or(0.0, |best| best.score.total);
    let tried = if view.color.as_ref().is_some_and(|color| color.is_used) { 1 } else { TRIED };
    candidates.iter().filter(|f| f.score.total > best - NEAR).take(tried).copied().collect()
}

fn best_of(candidates: impl Iterator<Item = Candidate>) -> Option<Candidate> {
    candidates.reduce(|best, next| if next.score.total > best.score.total { next } else { best })
}

fn fine(search: &Search) -> Objective<'_> {
    search.objective(FINE)
}
