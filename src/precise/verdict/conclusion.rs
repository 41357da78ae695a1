//! Verdict: the best pose of a search, and how reliable it is.

use std::borrow::Cow;

use glam::DQuat;

use super::alternatives::{UNSURE_MAX_SCORE_LOSS, add_rivals, alternatives};
use super::color::Judgment;
use super::confidence::{Confidence, shape_confidence};
use crate::error::Result;
use crate::precise::no_candidate;
use crate::precise::scoring::conditioning::Conditioning;
use crate::precise::scoring::score::NOISE;
use crate::precise::search::problem::Search;
use crate::precise::search::ranking::Candidate;
use crate::precise::search::recipe::SURE;
use crate::precise::search::rounds::Rounds;
use crate::report::{Alternative, ColorReport, Effort, ScoreTerms, Solution, Uncertainty};

/// The verdict on the best pose of a search.
pub struct Verdict {
    /// The confidence in it, without the calibration of the depth.
    pub confidence: Confidence,
    /// Alternative poses.
    pub alternatives: Vec<Alternative>,
    /// The uncertainty of each part of the pose.
    pub uncertainty: Option<Uncertainty>,
    /// The score of the pose.
    pub score: f64,
    /// The terms of the score.
    pub terms: ScoreTerms,
    /// The effort of the search that found the pose.
    pub effort: Effort,
    /// The contribution of colour, if mesh and photo have any.
    pub color: Option<ColorReport>,
}

/// The confidence in the best of several poses, and its alternatives.
pub struct Reliability {
    /// The confidence in the pose, without the calibration of the depth.
    pub confidence: Confidence,
    /// Other poses that explain the evidence nearly as well.
    pub alternatives: Vec<Alternative>,
}

/// The reliability of the first of these poses. `conditioning` is how sharply the images determine it.
///
/// # Errors
/// [`NoConsensus`](crate::error::ErrorCode::NoConsensus) without a pose.
pub fn reliability(
    candidates: &[Candidate],
    color: Option<&Judgment>,
    conditioning: Option<&Conditioning>,
    search: &Search,
) -> Result<Reliability> {
    let best = candidates.first().ok_or_else(no_candidate)?;
    let listed = |margin: f32, with_turns: bool| {
        let mut list = alternatives(candidates, search, margin);
        let rivals = color.iter().flat_map(|color| &color.rivals).filter(|rival| with_turns || !rival.is_turn);
        add_rivals(&mut list, best, rivals, search);
        list
    };
    let confidence = Confidence {
        shape: shape_confidence(best, &listed(NOISE, false), conditioning),
        color: color.map_or(1.0, |color| color.probability),
        relief_deviation: 0.0,
        turn: color.and_then(|color| color.turn),
    };
    let alternatives = listed(if confidence.up_to_symmetry() < SURE { UNSURE_MAX_SCORE_LOSS } else { NOISE }, true);
    Ok(Reliability { confidence, alternatives })
}

/// The best pose of the search, or the one that colour chose, and its reliability. Of poses that symmetry and colour leave equal,
/// the one nearest to `reference` counts, if there is one.
///
/// # Errors
/// [`NoConsensus`](crate::error::ErrorCode::NoConsensus) if no pose overlaps the mask.
pub fn conclude(rounds: &Rounds, color: Option<&Judgment>, reference: Option<DQuat>) -> Result<(Solution, Verdict)> {
    let search = &rounds.search;
    let mut candidates = Cow::Borrowed(&rounds.candidates);
    if let Some(chosen) = color.and_then(|color| color.chosen) {
        candidates.to_mut().insert(0, chosen);
    }
    candidates.first().filter(|best| best.pose.is_finite()).ok_or_else(no_candidate)?;
    if color.is_none_or(|color| color.turn.is_none())
        && let Some(pose) = reference.and_then(|reference| search.canonical(&candidates[0], reference))
    {
        candidates.to_mut()[0].pose = pose;
    }
    let best = &candidates[0];
    let (conditioning, residual_m) = search.conditioning(&best.pose);
    let solution = Solution {
        camera_from_mesh: best.pose.similarity(&search.mesh.frame),
        clamped: search.is_at_bound(&best.pose),
        converged: best.converged,
        residual_m,
    };
    // The confidence is fitted to how sharply the image determines a pose. The ground makes every pose sharp, right or
    // wrong; it is evidence of which of several poses is the better one.
    let by_image = if search.has_scene_term() { search.conditioning_by_image(&best.pose) } else { conditioning };
    let as_fixed = if search.settings.lock_scale { search.conditioning_as_fixed(&best.pose) } else { conditioning };
    let as_fixed = as_fixed.map(|own| own.with_misfit(&best.score));
    let Reliability { confidence, alternatives } = reliability(&candidates, color, by_image.as_ref(), search)?;
    let verdict = Verdict {
        confidence,
        alternatives,
        uncertainty: as_fixed.map(|c| Uncertainty {
            scale: c.scale,
            rotation_deg: c.rotation.0.to_degrees(),
            rotation_axis: c.rotation.1.to_array(),
            free_axis: search.equivalence.free_axis(best.pose.rotation).map(|axis| axis.to_array()),
            lateral_m: c.lateral_m,
            distance_m: c.distance_m,
        }),
        score: f64::from(best.score.total),
        terms: (&best.score).into(),
        effort: search.settings.effort,
        color: color.map(|color| color.report),
    };
    Ok((solution, verdict))
}
