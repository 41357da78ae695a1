//! Colour in views with known camera poses: of the turns whose shape is within noise in all views together, the one that
//! agrees best with all photos.

use glam::DVec3;

use super::joint::Joint;
use super::view_set::{Ranked, ViewSet};
use super::world_pose::WorldPose;
use crate::geometry::rotations::exp;
use crate::geometry::surface_colors::SurfaceColors;
use crate::precise::scoring::appearance::{Appearance, PhotoCells};
use crate::precise::scoring::conditioning::Conditioning;
use crate::precise::scoring::score::NOISE;
use crate::precise::search::ranking::Candidate;
use crate::precise::search::recipe::{COARSE, COLORED, FINE};
use crate::precise::verdict::choice::{Choice, ColorScore, best_roll};
use crate::precise::verdict::color::{Judgment, LOOSE_MIN_SD_RAD, are_rivals};
use crate::precise::verdict::lookalikes::{Likeness, Lookalike, ROLLS, among};

/// Correlation above which a photo agrees no better.
const SURE_AGREEMENT: f64 = 0.99;

/// The views and their photos.
pub struct Photos<'a> {
    /// The views that are used.
    pub views: ViewSet<'a>,
    /// The photo of each, on the fine grid of its search.
    pub photos: &'a [Option<PhotoCells>],
    /// The colours of the mesh.
    pub colors: &'a SurfaceColors,
}

/// A pose whose shape is within noise of the best one.
struct Compared {
    ranked: Ranked,
    /// The mean score of its shape.
    shape: f32,
    appearances: Vec<Option<Appearance>>,
    look: ColorScore,
}

impl Photos<'_> {
    /// Judges the turns of the best of the `ranked` poses. Returns the judgment, whose poses are those in the first view,
    /// and the chosen pose, if it is not the first. `None` if nothing can be compared.
    pub fn judge(
        &mut self,
        ranked: &[Ranked],
        conditioning: Option<&Conditioning>,
    ) -> Option<(Judgment, Option<Ranked>)> {
        let best = ranked.first()?;
        let alike = self.lookalikes(best, ranked)?;
        let [rough, polish] = COLORED;
        let mut joint = self.views.level(FINE);
        let mut rough_joint = self.views.level(rough.grid);
        let first = self.compare(&mut joint, best, None)?;
        let shape = first.shape;
        let look = ColorScore::new(first.look.agreement, 0.0);
        let mut compared = vec![Compared { look, ..first }];
        for Lookalike { mut pose, likeness } in alike {
            if likeness == Likeness::Rough {
                let refined = rough_joint.refine(pose, rough.steps);
                self.views.renders += refined.renders;
                pose = refined.pose;
            }
            self.views.renders += 1;
            let other = self.compare(&mut joint, &Ranked { pose, ..best.clone() }, Some(shape));
            compared.extend(other.filter(|other| likeness == Likeness::Equal || other.shape >= shape - NOISE));
        }
        let contrast = |a: usize, b: usize| {
            let [a, b] = [a, b].map(|k| &compared[k]);
            let is_rival = are_rivals(a.ranked.pose.rotation, b.ranked.pose.rotation);
            if is_rival { difference(a, b) } else { 0.0 }
        };
        let choice = Choice::among(compared.iter().map(|compared| compared.look).collect(), contrast)?;
        let is_changed = choice.chosen != 0;
        let mut chosen = compared[choice.chosen].ranked.clone();
        if is_changed {
            chosen.pose = self.views.polished(&polish, chosen.pose);
        }
        let part = self.views.parts.first()?;
        let loosest = || conditioning.map(|own| own.rotation).filter(|(deviation, _)| *deviation >= LOOSE_MIN_SD_RAD);
        let axis = part.search.equivalence.free_axis(chosen.pose.rotation).or_else(|| loosest().map(|(_, axis)| axis));
        let rolled = axis.filter(|_| choice.is_used).and_then(|axis| self.roll(&mut joint, &chosen, axis));
        let gain = rolled.map_or(0.0, |(_, gain)| gain);
        if let Some((pose, _)) = rolled {
            chosen.pose = pose;
        }
        let first = self.views.parts.first()?;
        let end = first.candidate(&chosen)?;
        let is_other = is_changed || rolled.is_some();
        let pose_of = |k: usize| first.candidate(&compared.get(k)?.ranked);
        let judgment = Judgment::new(&choice, (end, is_other), pose_of, gain, &first.search.equivalence);
        Some((judgment, is_other.then_some(chosen)))
    }

    /// The turns that look about like the best pose in all views, on the coarse grid.
    fn lookalikes(&mut self, best: &Ranked, ranked: &[Ranked]) -> Option<Vec<Lookalike<WorldPose>>> {
        let (part, seen) = self.views.parts.iter().find_map(|part| Some((part, part.camera.see(&best.pose)?)))?;
        let turned = part.search.mesh.turns.about_axes(&seen, ROLLS);
        let turned = turned.iter().map(|turned| part.camera.place(turned));
        let mut joint = self.views.level(COARSE);
        let mut mean = |pose: &WorldPose| joint.score(pose).total / self.views.parts.len() as f32;
        let score = mean(&best.pose);
        let poses: Vec<WorldPose> = ranked.iter().skip(1).map(|other| other.pose).chain(turned).collect();
        self.views.renders += poses.len();
        let scored = poses.into_iter().map(|pose| Candidate::of(pose, mean(&pose)));
        let equal = part.search.equivalence.others(seen.rotation, ROLLS);
        let equal = equal.into_iter().map(|turn| part.camera.place(&part.search.mesh.turns.turned(&seen, turn)));
        Some(among(best.pose.rotation, score, scored, equal))
    }

    /// Renders a pose in all views, whose shape is compared with `shape`; `None` if no colours can be compared.
    fn compare(&self, joint: &mut Joint<'_>, ranked: &Ranked, shape: Option<f32>) -> Option<Compared> {
        let score = joint.score(&ranked.pose);
        let own = score.total / self.views.parts.len() as f32;
        let appearances: Vec<Option<Appearance>> = self
            .photos
            .iter()
            .zip(&self.views.parts)
            .enumerate()
            .map(|(k, (photo, part))| {
                part.camera.see(&ranked.pose)?;
                photo.as_ref()?.compare(joint.canvas(k), self.colors, &part.search.mesh.frame, part.search.grid(FINE))
            })
            .collect();
        let look = ColorScore::new(joint_agreement(&appearances)?, own - shape.unwrap_or(0.0));
        Some(Compared { ranked: Ranked { score, ..ranked.clone() }, shape: own, appearances, look })
    }

    /// The pose rolled about an axis to where its colours agree best, and the gain.
    fn roll(&self, joint: &mut Joint<'_>, chosen: &Ranked, axis: DVec3) -> Option<(WorldPose, f64)> {
        let part = self.views.parts.iter().find(|part| part.camera.see(&chosen.pose).is_some())?;
        let rolled = |angle: f64| {
            let rotation = exp(axis * angle) * chosen.pose.rotation;
            let seen = part.camera.see(&chosen.pose)?;
            let turned = part.camera.see(&WorldPose { rotation, ..chosen.pose })?;
            Some(part.camera.place(&part.search.mesh.turns.turned(&seen, turned.rotation)))
        };
        let (angle, gain) = best_roll(|angle| {
            let compared = rolled(angle).and_then(|pose| self.compare(joint, &Ranked { pose, ..chosen.clone() }, None));
            compared.map_or(f64::NEG_INFINITY, |compared| compared.look.total)
        })?;
        Some((rolled(angle)?, gain))
    }
}

/// The correlation with all photos; `None` if nothing is compared. That of one photo is its own; of several, that with the
/// same likelihood as all of them: −n·log(1 − ρ²) for n cells. A view of a side whose colours are invented takes little
/// from one that agrees.
fn joint_agreement(appearances: &[Option<Appearance>]) -> Option<f64> {
    let seen: Vec<(f64, f64)> = appearances.iter().flatten().map(|a| (a.cells() as f64, a.agreement)).collect();
    let cells: f64 = seen.iter().map(|(cells, _)| cells).sum();
    match seen.as_slice() {
        [] => None,
        [(_, agreement)] => Some(*agreement),
        _ => {
            let unlikely = |agreement: f64| libm::log(1.0 - agreement.clamp(0.0, SURE_AGREEMENT).powi(2));
            let mean = seen.iter().map(|(cells, agreement)| cells * unlikely(*agreement)).sum::<f64>() / cells;
            Some((1.0 - libm::exp(mean)).max(0.0).sqrt())
        }
    }
}

/// The largest difference of contrast in a view.
fn difference(a: &Compared, b: &Compared) -> f64 {
    let pairs = a.appearances.iter().zip(&b.appearances).filter_map(|(a, b)| a.as_ref().zip(b.as_ref()));
    pairs.map(|(a, b)| a.difference(b)).fold(0.0, f64::max)
}
