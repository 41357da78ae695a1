//! Ranking: the best candidates, and the best distinct ones.

use glam::DQuat;

use crate::geometry::order;
use crate::precise::drawn::equivalence::Equivalence;

/// A pose with a score.
pub trait Scored: Copy {
    /// R.
    fn rotation(&self) -> DQuat;
    /// The score.
    fn total(&self) -> f32;
}

/// The best `count` candidates, best first.
pub fn best_of<T: Scored>(candidates: &[T], count: usize) -> Vec<T> {
    let best = order::largest(candidates.iter().map(T::total), count);
    best.into_iter().map(|i| candidates[i as usize]).collect()
}

/// The best `count` candidates whose rotations differ by at least `angle`, best first.
pub fn distinct<T: Scored>(candidates: Vec<T>, count: usize, angle: f64) -> Vec<T> {
    distinct_up_to(&Equivalence::default(), candidates, count, angle)
}

/// The same, where a symmetry makes some rotations one.
pub fn distinct_up_to<T: Scored>(equivalence: &Equivalence, candidates: Vec<T>, count: usize, angle: f64) -> Vec<T> {
    let mut kept: Vec<T> = Vec::new();
    for candidate in best_of(&candidates, candidates.len()) {
        if kept.len() >= count {
            break;
        }
        let turn = |k: &T| equivalence.angle(k.rotation(), candidate.rotation());
        if kept.iter().all(|k| turn(k) > angle) {
            kept.push(candidate);
        }
    }
    kept
}
