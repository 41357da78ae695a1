//! The result of views with known camera poses: the best pose, which views it rests on, and how certain it is.

use std::rc::Rc;

use super::View;
use super::by_color::Photos;
use super::joint::JointScore;
use super::known::{Part, Ranked, contradicts, join, on_fine_grids, rank, with_fused_size};
use super::predicted_mask::with_predicted_mask;
use super::report::{ViewRole, WorldFrame, WorldUncertainty};
use super::searched_view::SearchedView;
use super::summary::{Summary, SummaryView};
use super::world_pose::{PlacedCamera, WorldPose};
use crate::error::Result;
use crate::geometry::normal_equations::NormalEquations;
use crate::geometry::similarity::Similarity;
use crate::precise::drawn::pose::MeshFrame;
use crate::precise::drawn::prepared_mesh::PreparedMesh;
use crate::precise::judged::alternatives::{add_rivals, alternatives};
use crate::precise::judged::color::{Judgment, cells};
use crate::precise::judged::confidence::confidence;
use crate::precise::no_candidate;
use crate::precise::observed::clean::CleanObservation;
use crate::precise::scored::appearance::PhotoCells;
use crate::precise::scored::conditioning::{Conditioning, covariance, deviation, hold_roll, widest};
use crate::precise::scored::score::{NOISE, Score};
use crate::precise::searched::recipe::SURE;
use crate::precise::searched::search::{Found, Search};
use crate::report::{Alternative, Sim3};

/// Times that the mask of a view without one is predicted.
const PREDICTIONS: usize = 2;

/// The result on the evidence of all views.
///
/// # Errors
/// [`NoConsensus`](crate::error::ErrorCode::NoConsensus) if no pose is in front of a camera and overlaps a mask.
pub fn in_world(searched: &[SearchedView], views: &[View], mesh: &PreparedMesh<'_>) -> Result<Summary> {
    let lock_scale = searched.first().is_some_and(|view| view.search().settings.lock_scale);
    let cameras: Vec<PlacedCamera> = views.iter().map(camera).collect();
    let own = |view: &SearchedView| view.found().first().map(|found| found.pose);
    let parts: Vec<Part<'_>> = searched
        .iter()
        .map(|view| Part { index: view.index, search: view.search(), camera: view.camera, own: own(view) })
        .collect();
    let hypotheses: Vec<WorldPose> = searched
        .iter()
        .flat_map(|view| {
            let poses = view.found().iter().map(|found| found.pose).chain(view.candidates.iter().copied());
            poses.map(|pose| view.camera.place(&pose))
        })
        .collect();
    let (mut ranked, mut renders) = join(&parts, &hypotheses, lock_scale);
    renders += searched.iter().map(|view| view.search().renders).sum::<usize>();

    // The views that the best pose contradicts are left out.
    let best = ranked.first().ok_or_else(no_candidate)?;
    let mut roles = vec![ViewRole::Blind; views.len()];
    let mut used: Vec<Part<'_>> = Vec::new();
    for ((part, view), score) in parts.iter().zip(searched).zip(&best.score.views) {
        let is_used = parts.len() == 1 || !contradicts(part, score.total);
        roles[view.index] = if is_used { ViewRole::Used } else { ViewRole::Contradicting };
        used.extend(is_used.then_some(*part));
    }
    if used.len() < parts.len() {
        ranked = rank(&used, &poses(&ranked), lock_scale, &mut renders);
    }

    // Views without a mask: it follows from the pose, and the pose from it.
    let mut unmasked: Vec<(usize, Search)> = Vec::new();
    for _ in 0..PREDICTIONS {
        let Some(best) = ranked.first() else { break };
        if used.is_empty() || views.iter().all(|view| view.frame.mask.is_some()) {
            break;
        }
        unmasked = predicted(&best.pose, views, &cameras, used[0].search);
        let mut all = used.clone();
        all.extend(unmasked.iter().map(|(k, search)| Part { index: *k, search, camera: cameras[*k], own: None }));
        ranked = rank(&all, &poses(&ranked), lock_scale, &mut renders);
    }
    for (k, search) in &unmasked {
        roles[*k] = ViewRole::Used;
        used.push(Part { index: *k, search, camera: cameras[*k], own: None });
    }
    let mut fused = None;
    if let Some(best) = ranked.first_mut()
        && used.len() > 1
        && !lock_scale
        && let Some((pose, sd)) = with_fused_size(&used, best.pose, &mut renders)
    {
        best.pose = pose;
        fused = Some(sd);
    }
    let mut joint = on_fine_grids(&used, lock_scale);
    let mut held = |best: &Ranked| {
        let score = joint.score(&best.pose);
        let mut equations = joint.equations(&best.pose, &score);
        let free_axis = used.first().and_then(|part| part.search.equivalence.free_axis(best.pose.rotation));
        free_axis.into_iter().for_each(|axis| hold_roll(&mut equations, axis));
        let held = conditioning(&equations, &best.pose)
            .map(|held| Conditioning { scale: fused.unwrap_or(held.scale), ..held });
        (score, held)
    };
    let (mut score, mut conditioning) = held(ranked.first().ok_or_else(no_candidate)?);
    let is_size_known = lock_scale || fused.is_some();
    let judged = by_color(&used, views, mesh, (&ranked, conditioning.as_ref()), is_size_known, &mut renders);
    if let Some((_, Some(chosen))) = &judged {
        (score, conditioning) = held(chosen);
        ranked.insert(0, chosen.clone());
    }
    let color = judged.map(|(judgment, _)| judgment);
    let (Some(best), Some(first)) = (ranked.first(), used.first()) else { return Err(no_candidate()) };
    let mut others = other_poses(&ranked, first);
    let sum = Found {
        pose: first.camera.see(&best.pose).ok_or_else(no_candidate)?,
        score: mean_score(&score, best.score.total),
        converged: best.converged,
        renders: 0,
    };
    let rivals = |are_turns: bool| {
        let all = color.iter().flat_map(|color| &color.rivals);
        all.filter(move |rival| rival.is_turn == are_turns)
    };
    add_rivals(&mut others, &sum, rivals(false), first.search);
    let by_shape = confidence(&sum, &others, conditioning.as_ref());
    // Turns that the symmetry of the shape makes equivalent are alternatives only if colour tells them apart.
    if color.as_ref().is_some_and(|color| color.is_used) {
        add_rivals(&mut others, &sum, rivals(true), first.search);
    }
    let confidence = by_shape * color.as_ref().map_or(1.0, |color| color.certainty);
    let world_from_mesh = best.pose.similarity(&first.search.mesh.frame);
    let shown = |k: usize| {
        let part = parts.iter().zip(searched).find(|(_, view)| view.index == k).map(|(part, _)| *part);
        let part = part.or_else(|| {
            let (_, search) = unmasked.iter().find(|(index, _)| *index == k)?;
            Some(Part { index: k, search, camera: cameras[k], own: None })
        })?;
        Some(part.search.score(&part.camera.see(&best.pose)?))
    };
    let views = (0..views.len())
        .map(|k| {
            let world_from_camera = cameras[k].world_from_camera();
            SummaryView {
                camera_from_mesh: world_from_camera.inverse().compose(&world_from_mesh),
                confidence,
                role: roles[k],
                world_from_camera,
                rotation_sd_deg: Some(0.0),
                position_sd_m: Some(0.0),
                score: shown(k).unwrap_or_default(),
                color: color.as_ref().filter(|_| views[k].frame.photo.is_some()).map(|color| color.report),
            }
        })
        .collect();
    Ok(Summary {
        world_from_mesh,
        world: WorldFrame::Given,
        confidence,
        is_sure: by_shape >= SURE,
        alternatives: others.into_iter().map(|other| moved(other, &first.camera.world_from_camera())).collect(),
        uncertainty: conditioning.map(|held| WorldUncertainty {
            scale: held.scale,
            rotation_deg: held.rotation.0.to_degrees(),
            rotation_axis: held.rotation.1.to_array(),
            free_axis: first.search.equivalence.free_axis(best.pose.rotation).map(|axis| axis.to_array()),
            position_m: held.lateral_m,
        }),
        views,
        score: f64::from(best.score.total),
        converged: best.converged,
        renders,
        effort: first.search.settings.effort,
    })
}

/// What colour says of the best pose; `None` without colours.
fn by_color(
    used: &[Part<'_>],
    views: &[View],
    mesh: &PreparedMesh<'_>,
    (ranked, conditioning): (&[Ranked], Option<&Conditioning>),
    lock_scale: bool,
    renders: &mut usize,
) -> Option<(Judgment, Option<Ranked>)> {
    let colors = mesh.colors()?;
    let photo = |part: &Part<'_>| views[part.index].frame.photo.as_ref().map(|photo| cells(photo, part.search));
    let photos: Vec<Option<PhotoCells>> = used.iter().map(photo).collect();
    photos.iter().flatten().next()?;
    Photos { parts: used, photos: &photos, colors }.judge(ranked, conditioning, lock_scale, renders)
}

fn camera(view: &View) -> PlacedCamera {
    view.world_from_camera.as_ref().map_or(PlacedCamera::AT_ORIGIN, PlacedCamera::of)
}

fn poses(ranked: &[Ranked]) -> Vec<WorldPose> {
    ranked.iter().map(|ranked| ranked.pose).collect()
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
        let frame = with_predicted_mask(&view.frame, &mesh.fine, &camera_from_frame);
        let Ok(Some(observation)) = frame.observation() else { continue };
        let mut search = Search::new(Rc::new(CleanObservation::new(&observation)), mesh.clone(), like.settings);
        search.assume(like.prior);
        search.equivalence = like.equivalence.clone();
        if search.fine.mask_cells > 0 {
            evidence.push((k, search));
        }
    }
    evidence
}

/// The conditioning of a world pose; its positions are those of the centre of the mesh along the least determined axis.
fn conditioning(equations: &NormalEquations, pose: &WorldPose) -> Option<Conditioning> {
    let covariance = covariance(equations)?;
    let rotation = widest(&covariance, 0);
    let position_m = libm::exp(pose.log_scale) * widest(&covariance, 4).0;
    Some(Conditioning { scale: deviation(covariance[3][3]), rotation, lateral_m: position_m, distance_m: position_m })
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

/// The poses nearly as good as the best one, in the camera of the first view.
fn other_poses(ranked: &[Ranked], first: &Part<'_>) -> Vec<Alternative> {
    let found = ranked.iter().filter_map(|ranked| {
        let score = Score { total: ranked.score.total, ..Score::default() };
        Some(Found { pose: first.camera.see(&ranked.pose)?, score, converged: ranked.converged, renders: 0 })
    });
    alternatives(&found.collect::<Vec<_>>(), first.search, NOISE)
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
