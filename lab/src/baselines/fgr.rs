//! Fast Global Registration (Zhou, Park, Koltun, "Fast Global Registration", ECCV 2016).
//!
//! Minimises Σ μ r²/(μ + r²) over the matches' distances r by its line process: weights (μ/(μ + r²))², one
//! Gauss-Newton step, and so on, while μ falls from the size of the clouds, where the objective is all but quadratic,
//! to a small one, where incorrect matches have no influence.
//!
//! Options and their defaults are Open3D's, also where it departs from the paper: the clouds are divided by the larger
//! of both radii, and μ, which is a squared distance, falls until it is below `max_correspondence_distance`, which is
//! none. Intentional differences:
//! - μ begins at the radius in the frame it is used in, as published: 1 in the normalised one. Open3D 0.20 begins there
//!   at
//!   the radius in the clouds' own unit, so that its answer depends on whether they are in metres or in millimetres
//!   ([`FgrSettings::initial_mu`] repeats that).
//! - Too few matches are an error where Open3D returns the identity.
//! - The source is moved and not the target, and small turns are turns and not Euler's angles: this does not move the
//!   optimum.

use super::measurements::{Matched, no_consensus};
use crate::prelude::*;
use sim3align::register::icp::{moved, rigid_jacobian};
use sim3align::register::matching::Match;
use sim3align_geometry::normal_equations::NormalEquations;

/// The random stream of the tuple test.
const STREAM: u64 = 6;

/// Minimum number of matches after the tuple test.
const MIN_MATCHES: usize = 10;

/// Number of tuples drawn per match.
const TRIALS_PER_MATCH: usize = 100;

/// Maximum number of matches; more are subsampled evenly.
const MAX_MATCHES: usize = 100_000;

/// Maximum number of tuples.
const MAX_TUPLES: usize = 1000;

/// Iterations between two decreases of μ, and its divisor then.
const HOLD: usize = 4;
const DIVISION_FACTOR: f64 = 1.4;

/// μ stops decreasing below this fraction of the radius of the larger cloud.
const MAX_CORRESPONDENCE_DISTANCE: f64 = 0.025;

/// Settings of [`solve`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FgrSettings {
    /// μ at the beginning, in the normalised frame.
    pub initial_mu: f64,
    /// Number of iterations.
    pub iterations: usize,
    /// Minimum similarity of the edges of a tuple's triangles, in (0, 1]; `None` disables the tuple test.
    pub tuple_scale: Option<f64>,
    /// Seed of the tuple test.
    pub seed: u64,
}

impl Default for FgrSettings {
    fn default() -> Self {
        Self { initial_mu: 1.0, iterations: 64, tuple_scale: Some(0.95), seed: 0 }
    }
}

/// Result of [`solve`].
#[derive(Debug, Clone, PartialEq)]
pub struct Fgr {
    /// The rigid transform.
    pub target_from_source: Similarity,
    /// Indices of the matches in the optimisation: those of the tuples in order, or all.
    pub used: Vec<usize>,
    /// The final μ, in the squared unit of the clouds.
    pub mu: f64,
}

/// Estimates the rigid transform from matches.
///
/// # Errors
/// [`NoConsensus`](sim3align_geometry::error::ErrorCode::NoConsensus) for fewer than ten matches, or where fewer than
/// four triples of them form like triangles; [`NonFinite`](sim3align_geometry::error::ErrorCode::NonFinite),
/// [`DegeneratePoints`](sim3align_geometry::error::ErrorCode::DegeneratePoints) where a cloud is one point.
pub fn solve(source: &[Vec3], target: &[Vec3], matches: &[Match], settings: &FgrSettings) -> Result<Fgr> {
    let matched = Matched::of(source, target, matches)?.thinned(MAX_MATCHES, settings.seed);
    let used = match settings.tuple_scale {
        Some(scale) => tuples(&matched, scale, settings),
        None => (0..matched.len()).collect(),
    };
    if used.len() < MIN_MATCHES {
        return Err(no_consensus(matched.len(), used.len(), "ten that form like triangles in both clouds"));
    }
    let (source_center, source_radius) = middle_and_radius(source);
    let (target_center, target_radius) = middle_and_radius(target);
    let unit = source_radius.max(target_radius);
    if !(unit > 0.0 && unit.is_finite()) {
        return Err(no_consensus(matched.len(), 0, "points that span a surface"));
    }
    let mut mu = settings.initial_mu;
    let pairs: Vec<[Vector3<f64>; 2]> = used
        .iter()
        .map(|&i| [(matched.source[i] - source_center) / unit, (matched.target[i] - target_center) / unit])
        .collect();

    let mut pose = Similarity::identity();
    for iteration in 0..settings.iterations {
        let mut equations = NormalEquations::new();
        for [p, q] in &pairs {
            let landed = pose.apply(*p);
            let off = landed - q;
            let line = mu / (off.norm_squared() + mu);
            for axis in 0..3 {
                equations.add(&rigid_jacobian(landed, Vector3::ith(axis, 1.0)), off[axis], line * line);
            }
        }
        let next = equations.solve(1e-12).and_then(|delta| moved(&pose, Vector3::zeros(), &delta));
        let Some(next) = next else { return Err(no_consensus(matched.len(), used.len(), "ten off one line")) };
        pose = next;
        if iteration % HOLD == 0 && mu > MAX_CORRESPONDENCE_DISTANCE {
            mu /= DIVISION_FACTOR;
        }
    }
    let own = |center: Vector3<f64>| Similarity { scale: unit, rotation: Rotation3::identity(), translation: center };
    let target_from_source = own(target_center).compose(&pose).compose(&own(source_center).inverse());
    Ok(Fgr {
        // Division and multiplication by the unit may round the scale.
        target_from_source: Similarity { scale: 1.0, ..target_from_source },
        used: used.into_iter().map(|i| matched.numbers[i]).collect(),
        mu: mu * unit * unit,
    })
}

/// Tuples of three matches with similar triangles, as a flat list that may contain repetitions.
fn tuples(matched: &Matched, scale: f64, settings: &FgrSettings) -> Vec<usize> {
    let n = matched.len();
    let mut random = Random::new(settings.seed, STREAM);
    let mut used = Vec::new();
    let alike = |i: usize, j: usize| {
        let source = (matched.source[i] - matched.source[j]).norm();
        let target = (matched.target[i] - matched.target[j]).norm();
        source * scale < target && target * scale < source
    };
    for _ in 0..n * TRIALS_PER_MATCH {
        if used.len() >= 3 * MAX_TUPLES {
            break;
        }
        let [i, j, k] = [0; 3].map(|_| random.below(n));
        if alike(i, j) && alike(j, k) && alike(k, i) {
            used.extend([i, j, k]);
        }
    }
    used
}

/// The mean of the points, and their maximum distance from it.
fn middle_and_radius(points: &[Vec3]) -> (Vector3<f64>, f64) {
    let mean = points.iter().map(|&p| vector3(p)).sum::<Vector3<f64>>() / points.len() as f64;
    (mean, points.iter().map(|&p| (vector3(p) - mean).norm()).fold(0.0, f64::max))
}
