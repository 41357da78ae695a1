//! Lookalikes: poses that turn the best one such that its shape in the image hardly changes.

use glam::DQuat;

use crate::geometry::rotations::angle_between;
use crate::precise::drawing::pose::CropPose;
use crate::precise::drawing::render::Canvas;
use crate::precise::search::ranking::{Candidate, Posed, Total, best_of};
use crate::precise::search::recipe::COARSE;
use crate::precise::search::rounds::Rounds;

/// Number of rolls about each principal axis, and of each half turn followed by a roll.
pub const ROLLS: usize = 24;
/// Minimum rotation between lookalikes, radians: of those whose score is that of the best pose, such as rolls of a can,
/// and of the others, which are refined.
const MIN_TURNS_RAD: [f64; 2] = [0.2, 0.45];
/// Maximum number of lookalikes.
const MAX_LOOKALIKES: usize = 60;
/// Score on the coarse grid below that of the best pose at which a turn is no lookalike, and down to which it needs no
/// refinement.
const LOOKALIKE_MAX_SCORE_LOSS: f32 = 0.25;
const REFINED_MIN_SCORE_LOSS: f32 = 0.02;

/// The kind of likeness between a lookalike and the best pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Likeness {
    /// A symmetry of the mesh makes them equivalent.
    Equal,
    /// Their scores are about the same.
    Same,
    /// Their scores differ so much that it should be refined.
    Rough,
}

/// A pose that may explain the shape as well as the best one.
#[derive(Debug, Clone, Copy)]
pub struct Lookalike<P> {
    /// The pose.
    pub pose: P,
    /// The kind of likeness to the best pose.
    pub likeness: Likeness,
}

/// The turns of the best pose that look about the same, and the other poses that the search has found.
pub fn lookalikes(rounds: &Rounds) -> Vec<Lookalike<CropPose>> {
    let search = &rounds.search;
    let Some((best, others)) = rounds.candidates.split_first() else { return Vec::new() };
    let mut canvas = Canvas::default();
    let objective = search.objective(COARSE);
    let score = objective.score(&mut canvas, &best.pose).total;
    let turns = &search.mesh.turns;
    let turned = turns.about_axes(&best.pose, ROLLS);
    let poses = others.iter().map(|other| other.pose).chain(turned);
    let scored = poses.map(|pose| Candidate::of(pose, objective.score(&mut canvas, &pose)));
    let equal = search.equivalence.others(best.pose.rotation, ROLLS);
    let equal = equal.into_iter().map(|rotation| turns.turned(&best.pose, rotation));
    among(best.pose.rotation, score, scored, equal)
}

/// Those of `scored` that look about like the best one, whose rotation and score are given, after those that are equivalent
/// to it. The scores are those of the coarse grid, the mean of all views.
pub fn among<P: Posed, S: Total>(
    best: DQuat,
    score: f32,
    scored: impl Iterator<Item = Candidate<P, S>>,
    equal: impl Iterator<Item = P>,
) -> Vec<Lookalike<P>> {
    let likely: Vec<Candidate<P, S>> =
        scored.filter(|pose| pose.score.total() > score - LOOKALIKE_MAX_SCORE_LOSS).collect();
    let mut alike: Vec<Lookalike<P>> = equal.map(|pose| Lookalike { pose, likeness: Likeness::Equal }).collect();
    let mut kept: Vec<DQuat> = vec![best];
    kept.extend(alike.iter().map(|equal| equal.pose.rotation()));
    let likely = best_of(&likely, likely.len());
    for (apart, likeness) in MIN_TURNS_RAD.into_iter().zip([Likeness::Same, Likeness::Rough]) {
        for pose in &likely {
            let is_near = |other: &DQuat| angle_between(*other, pose.pose.rotation()) < apart;
            let is_rough = pose.score.total() < score - REFINED_MIN_SCORE_LOSS;
            if is_rough == (likeness == Likeness::Rough) && kept.len() <= MAX_LOOKALIKES && !kept.iter().any(is_near) {
                kept.push(pose.pose.rotation());
                alike.push(Lookalike { pose: pose.pose, likeness });
            }
        }
    }
    alike
}
