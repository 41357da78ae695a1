//! Alternative poses that explain an observation as well, such as flips, without equivalent placements.

use glam::DVec3;

use super::color::Rival;
use super::score::NOISE;
use super::search::{Found, Search};
use crate::error::Result;
use crate::geometry::mesh::Mesh;
use crate::geometry::order::quantile;
use crate::geometry::rotations::angle_between;
use crate::geometry::triangle_tree::TriangleTree;
use crate::metrics::symmetry::{AUTO_MEAN, AUTO_TAIL, Symmetry};
use crate::report::Alternative;

/// Score below an unsure best pose down to which poses are alternatives. It is wrong more often than others, and the right pose
/// then scores less.
pub(crate) const UNSURE: f32 = 3.0 * NOISE;
/// Maximum number of alternatives that shape tells from the best pose.
const MOST: usize = 12;
/// Minimum rotation between different poses, radians.
const MIN_TURN: f64 = 0.26;
/// Maximum distances between the surfaces of equivalent placements, relative to the tolerance of automatic symmetry: low
/// enough that the two sides of a phone are different placements.
const SAME_SURFACE: f64 = 0.7;
/// Number of vertices compared to decide whether two placements of the mesh coincide.
const SAMPLES: usize = 300;
/// Maximum deviation of a rotation from a declared symmetry, radians.
const SAME_TURN: f64 = 0.17;
/// Maximum number of alternatives that only their colours tell from the best pose, and the margin from which on colour has
/// refuted them.
const MAX_RIVALS: usize = 4;
const CLEAR: f64 = 0.5;

/// The poses after the first whose scores are within noise of it. Poses near it or near each other, and placements
/// equivalent under the symmetry of the object, are excluded.
pub(crate) fn alternatives(
    found: &[Found],
    search: &Search,
    mesh: &Mesh,
    symmetry: &Symmetry,
) -> Result<Vec<Alternative>> {
    Listing { found, search, mesh, symmetry, likeness: None }.within(NOISE)
}

/// The poses of a search, to be listed as alternatives within several margins.
pub(crate) struct Listing<'a> {
    /// The poses, best first.
    pub found: &'a [Found],
    /// The search that found them.
    pub search: &'a Search,
    /// The mesh, for its symmetry.
    pub mesh: &'a Mesh,
    /// The symmetry.
    pub symmetry: &'a Symmetry,
    /// The evidence that distinguishes placements, prepared on first use.
    pub likeness: Option<Likeness>,
}

impl Listing<'_> {
    /// As [`alternatives`], of the poses whose scores are within `margin` of the first one.
    pub fn within(&mut self, margin: f32) -> Result<Vec<Alternative>> {
        let Some((best, others)) = self.found.split_first() else { return Ok(Vec::new()) };
        let turn = |a: &Found, b: &Found| angle_between(a.pose.rotation, b.pose.rotation);
        let likely: Vec<&Found> =
            others.iter().filter(|o| o.score.total > best.score.total - margin && turn(best, o) > MIN_TURN).collect();
        if likely.is_empty() {
            return Ok(Vec::new());
        }
        let likeness = match self.likeness.take() {
            Some(known) => known,
            None => Likeness::new(self.search, self.mesh, self.symmetry)?,
        };
        let likeness = self.likeness.insert(likeness);
        let mut kept = vec![best];
        for other in likely {
            if kept.len() > MOST {
                break;
            }
            if kept.iter().all(|k| turn(k, other) > MIN_TURN && !likeness.same(k, other)) {
                kept.push(other);
            }
        }
        Ok(kept.iter().skip(1).map(|other| alternative(best, other, None, self.search)).collect())
    }
}

/// A pose as an alternative to the best one.
fn alternative(best: &Found, other: &Found, color_margin: Option<f64>, search: &Search) -> Alternative {
    Alternative {
        camera_from_mesh: (&other.pose.similarity(&search.mesh.frame)).into(),
        score: f64::from(other.score.total),
        turn_deg: angle_between(best.pose.rotation, other.pose.rotation).to_degrees(),
        color_margin,
    }
}

/// Tells the alternatives how well their colours agree with the photo, and adds poses that look different, though their
/// shape does not.
pub(crate) fn add_rivals(alternatives: &mut Vec<Alternative>, best: &Found, rivals: &[Rival], search: &Search) {
    let rotation = |other: &Alternative| glam::DQuat::from_array(other.camera_from_mesh.rotation);
    let mut added = 0;
    for rival in rivals {
        let near = |other: &&mut Alternative| angle_between(rotation(other), rival.found.pose.rotation) < MIN_TURN;
        match alternatives.iter_mut().find(near) {
            Some(known) => {
                known.color_margin.get_or_insert(rival.margin);
            }
            None if added < MAX_RIVALS && rival.margin < CLEAR => {
                added += 1;
                alternatives.push(alternative(best, &rival.found, Some(rival.margin), search));
            }
            None => {}
        }
    }
}

/// The criterion for equivalent placements of the mesh.
pub(crate) enum Likeness {
    /// No two are equivalent.
    Never,
    /// Equivalent if the rotation between them is one of these.
    Turns(Box<crate::metrics::symmetry::SymmetryGroup>),
    /// Equivalent if the surfaces coincide.
    Surfaces(Box<TriangleTree>, Vec<DVec3>),
}

impl Likeness {
    fn new(search: &Search, mesh: &Mesh, symmetry: &Symmetry) -> Result<Self> {
        Ok(match symmetry {
            Symmetry::None => Self::Never,
            Symmetry::Declared(_) => Self::Turns(Box::new(symmetry.group(mesh)?)),
            Symmetry::Auto | Symmetry::AutoRevolution => {
                let positions = search.mesh.fine.positions();
                let step = positions.len().div_ceil(SAMPLES).max(1);
                let samples = positions.iter().step_by(step).map(|p| p.as_dvec3()).collect();
                Self::Surfaces(Box::new(TriangleTree::new(&search.mesh.fine)), samples)
            }
        })
    }

    fn same(&self, a: &Found, b: &Found) -> bool {
        match self {
            Self::Never => false,
            Self::Turns(group) => {
                let turn = a.pose.rotation.conjugate() * b.pose.rotation;
                let turn = nalgebra::UnitQuaternion::new_normalize(nalgebra::Quaternion::from(turn.to_array()));
                group.nearest(&turn).angle_to(&turn) < SAME_TURN
            }
            Self::Surfaces(tree, samples) => coincide(tree, samples, a, b),
        }
    }
}

/// Whether the mesh coincides with itself under both poses, within [`SAME_SURFACE`].
fn coincide(tree: &TriangleTree, samples: &[DVec3], a: &Found, b: &Found) -> bool {
    let (scale_b, origin_b) = b.pose.scale_translation();
    let (scale, origin) = a.pose.scale_translation();
    let back = a.pose.rotation.conjugate();
    let point = |i: usize| (back * (b.pose.rotation * samples[i] * scale_b + origin_b - origin) / scale).as_vec3();
    let mut distances: Vec<f32> = Vec::with_capacity(samples.len());
    tree.nearest_of_each(samples.len(), point, |_, nearest| {
        distances.push(nearest.map_or(f32::INFINITY, |s| s.distance_squared.sqrt()));
    });
    let mean = distances.iter().map(|d| f64::from(*d)).sum::<f64>() / distances.len().max(1) as f64;
    let tail = quantile(distances.iter().copied(), 0.95).map_or(f64::INFINITY, f64::from);
    mean <= SAME_SURFACE * AUTO_MEAN && tail <= SAME_SURFACE * AUTO_TAIL
}
