//! Ranking: the best candidates, and the best distinct ones.

use glam::DQuat;
use serde::{Deserialize, Serialize};

use crate::geometry::order;
use crate::precise::drawing::equivalence::Equivalence;
use crate::precise::drawing::pose::CropPose;
use crate::precise::scoring::score::Score;

/// A pose, of which only the rotation is compared.
pub trait Posed: Copy {
    /// R.
    fn rotation(&self) -> DQuat;
}

/// A score with one number to maximise.
pub trait Total: Clone {
    /// The number.
    fn total(&self) -> f32;
}

impl Posed for CropPose {
    fn rotation(&self) -> DQuat {
        self.rotation
    }
}

impl Total for Score {
    fn total(&self) -> f32 {
        self.total
    }
}

impl Total for f32 {
    fn total(&self) -> f32 {
        *self
    }
}

/// A candidate: a pose and its score, finally on the fine grid.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Candidate<P = CropPose, S = Score> {
    /// The pose.
    pub pose: P,
    /// Its score.
    pub score: S,
    /// Number of renders for it.
    pub renders: usize,
    /// Whether its refinement converged: the last step hardly increased the score, or no step would.
    pub converged: bool,
}

impl<P, S> Candidate<P, S> {
    /// A pose that was scored as it is.
    pub fn of(pose: P, score: S) -> Self {
        Self { pose, score, renders: 1, converged: false }
    }
}

/// The best `count` of these, best first.
pub fn best_of<P: Posed, S: Total>(candidates: &[Candidate<P, S>], count: usize) -> Vec<Candidate<P, S>> {
    let best = order::largest(candidates.iter().map(|candidate| candidate.score.total()), count);
    best.into_iter().map(|i| candidates[i as usize].clone()).collect()
}

/// The best `count` of these whose rotations differ by at least `angle`, best first.
pub fn distinct<P: Posed, S: Total>(
    candidates: Vec<Candidate<P, S>>,
    count: usize,
    angle: f64,
) -> Vec<Candidate<P, S>> {
    distinct_up_to(&Equivalence::default(), candidates, count, angle)
}

/// The same, where a symmetry makes some rotations one.
pub fn distinct_up_to<P: Posed, S: Total>(
    equivalence: &Equivalence,
    candidates: Vec<Candidate<P, S>>,
    count: usize,
    angle: f64,
) -> Vec<Candidate<P, S>> {
    let mut kept: Vec<Candidate<P, S>> = Vec::new();
    for next in best_of(&candidates, candidates.len()) {
        if kept.len() >= count {
            break;
        }
        let turn = |k: &Candidate<P, S>| equivalence.angle(k.pose.rotation(), next.pose.rotation());
        if kept.iter().all(|k| turn(k) > angle) {
            kept.push(next);
        }
    }
    kept
}
