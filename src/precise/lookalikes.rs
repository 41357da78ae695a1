//! Lookalikes: poses that turn the best one such that its shape in the image hardly changes.

use glam::DQuat;

use super::coarse::Candidate;
use super::pose::CropPose;
use super::ranking::{Scored, best_of};
use super::recipe::COARSE;
use super::render::Canvas;
use super::rounds::Rounds;
use crate::geometry::rotations::angle_between;

/// Number of rolls about each principal axis, and of each half turn followed by a roll.
pub const ROLLS: usize = 24;
/// Minimum rotation between lookalikes, radians: of those whose score is that of the best pose, such as rolls of a can,
/// and of the others, which are refined.
const APART: [f64; 2] = [0.2, 0.45];
/// Maximum number of lookalikes.
const MOST: usize = 60;
/// Score on the coarse grid below that of the best pose at which a turn is no lookalike, and down to which it needs no
/// refinement.
const FAR: f32 = 0.25;
const SAME: f32 = 0.02;

/// A pose that may explain the shape as well as the best one.
#[derive(Debug, Clone, Copy)]
pub struct Lookalike<P> {
    /// The pose.
    pub pose: P,
    /// Whether its shape differs so much that it should be refined.
    pub is_rough: bool,
}

/// The turns of the best pose that look about the same, and the other poses that the search has found.
pub fn lookalikes(rounds: &Rounds) -> Vec<Lookalike<CropPose>> {
    let search = &rounds.search;
    let Some((best, others)) = rounds.found.split_first() else { return Vec::new() };
    let mut canvas = Canvas::default();
    let grid = search.grid(COARSE);
    let objective = search.objective(COARSE, &grid);
    let score = objective.score(&mut canvas, &best.pose).total;
    let turned = search.mesh.turns.about_axes(&best.pose, ROLLS);
    let poses = others.iter().map(|other| other.pose).chain(turned);
    let scored = poses.map(|pose| Candidate { score: objective.score(&mut canvas, &pose), pose });
    let alike = among(best.pose.rotation, score, scored);
    alike.into_iter().map(|Lookalike { pose, is_rough }| Lookalike { pose: pose.pose, is_rough }).collect()
}

/// Those of `poses` that look about like the best one, whose rotation and score are given. The scores are those of the
/// coarse grid, the mean of all views.
pub fn among<P: Scored>(best: DQuat, score: f32, poses: impl Iterator<Item = P>) -> Vec<Lookalike<P>> {
    let likely: Vec<P> = poses.filter(|pose| pose.total() > score - FAR).collect();
    let mut kept: Vec<DQuat> = vec![best];
    let mut alike = Vec::new();
    let likely = best_of(&likely, likely.len());
    for (apart, is_rough) in APART.into_iter().zip([false, true]) {
        for &pose in &likely {
            let is_near = |other: &DQuat| angle_between(*other, pose.rotation()) < apart;
            if (pose.total() < score - SAME) == is_rough && kept.len() <= MOST && !kept.iter().any(is_near) {
                kept.push(pose.rotation());
                alike.push(Lookalike { pose, is_rough });
            }
        }
    }
    alike
}
