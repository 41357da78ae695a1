//! The search for a tracked object over all rotations, in its first frame and after it was lost.

use crate::precise;
use crate::precise::no_candidate;
use crate::precise::search::efforts;
use crate::precise::search::recipe::SearchSettings;
use crate::precise::search::start;
use crate::precise::verdict::alternatives::lead;
use std::rc::Rc;

use glam::DQuat;

use crate::error::Result;
use crate::evidence::observation::Observation;
use crate::precise::drawing::prepared_mesh::PreparedMesh;
use crate::precise::observation::clean::CleanObservation;
use crate::precise::options::AlignOptions;
use crate::precise::scoring::prior::Prior;
use crate::precise::scoring::score::NOISE;
use crate::precise::search::problem::FACING_CAMERA;
use crate::precise::search::ranking::Candidate;
use crate::precise::search::recipe::SURE;
use crate::precise::search::rounds::Rounds;
use crate::precise::verdict::color::{Judgment, judgment};
use crate::precise::verdict::confidence::pose_probability;
use crate::progress::{Host, Stopwatch};
use crate::scheduler::{Boxed, Scheduler, boxed};

/// The prior of a search.
pub struct DetectionPrior {
    /// The prior on scale and orientation.
    pub prior: Prior,
    /// The logarithm of the scale, if it is known, and the rotation in which the object was seen last.
    pub before: Option<(Option<f64>, DQuat)>,
}

/// The lead of a pose over the others of a search over all rotations.
#[derive(Debug, Clone, Copy)]
pub struct Lead {
    /// The difference between the scores of the pose and of the best other one.
    pub margin: f64,
    /// Probability that colours have chosen the right one of the poses; 1 without colours.
    pub color_probability: f64,
    /// Probability that colours have chosen the right one of the turns that are equal by shape; `None` where there are none.
    pub turn: Option<f64>,
}

/// A found object.
pub struct Detection {
    /// The pose.
    pub candidate: Candidate,
    /// The frame.
    pub observation: Rc<CleanObservation>,
    /// Its lead over other poses.
    pub lead: Lead,
}

impl Detection {
    /// Searches all rotations. Among poses that fit equally well, colour decides; where it cannot, and the object was seen
    /// before, the nearest one counts: an object that looks alike from several sides has not turned unseen.
    ///
    /// # Errors
    /// As [`start::start_search`].
    pub fn search<'a>(
        observation: &'a Observation,
        mesh: &'a PreparedMesh<'_>,
        options: &'a AlignOptions,
        known: &'a DetectionPrior,
        host: &'a mut dyn Host,
        scheduler: &'a Scheduler,
    ) -> Boxed<'a, Result<Self>> {
        boxed(async move {
            let mut rounds: Option<Rounds> = None;
            let mut certainty = 0.0;
            for settings in efforts::of(options) {
                if certainty >= SURE || (known.before.is_some() && rounds.is_some()) {
                    break;
                }
                let stages = &mut Stopwatch::new(&mut *host, precise::PLAN);
                let log_scale = known.before.and_then(|(log_scale, _)| log_scale);
                let settings = SearchSettings { lock_scale: settings.lock_scale || log_scale.is_some(), ..settings };
                let mut next = start::start_search(observation, mesh, rounds.as_ref(), options, &settings, stages)?;
                if let Some(log_scale) = log_scale {
                    next.search.assume(Prior { scale: Some([libm::exp(log_scale); 2]), ..known.prior });
                }
                scheduler.yield_point().await;
                start::run_rounds(&mut next, 0.2..0.85, scheduler, stages).await;
                let best = next.candidates.first().filter(|best| best.pose.is_finite()).ok_or_else(no_candidate)?;
                let (conditioning, _) = next.search.conditioning(&best.pose);
                let lead = lead(&next.search.equivalence, best, &next.candidates[1..], |other| other.score.total);
                certainty = pose_probability(best, lead, conditioning.as_ref());
                rounds = Some(next);
            }
            let rounds = rounds.ok_or_else(no_candidate)?;
            let judgment = by_color(&rounds, observation, mesh, scheduler).await;
            let (candidate, margin) = chosen(&rounds, judgment.as_ref(), known)?;
            let turn = judgment.as_ref().and_then(|judgment| judgment.turn);
            let color_probability = judgment.map_or(1.0, |judgment| judgment.probability);
            let lead = Lead { margin, color_probability, turn };
            Ok(Self { candidate, observation: rounds.search.observation, lead })
        })
    }
}

/// The verdict of colour on the poses of a search; `None` without colours.
async fn by_color(
    rounds: &Rounds,
    observation: &Observation,
    mesh: &PreparedMesh<'_>,
    scheduler: &Scheduler,
) -> Option<Judgment> {
    let (photo, colors) = (observation.photo()?, mesh.colors()?);
    Some(judgment(rounds, photo, colors, scheduler).await)
}

/// The pose that counts, and its lead over the others.
fn chosen(rounds: &Rounds, judgment: Option<&Judgment>, known: &DetectionPrior) -> Result<(Candidate, f64)> {
    let first = *rounds.candidates.first().ok_or_else(no_candidate)?;
    let mut chosen = judgment.and_then(|judgment| judgment.chosen).unwrap_or(first);
    let is_colored = judgment.is_some_and(|judgment| judgment.is_used && !judgment.rivals.is_empty());
    if let (Some((_, before)), false) = (known.before, is_colored) {
        for other in rounds.candidates.iter().filter(|other| other.score.total > first.score.total - 0.5 * NOISE) {
            let angle = |candidate: &Candidate| rounds.search.equivalence.angle(candidate.pose.rotation, before);
            if angle(other) < angle(&chosen) {
                chosen = *other;
            }
        }
    }
    // Of the rotations that the symmetry makes one, the search keeps any.
    chosen.pose = match known.before {
        _ if is_colored => chosen.pose,
        Some((_, before)) => rounds.search.nearest(&chosen.pose, before),
        None => rounds.search.canonical(&chosen, FACING_CAMERA).unwrap_or(chosen.pose),
    };
    let others: Vec<Candidate> =
        rounds.candidates.iter().filter(|other| other.score.total < chosen.score.total).copied().collect();
    let margin = lead(&rounds.search.equivalence, &chosen, &others, |other| other.score.total);
    Ok((chosen, judgment.map_or(margin, |color| margin.max(color.lead()))))
}
