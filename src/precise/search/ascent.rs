//! Levenberg-Marquardt ascent on a score that is bounded by a quadratic at every pose.

use super::ranking::{Candidate, Total};
use crate::geometry::normal_equations::{NormalEquationsOf, PARAMETERS};
use crate::precise::drawing::pose::Step;

/// A score of poses with `N` parameters to be maximised.
pub trait Ascent<const N: usize = PARAMETERS> {
    /// A pose.
    type Pose: Copy;
    /// Its score.
    type Score: Total;

    /// The pose that the prior allows.
    fn allowed(&self, pose: Self::Pose) -> Self::Pose;

    /// Renders a pose and scores it.
    fn score(&mut self, pose: &Self::Pose) -> Self::Score;

    /// The quadratic at the last render, which had this pose and this score.
    fn equations(&mut self, pose: &Self::Pose, score: &Self::Score) -> NormalEquationsOf<N>;

    /// The pose after the minimiser of the quadratic, limited to the range in which that is valid; `None` if the result
    /// is not finite.
    fn moved(&self, pose: &Self::Pose, step: [f64; N]) -> Option<Self::Pose>;
}

/// Initial damping, and its factors after an accepted and after a rejected step.
const DAMPING: [f64; 3] = [1e-3, 0.25, 6.0];
/// Damping at which steps become negligible.
const MAX_DAMPING: f64 = 10.0;
/// Smaller gains than the first threshold are no progress; if the last gain is below the second, the ascent has
/// converged.
const MIN_GAIN: f32 = 1e-5;
const CONVERGED_GAIN: f32 = 2e-3;
/// Maximum rotation, in radians, and maximum relative change of size of a step.
const MAX_TURN_RAD: f64 = 0.35;
const MAX_STRETCH: f64 = 0.25;

/// Ascends from `pose` in at most `iterations` steps.
pub fn ascend<const N: usize, A: Ascent<N>>(
    problem: &mut A,
    pose: A::Pose,
    iterations: usize,
) -> Candidate<A::Pose, A::Score> {
    let pose = problem.allowed(pose);
    let score = problem.score(&pose);
    let mut best = Candidate::of(pose, score);
    let mut equations = None;
    let mut damping = DAMPING[0];
    for _ in 0..iterations {
        // Not before a step asks for them: those at the last pose are not needed.
        let of_best = equations.get_or_insert_with(|| problem.equations(&best.pose, &best.score));
        let Some(step) = of_best.solve(damping) else { break };
        let Some(next) = problem.moved(&best.pose, step) else { break };
        let next = problem.allowed(next);
        let score = problem.score(&next);
        best.renders += 1;
        let gain = score.total() - best.score.total();
        if gain > 0.0 {
            (best.pose, best.score) = (next, score);
            best.converged = gain < CONVERGED_GAIN;
            if gain < MIN_GAIN {
                break;
            }
            equations = None;
            damping *= DAMPING[1];
        } else {
            damping = (damping * DAMPING[2]).max(DAMPING[0]);
            if damping > MAX_DAMPING {
                best.converged = true;
                break;
            }
        }
    }
    best
}

/// The step, shortened to the range in which the quadratic is valid. Components 0 to 2 are a rotation, 3 to 5 relative
/// changes of size and place.
pub fn limited(mut step: Step) -> Step {
    let turn = (step[0] * step[0] + step[1] * step[1] + step[2] * step[2]).sqrt();
    let stretch = step[3..6].iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let shorten = (MAX_TURN_RAD / turn).min(MAX_STRETCH / stretch).min(1.0);
    step.iter_mut().for_each(|x| *x *= shorten);
    step
}
