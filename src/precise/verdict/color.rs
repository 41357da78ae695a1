//! Colour: which of the poses that shape leaves is right, by the photo.
//!
//! Many objects look the same after a half turn, or after any roll, but for their print. Of the poses whose shape scores
//! are within noise, the one that agrees best with the photo is taken. Where no pose agrees, the colours of the mesh are
//! not those of the object, and shape decides alone.

use std::rc::Rc;

use glam::{DQuat, DVec3};

use super::choice::{CORRELATION_PER_SCORE, Choice, ColorScore, HIDDEN, UNMATCHED_PROBABILITY, best_roll};
use super::lookalikes::{Likeness, Lookalike, lookalikes};
use crate::evidence::observation::Observation;
use crate::evidence::photo::Photo;
use crate::geometry::rotations::{angle_between, exp};
use crate::geometry::similarity::Similarity;
use crate::geometry::surface_colors::SurfaceColors;
use crate::precise::drawing::equivalence::{self, Equivalence};
use crate::precise::drawing::pose::CropPose;
use crate::precise::drawing::prepared_mesh::PreparedMesh;
use crate::precise::drawing::render::Canvas;
use crate::precise::observation::clean::CleanObservation;
use crate::precise::scoring::appearance::{Appearance, PhotoCells};
use crate::precise::scoring::score::{NOISE, Score};
use crate::precise::search::problem::Search;
use crate::precise::search::ranking::Candidate;
use crate::precise::search::recipe::{COLORED, FINE, SearchSettings};
use crate::precise::search::refine::Refiner;
use crate::precise::search::rounds::Rounds;
use crate::report::{ColorReport, Effort};
use crate::scheduler::{Boxed, Scheduler, boxed};

/// Minimum rotation between poses that are rivals, radians.
const RIVAL_MIN_ANGLE_RAD: f64 = 0.35;
/// Standard deviation of a rotation, radians, from which on colour refines it.
pub const LOOSE_MIN_SD_RAD: f64 = 0.05;

/// A pose whose shape is within noise of the best one.
struct Compared {
    candidate: Candidate,
    appearance: Appearance,
    agreement: ColorScore,
}

/// A pose of about the same shape score as the chosen one, but of other colours.
pub struct Rival {
    /// The pose, with the score of its shape.
    pub candidate: Candidate,
    /// By how much its agreement with the photo is below that of the chosen pose.
    pub margin: f64,
    /// Whether a symmetry of the shape makes it equivalent to the chosen pose.
    pub is_turn: bool,
}

/// The verdict of colour.
pub struct Judgment {
    /// The chosen pose; `None` if it is that of shape.
    pub chosen: Option<Candidate>,
    /// Other poses that look different, best first.
    pub rivals: Vec<Rival>,
    /// Probability that the chosen pose is right up to the symmetry of the shape, given that it is one of those compared.
    pub probability: f64,
    /// Probability that it is the right one of the poses that this symmetry makes equivalent; `None` where these look alike.
    pub turn: Option<f64>,
    /// For the result.
    pub report: ColorReport,
    /// Whether a pose agrees with the photo, so that colour counts.
    pub is_used: bool,
}

/// The verdict of the photo on the poses of a search, with a yield point after each comparison.
pub fn judgment<'a>(
    rounds: &'a Rounds,
    photo: &'a Photo,
    colors: &'a SurfaceColors,
    scheduler: &'a Scheduler,
) -> Boxed<'a, Judgment> {
    boxed(async move {
        let photo = cells(photo, &rounds.search);
        let compared = compared(rounds, &photo, colors, scheduler).await;
        chosen(rounds, &photo, colors, &compared)
    })
}

/// Chooses among the compared poses.
fn chosen(rounds: &Rounds, photo: &PhotoCells, colors: &SurfaceColors, compared: &[Compared]) -> Judgment {
    let scores = compared.iter().map(|compared| compared.agreement).collect();
    let contrast = |a: usize, b: usize| {
        let [a, b] = [a, b].map(|k| &compared[k]);
        let is_rival = are_rivals(a.candidate.pose.rotation, b.candidate.pose.rotation);
        if is_rival { a.appearance.difference(&b.appearance) } else { 0.0 }
    };
    let Some(choice) = Choice::among(scores, contrast) else { return Judgment::none() };
    let is_changed = choice.chosen != 0;
    let mut candidate = compared[choice.chosen].candidate;
    if is_changed {
        candidate.pose = rounds.search.polished(candidate.pose);
    }
    let axis = if choice.is_used { loose_axis(&rounds.search, &candidate.pose, LOOSE_MIN_SD_RAD) } else { None };
    let rolled = axis.and_then(|axis| roll(&rounds.search, photo, colors, candidate.pose, axis));
    let gain = rolled.map_or(0.0, |(_, gain)| gain);
    if let Some((pose, _)) = rolled {
        candidate.pose = pose;
    }
    let pose_of = |k: usize| compared.get(k).map(|compared| compared.candidate);
    let is_other = is_changed || rolled.is_some();
    Judgment::new(&choice, (candidate, is_other), pose_of, gain, &rounds.search.equivalence)
}

/// The poses of a search with about the shape score of the best one, which is the first, and their colours. Empty if
/// nothing can be compared.
async fn compared(rounds: &Rounds, photo: &PhotoCells, colors: &SurfaceColors, scheduler: &Scheduler) -> Vec<Compared> {
    let search = &rounds.search;
    let mut canvas = Canvas::default();
    let look_at = |canvas: &mut Canvas, pose: CropPose| {
        let score = search.objective(FINE).score(canvas, &pose);
        Some((score, photo.compare(canvas, colors, &search.mesh.frame, search.grid(FINE))?))
    };
    let Some(best) = rounds.candidates.first() else { return Vec::new() };
    let Some((of_best, appearance)) = look_at(&mut canvas, best.pose) else { return Vec::new() };
    let agreement = ColorScore::new(appearance.agreement, 0.0);
    let score = Score { total: best.score.total, ..of_best };
    let mut list = vec![Compared { candidate: Candidate { score, ..*best }, appearance, agreement }];
    let [rough, _] = COLORED;
    let refiner = Refiner { objective: search.objective(rough.grid), lock_scale: search.settings.lock_scale };
    for Lookalike { pose, likeness } in lookalikes(rounds) {
        let is_rough = likeness == Likeness::Rough;
        // A turn of the best pose doubles its error. The poses of the search near the turn are more accurate.
        let is_near = |a: &CropPose, b: &CropPose| angle_between(a.rotation, b.rotation) < 0.5 * RIVAL_MIN_ANGLE_RAD;
        let known = rounds.candidates.iter().skip(1).find(|candidate| is_near(&candidate.pose, &pose));
        let pose = match known {
            Some(candidate) => candidate.pose,
            None if is_rough => refiner.refine(&mut canvas, pose, rough.steps).pose,
            None => pose,
        };
        let is_compared =
            |other: &Compared| other.candidate.pose == pose || is_rough && is_near(&other.candidate.pose, &pose);
        if !list.iter().any(is_compared)
            && let Some((mut score, appearance)) = look_at(&mut canvas, pose)
        {
            // The scores of the ranking are those of the mesh in better proportions. Other poses are compared, as the mesh
            // is, with the best one.
            let shape = known.map_or(score.total - of_best.total, |known| known.score.total - best.score.total);
            score.total = best.score.total + shape;
            // What a symmetry makes equivalent is compared, whatever the inaccuracy of the mesh takes off its score.
            if likeness == Likeness::Equal || score.total > best.score.total - NOISE {
                let agreement = ColorScore::new(appearance.agreement, shape);
                list.push(Compared { candidate: Candidate { pose, score, ..*best }, appearance, agreement });
            }
        }
        scheduler.yield_point().await;
    }
    list
}

/// Whether two poses are so far apart that one of them is wrong.
pub fn are_rivals(a: DQuat, b: DQuat) -> bool {
    angle_between(a, b) > RIVAL_MIN_ANGLE_RAD
}

/// The axis about which shape leaves the rotation open, by at least `loose` radians.
pub fn loose_axis(search: &Search, pose: &CropPose, loose: f64) -> Option<DVec3> {
    let loosest = || search.conditioning(pose).0.map(|own| own.rotation).filter(|(deviation, _)| *deviation >= loose);
    search.equivalence.free_axis(pose.rotation).or_else(|| loosest().map(|(_, axis)| axis))
}

/// Rolls a pose about the axis that shape leaves open to where its colours agree best, and the gain of agreement; `None`
/// if no roll is better.
pub fn roll(
    search: &Search,
    photo: &PhotoCells,
    colors: &SurfaceColors,
    pose: CropPose,
    axis: DVec3,
) -> Option<(CropPose, f64)> {
    let rolled = |angle: f64| search.mesh.turns.turned(&pose, exp(axis * angle) * pose.rotation);
    let mut canvas = Canvas::default();
    let objective = search.objective(FINE);
    let (angle, gain) = best_roll(|angle| {
        let score = objective.score(&mut canvas, &rolled(angle));
        let appearance = photo.compare(&canvas, colors, &search.mesh.frame, search.grid(FINE));
        appearance.map_or(f64::NEG_INFINITY, |a| ColorScore::new(a.agreement, score.total).total)
    })?;
    Some((rolled(angle), gain))
}

impl Judgment {
    /// From a choice and the pose that it ends with, which `is_other` than the best by shape. `pose_of` gives that of a rival.
    pub fn new(
        choice: &Choice,
        (end, is_other): (Candidate, bool),
        pose_of: impl Fn(usize) -> Option<Candidate>,
        gain: f64,
        equivalence: &Equivalence,
    ) -> Self {
        let rival = |&k: &usize| {
            let candidate = pose_of(k)?;
            let is_turn =
                equivalence.angle(end.pose.rotation, candidate.pose.rotation) <= equivalence::DISTINCT_MIN_ANGLE_RAD;
            Some((k, Rival { candidate, margin: choice.margin(k, gain), is_turn }))
        };
        let (indices, rivals): (Vec<usize>, Vec<Rival>) = choice.rivals.iter().filter_map(rival).unzip();
        let probability = |are_turns: bool| {
            let these = indices.iter().zip(&rivals).filter(|(_, rival)| rival.is_turn == are_turns);
            let known = choice.probability(gain, these.map(|(k, _)| *k));
            // Where no pose agrees, the colours of the mesh as likely as not mean nothing, and all turns are right; but which of
            // them colour would choose is open.
            if are_turns || choice.is_used { known } else { known.max(UNMATCHED_PROBABILITY) }
        };
        Self {
            chosen: is_other.then_some(end),
            probability: probability(false),
            turn: rivals.iter().any(|rival| rival.is_turn).then(|| probability(true)),
            report: choice.report(gain),
            is_used: choice.is_used,
            rivals,
        }
    }

    /// The smallest lead over a pose that looks different, in units of the shape score, of which no more than [`NOISE`]
    /// counts; negative infinity if colour does not count.
    pub fn lead(&self) -> f64 {
        if !self.is_used {
            return f64::NEG_INFINITY;
        }
        self.rivals
            .iter()
            .fold(f64::from(NOISE), |least, rival| least.min(rival.margin.max(0.0) / CORRELATION_PER_SCORE))
    }

    /// Nothing can be compared.
    fn none() -> Self {
        Self { chosen: None, rivals: Vec::new(), probability: 1.0, turn: None, report: HIDDEN, is_used: false }
    }
}

/// The correlation of the colours of a posed mesh with the photo, without the shading that normals explain, −1 to 1;
/// `None` where either has no colours, or too little of the mesh is in the mask. `clean` is the observation, where it has
/// been cleaned already.
pub fn agreement(
    observation: &Observation,
    clean: Option<Rc<CleanObservation>>,
    mesh: &PreparedMesh<'_>,
    pose: &Similarity,
) -> Option<f64> {
    let (photo, colors) = (observation.photo()?, mesh.colors()?);
    let settings = SearchSettings::from(Effort::Fast);
    let clean = clean.unwrap_or_else(|| Rc::new(CleanObservation::new(observation)));
    let search = Search::new(clean, mesh.pyramid(&settings.grids)?, settings);
    let pose = CropPose::of_similarity(pose, &search.mesh.frame)?;
    agreement_at(&search, &cells(photo, &search), colors, &pose)
}

/// The correlation of the colours of a pose with the photo; `None` if nothing can be compared.
pub fn agreement_at(search: &Search, photo: &PhotoCells, colors: &SurfaceColors, pose: &CropPose) -> Option<f64> {
    let mut canvas = Canvas::default();
    search.objective(FINE).score(&mut canvas, pose);
    Some(photo.compare(&canvas, colors, &search.mesh.frame, search.grid(FINE))?.agreement)
}

/// The photo on the fine grid of a search in the whole depth map, registered to its mask.
pub fn cells(photo: &Photo, search: &Search) -> PhotoCells {
    PhotoCells::registered(photo, search.observation.image, search.grid(FINE))
}
