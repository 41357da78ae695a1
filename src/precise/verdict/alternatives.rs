//! Alternative poses that explain an observation as well, such as flips, without equivalent placements.

use super::color::Rival;
use crate::geometry::rotations::angle_between;
use crate::precise::drawing::equivalence::{DISTINCT_MIN_ANGLE_RAD, Equivalence};
use crate::precise::scoring::score::NOISE;
use crate::precise::search::problem::Search;
use crate::precise::search::ranking::Candidate;
use crate::report::Alternative;

/// Score below an unsure best pose down to which poses are alternatives: where such a pose is wrong, the right one scores lower
/// by up to this much.
pub(crate) const UNSURE_MAX_SCORE_LOSS: f32 = 3.0 * NOISE;
/// Maximum number of alternatives of another shape score than the best pose.
const MAX_ALTERNATIVES: usize = 12;
/// Maximum number of alternatives that only their colours tell from the best pose, and the margin from which on colour has
/// refuted them.
const MAX_RIVALS: usize = 4;
const REFUTED_COLOR_MARGIN: f64 = 0.5;

/// The poses after the first whose scores are within `margin` of it. Poses near it or near each other, and those that the
/// symmetry of the mesh makes equivalent, are excluded.
pub(crate) fn alternatives(candidates: &[Candidate], search: &Search, margin: f32) -> Vec<Alternative> {
    let Some((best, others)) = candidates.split_first() else { return Vec::new() };
    let mut kept = vec![best];
    for other in others.iter().filter(|other| other.score.total > best.score.total - margin) {
        let differs =
            |k: &&Candidate| search.equivalence.angle(k.pose.rotation, other.pose.rotation) > DISTINCT_MIN_ANGLE_RAD;
        if kept.len() <= MAX_ALTERNATIVES && kept.iter().all(differs) {
            kept.push(other);
        }
    }
    kept.iter().skip(1).map(|other| alternative(best, other, None, search)).collect()
}

/// A pose as an alternative to the best one.
fn alternative(best: &Candidate, other: &Candidate, color_margin: Option<f64>, search: &Search) -> Alternative {
    Alternative {
        camera_from_mesh: (&other.pose.similarity(&search.mesh.frame)).into(),
        score: f64::from(other.score.total),
        turn_deg: angle_between(best.pose.rotation, other.pose.rotation).to_degrees(),
        color_margin,
    }
}

/// Tells the alternatives how well their colours agree with the photo, and adds poses that look different, though their
/// shape does not.
pub(crate) fn add_rivals<'a>(
    alternatives: &mut Vec<Alternative>,
    best: &Candidate,
    rivals: impl IntoIterator<Item = &'a Rival>,
    search: &Search,
) {
    let rotation = |other: &Alternative| glam::DQuat::from_array(other.camera_from_mesh.rotation);
    let mut added = 0;
    for rival in rivals {
        let near = |other: &&mut Alternative| {
            angle_between(rotation(other), rival.candidate.pose.rotation) < DISTINCT_MIN_ANGLE_RAD
        };
        match alternatives.iter_mut().find(near) {
            Some(known) => {
                known.color_margin.get_or_insert(rival.margin);
            }
            None if added < MAX_RIVALS && rival.margin < REFUTED_COLOR_MARGIN => {
                added += 1;
                alternatives.push(alternative(best, &rival.candidate, Some(rival.margin), search));
            }
            None => {}
        }
    }
}

/// The lead of a pose over the best of the others that is different, in units of the score, at most [`NOISE`]. `score`
/// gives the scores to be compared.
pub fn lead(
    equivalence: &Equivalence,
    best: &Candidate,
    others: &[Candidate],
    score: impl Fn(&Candidate) -> f32,
) -> f64 {
    let differs =
        |other: &&Candidate| equivalence.angle(best.pose.rotation, other.pose.rotation) > DISTINCT_MIN_ANGLE_RAD;
    let rival = others.iter().filter(differs).map(&score).fold(f32::NEG_INFINITY, f32::max);
    f64::from((score(best) - rival).min(NOISE))
}
