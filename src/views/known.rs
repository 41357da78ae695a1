//! Views with known camera poses: hypotheses of every view, scored and refined on the evidence of all.

use glam::DQuat;

use super::common_size::{DEPTH_ERROR, SILHOUETTE_ERROR, SizeEvidence, mean};
use super::joint::{Joint, JointScore, JointView};
use super::world_pose::{PlacedCamera, WorldPose};
use crate::precise::drawn::pose::CropPose;
use crate::precise::drawn::render::Canvas;
use crate::precise::observed::grid::CropGrid;
use crate::precise::searched::ascent::Summit;
use crate::precise::searched::ranking::{Scored, distinct};
use crate::precise::searched::recipe::{COARSE, FINE, FINEST, MIDDLE};
use crate::precise::searched::refine::Refiner;
use crate::precise::searched::search::Search;

/// Share of a view's own best score below which a pose contradicts the view, and the one that a view adds at least, so that
/// one wrong view does not move the others. The second is low: errors of the camera poses cost all views a little, and
/// must not be worth more than a pose that fits only one view.
const CONTRADICTION: f32 = 0.35;
const FLOOR: f32 = 0.25;
/// Hypotheses refined on the middle grid, and on the fine one.
const REFINED: usize = 16;
const RANKED: usize = 4;
/// Steps of the refinements on the middle, fine and finest grids.
const STEPS: [usize; 3] = [6, 12, 8];
/// Angle between distinct hypotheses before and after their first refinement, radians.
const APART: [f64; 2] = [0.21, 0.105];
/// Score per view below the best pose at which a turn of it is not ranked.
const NEAR: f32 = 0.3;

/// A view that takes part.
#[derive(Clone, Copy)]
pub struct Part<'a> {
    /// Its index in the input.
    pub index: usize,
    /// Its search.
    pub search: &'a Search,
    /// Its camera.
    pub camera: PlacedCamera,
    /// The best pose that a search of this view alone has found.
    pub own: Option<CropPose>,
}

/// A world pose and its score in all views, on the fine grid.
#[derive(Clone)]
pub struct Ranked {
    /// The pose.
    pub pose: WorldPose,
    /// Its score.
    pub score: JointScore,
    /// Whether its refinement converged.
    pub converged: bool,
}

/// The best poses for all views, best first, and the number of poses that were rendered in each.
pub fn join(parts: &[Part<'_>], hypotheses: &[WorldPose], lock_scale: bool) -> (Vec<Ranked>, usize) {
    let mut renders = 0;
    // Every hypothesis, coarsely.
    let grids = grids(parts, COARSE);
    let mut joint = level(parts, &grids, COARSE, lock_scale);
    let scored = hypotheses.iter().map(|&pose| Hypothesis { pose, total: joint.score(&pose).total });
    let kept = distinct(scored.collect(), REFINED, APART[0]);
    renders += hypotheses.len();

    let grids = self::grids(parts, MIDDLE);
    let mut joint = level(parts, &grids, MIDDLE, lock_scale);
    let mut refine = |poses: &mut dyn Iterator<Item = WorldPose>| -> Vec<Hypothesis> {
        let summits = poses.map(|pose| joint.refine(pose, STEPS[0]));
        summits.inspect(|s| renders += s.renders).map(|s| Hypothesis { pose: s.pose, total: s.score.total }).collect()
    };
    let mut kept = distinct(refine(&mut kept.iter().map(|k| k.pose)), RANKED, APART[1]);
    if let Some(best) = kept.first().copied() {
        let turned = refine(&mut turns(parts, &best.pose).into_iter());
        let least = best.total - NEAR * parts.len() as f32;
        let alike = turned.into_iter().filter(|turned| turned.total > least).collect();
        kept.extend(distinct(alike, RANKED, APART[1]));
    }

    let ranked = rank(parts, &kept.iter().map(|k| k.pose).collect::<Vec<_>>(), lock_scale, &mut renders);
    (ranked, renders)
}

/// Refines poses on the fine grid, and the best of them on the finest.
pub fn rank(parts: &[Part<'_>], poses: &[WorldPose], lock_scale: bool, renders: &mut usize) -> Vec<Ranked> {
    let grids = grids(parts, FINE);
    let mut joint = level(parts, &grids, FINE, lock_scale);
    let mut refined: Vec<Ranked> = Vec::new();
    for pose in poses {
        let Summit { pose, score, renders: count, converged } = joint.refine(*pose, STEPS[1]);
        *renders += count;
        refined.push(Ranked { pose, score, converged });
    }
    let order =
        (0..refined.len()).map(|index| Place { index, pose: refined[index].pose, total: refined[index].score.total });
    let order = distinct(order.collect(), usize::MAX, APART[1]);
    let mut ranked: Vec<Ranked> = order.into_iter().map(|place| refined[place.index].clone()).collect();
    if let Some(best) = ranked.first_mut() {
        let grids = self::grids(parts, FINEST);
        let polished = level(parts, &grids, FINEST, lock_scale).refine(best.pose, STEPS[2]);
        *renders += polished.renders;
        best.pose = polished.pose;
    }
    ranked
}

/// Whether a view, with this score, contradicts the pose.
pub fn contradicts(part: &Part<'_>, score: f32) -> bool {
    let own = part.own.map_or(0.0, |own| part.search.score(&own).total);
    score <= CONTRADICTION * own
}

/// The joint objective on the fine grid, for the final numbers.
pub fn on_fine_grids<'a>(parts: &[Part<'a>], lock_scale: bool) -> Joint<'a> {
    let views = parts.iter().map(|part| JointView {
        objective: part.search.objective(FINE, &part.search.fine),
        camera: part.camera,
        floor: 0.0,
    });
    Joint::new(views.collect(), lock_scale)
}

/// The pose at the size on which silhouettes and depths agree best, and the standard deviation of that size.
pub fn with_fused_size(parts: &[Part<'_>], pose: WorldPose, renders: &mut usize) -> Option<(WorldPose, f64)> {
    let mut joint = on_fine_grids(parts, false);
    let (size, moved) = SizeEvidence::fused(&mut joint, &pose, [SILHOUETTE_ERROR, DEPTH_ERROR])?;
    // Each view by itself, where its own evidence puts the object: that does not depend on errors of the camera poses.
    let mut canvas = Canvas::default();
    let (mut views, mut apart) = (Vec::new(), 0.0);
    for view in &joint.views {
        let Some(seen) = view.camera.see(&moved) else { continue };
        let alone = Refiner { objective: view.objective, lock_scale: true }.refine(&mut canvas, seen, STEPS[1]);
        *renders += alone.renders;
        apart += view.camera.place(&alone.pose).center.distance_squared(moved.center);
        views.extend(SizeEvidence::at(view.objective, &alone.pose, SILHOUETTE_ERROR));
    }
    // What the cameras are off, the distances between the sides that they see are off.
    let apart = (apart / joint.views.len().max(1) as f64).sqrt() * libm::exp(-moved.log_scale);
    let size = size.with_error(apart);
    let (log_scale, sd) = match mean(views.into_iter()) {
        Some((log_scale, sd)) => mean([size, SizeEvidence { log_scale, sd, ..size }].into_iter())?,
        None => (size.log_scale, size.sd),
    };
    joint.lock_scale = true;
    let refined = joint.refine(WorldPose { log_scale, ..moved }, STEPS[1]);
    *renders += refined.renders;
    // Not less than either: both see the same images.
    Some((refined.pose, sd.max(size.sd.min(core::f64::consts::SQRT_2 * sd))))
}

/// The grids of all views.
pub fn grids(parts: &[Part<'_>], index: usize) -> Vec<CropGrid> {
    parts.iter().map(|part| part.search.grid(index)).collect()
}

/// The joint objective on the grids with this index.
pub fn level<'a>(parts: &[Part<'a>], grids: &'a [CropGrid], index: usize, lock_scale: bool) -> Joint<'a> {
    let views = parts.iter().zip(grids).map(|(part, grid)| JointView {
        objective: part.search.objective(index, grid),
        camera: part.camera,
        floor: 0.0,
    });
    let mut joint = Joint::new(views.collect(), lock_scale);
    if parts.len() > 1 {
        for (i, part) in parts.iter().enumerate() {
            let own = part.own.map_or(0.0, |own| joint.score(&part.camera.place(&own)).views[i].total);
            joint.views[i].floor = FLOOR * own;
        }
    }
    joint
}

/// The half and quarter turns of a pose, about the axes of the mesh and the first line of sight.
fn turns(parts: &[Part<'_>], pose: &WorldPose) -> Vec<WorldPose> {
    let seen = parts.iter().find_map(|part| Some((part, part.camera.see(pose)?)));
    let Some((part, seen)) = seen else { return Vec::new() };
    part.search.mesh.turns.of(&seen).iter().map(|turned| part.camera.place(turned)).collect()
}

/// A pose with a total.
#[derive(Clone, Copy)]
pub struct Hypothesis {
    /// The pose.
    pub pose: WorldPose,
    /// Its score, of all views.
    pub total: f32,
}

impl Scored for Hypothesis {
    fn rotation(&self) -> DQuat {
        self.pose.rotation
    }

    fn total(&self) -> f32 {
        self.total
    }
}

/// A ranked pose by its index.
#[derive(Clone, Copy)]
struct Place {
    index: usize,
    pose: WorldPose,
    total: f32,
}

impl Scored for Place {
    fn rotation(&self) -> DQuat {
        self.pose.rotation
    }

    fn total(&self) -> f32 {
        self.total
    }
}
