//! Colour: which of the poses that shape leaves is right, by the photo.
//!
//! Many objects look the same after a half turn, or after any roll, but for their print. Of the poses whose shape scores
//! are within noise, the one that agrees best with the photo is taken. Where no pose agrees, the colours of the mesh are
//! not those of the object, and shape decides alone.

use std::rc::Rc;

use glam::DVec3;

use super::appearance::{Appearance, PhotoCells};
use super::clean::CleanObservation;
use super::lookalikes::{Lookalike, lookalikes};
use super::pose::CropPose;
use super::prepared_mesh::PreparedMesh;
use super::recipe::{FINE, FINEST, MIDDLE, SearchSettings};
use super::refine::Refiner;
use super::render::Canvas;
use super::rounds::Rounds;
use super::score::NOISE;
use super::search::{Found, Search};
use crate::evidence::observation::Observation;
use crate::evidence::photo::Photo;
use crate::geometry::order::largest;
use crate::geometry::rotations::{angle_between, exp};
use crate::geometry::similarity::Similarity;
use crate::geometry::surface_colors::SurfaceColors;
use crate::report::{ColorReport, ColorVerdict, Effort};

/// Minimum correlation of the best pose with the photo for colour to decide.
const AGREES: f64 = 0.3;
/// Correlation that outweighs a difference of 1 between shape scores.
pub(super) const SHAPE: f64 = 0.5;
/// Gain for which another pose than that of shape is taken.
const MIN_GAIN: f64 = 0.02;
/// Contrast between two poses, relative to the noise, from which on they look different.
const DIFFERENT: f64 = 2.0;
/// Minimum rotation between poses that are rivals, radians.
const RIVAL: f64 = 0.35;
/// Factor of the correlation in the logarithm of the odds of two poses.
const ODDS: f64 = 15.0;
/// Minimum certainty where no pose agrees: as likely as not, the colours of the mesh mean nothing, and the turns that its
/// shape allows are all right.
const UNMATCHED: f64 = 0.5;
/// Steps of the refinement of a lookalike, and of the pose that colour chose.
const STEPS: [usize; 2] = [4, 6];
/// Standard deviation of a rotation, radians, from which on colour refines it; and the angles of its steps.
const LOOSE: f64 = 0.05;
const ROLL_STEPS: [f64; 4] = [0.12, 0.06, 0.03, 0.015];

/// The comparison of a search's poses with the photo, in steps.
pub struct ColorStage {
    photo: PhotoCells,
    /// What is still to be compared, last first.
    queue: Vec<Lookalike>,
    compared: Vec<Compared>,
}

/// A pose whose shape is within noise of the best one.
struct Compared {
    found: Found,
    appearance: Appearance,
    /// The agreement with the photo, with the difference of the shape scores.
    total: f64,
}

/// A pose that shape cannot tell from the chosen one, but that looks different.
pub struct Rival {
    /// The pose, with the score of its shape.
    pub found: Found,
    /// By how much its agreement with the photo is below that of the chosen pose.
    pub margin: f64,
}

/// What colour says.
pub struct Judgment {
    /// The chosen pose; `None` if it is that of shape.
    pub chosen: Option<Found>,
    /// Other poses that look different, best first.
    pub rivals: Vec<Rival>,
    /// Probability that the chosen pose is right, given that it is one of those compared.
    pub certainty: f64,
    /// For the result.
    pub report: ColorReport,
}

impl ColorStage {
    /// Prepares the comparison. `image` is the size of the depth map in pixels.
    pub fn new(rounds: &Rounds, photo: &Photo) -> Self {
        let search = &rounds.search;
        let queue = lookalikes(rounds).into_iter().rev().collect();
        Self { photo: PhotoCells::new(photo, search.observation.image, &search.fine), queue, compared: Vec::new() }
    }

    /// Compares poses until all are or `pause`, which is called after each, returns true. Returns whether all are.
    pub fn run(&mut self, rounds: &Rounds, colors: &SurfaceColors, pause: &mut dyn FnMut() -> bool) -> bool {
        let search = &rounds.search;
        let Some(best) = rounds.found.first() else { return true };
        let mut canvas = Canvas::default();
        if self.compared.is_empty() {
            let Some(compared) = self.compare(rounds, colors, &mut canvas, best.pose, best) else {
                self.queue.clear();
                return true;
            };
            self.compared.push(compared);
        }
        let middle = search.grid(MIDDLE);
        let refiner = Refiner { objective: search.objective(MIDDLE, &middle), lock_scale: search.settings.lock_scale };
        while let Some(Lookalike { pose, is_rough }) = self.queue.pop() {
            let pose = if is_rough { refiner.refine(&mut canvas, pose, STEPS[0]).pose } else { pose };
            let near = |other: &Compared| angle_between(other.found.pose.rotation, pose.rotation) < 0.5 * RIVAL;
            let is_new = !is_rough || !self.compared.iter().any(near);
            if is_new && let Some(compared) = self.compare(rounds, colors, &mut canvas, pose, best) {
                self.compared.push(compared);
            }
            if pause() && !self.queue.is_empty() {
                return false;
            }
        }
        true
    }

    /// Renders a pose; `None` if its shape is not within noise, or nothing can be compared.
    fn compare(
        &self,
        rounds: &Rounds,
        colors: &SurfaceColors,
        canvas: &mut Canvas,
        pose: CropPose,
        best: &Found,
    ) -> Option<Compared> {
        let search = &rounds.search;
        let score = search.objective(FINE, &search.fine).score(canvas, &pose);
        // Of the first comparison, which is of the best pose itself.
        let shape = self.compared.first().map_or(score.total, |first| first.found.score.total);
        if score.total < shape - NOISE {
            return None;
        }
        let appearance = self.photo.compare(canvas, colors, &search.mesh.frame, &search.fine)?;
        let total = appearance.agreement + SHAPE * f64::from(score.total - shape);
        Some(Compared { found: Found { pose, score, ..*best }, appearance, total })
    }

    /// Chooses among the compared poses.
    pub fn judge(&self, rounds: &Rounds, colors: &SurfaceColors) -> Judgment {
        let Some(first) = self.compared.first() else { return Judgment::none() };
        let most = self.compared.iter().fold(f64::NEG_INFINITY, |most, c| most.max(c.appearance.agreement));
        let is_used = most >= AGREES;
        let best = self.compared.iter().fold(first, |best, c| if c.total > best.total { c } else { best });
        let chosen = if is_used && best.total > first.total + MIN_GAIN { best } else { first };
        let is_rival = |other: &&Compared| {
            angle_between(other.found.pose.rotation, chosen.found.pose.rotation) > RIVAL
                && other.appearance.difference(&chosen.appearance) > DIFFERENT
        };
        let rivals: Vec<&Compared> = self.compared.iter().filter(is_rival).collect();
        let order = largest(rivals.iter().map(|rival| rival.total as f32), rivals.len());
        let rivals: Vec<&Compared> = order.into_iter().map(|i| rivals[i as usize]).collect();
        let is_changed = !core::ptr::eq(chosen, first);
        let verdict = match (rivals.is_empty(), is_used, is_changed) {
            (true, ..) => ColorVerdict::Uniform,
            (_, false, _) => ColorVerdict::Unmatched,
            (_, _, false) => ColorVerdict::Agreed,
            (_, _, true) => ColorVerdict::Decided,
        };
        let mut found = chosen.found;
        if is_changed {
            found.pose = polished(rounds, found.pose);
        }
        let rolled = if is_used { self.roll(rounds, colors, found.pose) } else { None };
        let gain = rolled.map_or(0.0, |(_, gain)| gain);
        if let Some((pose, _)) = rolled {
            found.pose = pose;
        }
        let agreement = chosen.appearance.agreement + gain;
        let lead = |rival: &Compared| if is_used { chosen.total + gain - rival.total } else { 0.0 };
        let odds: f64 = rivals.iter().map(|rival| libm::exp(-ODDS * lead(rival))).sum();
        let margin = |rival: &Compared| agreement - rival.appearance.agreement;
        Judgment {
            chosen: (is_changed || rolled.is_some()).then_some(found),
            certainty: (1.0 / (1.0 + odds)).max(if is_used { 0.0 } else { UNMATCHED }),
            report: ColorReport { verdict, agreement, margin: rivals.first().map(|rival| lead(rival)) },
            rivals: rivals.iter().map(|rival| Rival { found: rival.found, margin: margin(rival) }).collect(),
        }
    }

    /// Rolls a pose about the axis that shape leaves open to where its colours agree best, and the gain of agreement;
    /// `None` if shape leaves none, or no roll is better.
    fn roll(&self, rounds: &Rounds, colors: &SurfaceColors, pose: CropPose) -> Option<(CropPose, f64)> {
        let search = &rounds.search;
        let (conditioning, _) = search.conditioning(&pose);
        let (deviation, axis) = conditioning?.rotation;
        if deviation < LOOSE {
            return None;
        }
        let mut canvas = Canvas::default();
        let objective = search.objective(FINE, &search.fine);
        let mut total = |angle: f64| {
            let turned = self.rolled(rounds, &pose, axis, angle);
            let score = objective.score(&mut canvas, &turned);
            let appearance = self.photo.compare(&canvas, colors, &search.mesh.frame, &search.fine);
            appearance.map_or(f64::NEG_INFINITY, |a| a.agreement + SHAPE * f64::from(score.total))
        };
        let start = total(0.0);
        let mut best = (start, 0.0);
        for step in ROLL_STEPS {
            let middle = best.1;
            for angle in [middle - step, middle + step] {
                let there = total(angle);
                if there > best.0 {
                    best = (there, angle);
                }
            }
        }
        (best.1 != 0.0).then(|| (self.rolled(rounds, &pose, axis, best.1), best.0 - start))
    }

    fn rolled(&self, rounds: &Rounds, pose: &CropPose, axis: DVec3, angle: f64) -> CropPose {
        rounds.search.mesh.turns.turned(pose, exp(axis * angle) * pose.rotation)
    }
}

impl Judgment {
    /// Nothing can be compared.
    fn none() -> Self {
        let report = ColorReport { verdict: ColorVerdict::Hidden, agreement: 0.0, margin: None };
        Self { chosen: None, rivals: Vec::new(), certainty: 1.0, report }
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
    let photo = PhotoCells::new(photo, search.observation.image, &search.fine);
    let pose = CropPose::of_similarity(pose, &search.mesh.frame)?;
    let mut canvas = Canvas::default();
    search.objective(FINE, &search.fine).score(&mut canvas, &pose);
    Some(photo.compare(&canvas, colors, &search.mesh.frame, &search.fine)?.agreement)
}

/// A pose refined on the finest grid.
fn polished(rounds: &Rounds, pose: CropPose) -> CropPose {
    let search = &rounds.search;
    let finest = search.grid(FINEST);
    let refiner = Refiner { objective: search.objective(FINEST, &finest), lock_scale: search.settings.lock_scale };
    refiner.refine(&mut Canvas::default(), pose, STEPS[1]).pose
}
