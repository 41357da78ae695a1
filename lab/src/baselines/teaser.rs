//! TEASER++ (Yang, Shi, Carlone, "TEASER: Fast and Certifiable Point Cloud Registration", T-RO 2021), without its
//! certificate: decoupled estimation of scale, rotation and translation.
//!
//! 1. Scale by adaptive voting over the ratios of lengths, or known.
//! 2. Matches that pairwise preserve lengths: the maximum clique, found exactly within a budget of work; beyond it the
//!    innermost core, which KISS-Matcher (Lim et al. 2025) always uses.
//! 3. Rotation by graduated non-convexity on the vectors between the remaining matches.
//! 4. Translation by adaptive voting per axis.
//!
//! Intentional differences: a rotation is fitted to vectors across the whole set ([`TeaserSettings::links`]), where
//! TEASER++ chains each match to the next, which in the order of a voxel grid is its neighbour: short vectors are
//! mostly noise. Large sets of length ratios are subsampled. Failure is an error, not the identity.

use super::clique::Graph;
use super::gnc::{Turns, gnc_tls};
use super::measurements::{Matched, links, no_consensus};
use super::voting::vote;
use crate::prelude::*;
use sim3align::register::umeyama::ScaleMode;
use sim3align_geometry::number::number;

/// Minimum number of matches.
const MIN_MATCHES: usize = 3;

/// Approximate number of length ratios that vote on the scale.
const MAX_RATIOS: usize = 250_000;

/// Budget of the search for the maximum clique, in words of bitsets: about half a second.
const CLIQUE_BUDGET: u64 = 300_000_000;

/// Selection of the matches for rotation and translation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InlierSelection {
    /// The maximum clique of pairwise compatible matches, or the innermost core if the budget is exceeded.
    LargestClique,
    /// The innermost core.
    InnermostCore,
    /// All.
    None,
}

/// Settings of [`solve`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TeaserSettings {
    /// Noise bound β, in the unit of the target, above 0.
    pub noise_bound: f64,
    /// Whether the scale is estimated or fixed.
    pub scale: ScaleMode,
    /// Selection of matches.
    pub selection: InlierSelection,
    /// Number of vectors per match for the rotation; 1 is the chain of TEASER++.
    pub links: usize,
    /// Maximum number of matches; more are subsampled evenly. 5000 take 3 MB and 12.5 million comparisons.
    pub max_matches: usize,
    /// Seed of the subsampling.
    pub seed: u64,
}

impl TeaserSettings {
    /// Default settings.
    pub fn new(noise_bound: f64, scale: ScaleMode) -> Self {
        let selection = InlierSelection::LargestClique;
        Self { noise_bound, scale, selection, links: 32, max_matches: 5000, seed: 0 }
    }
}

/// Result of [`solve`].
#[derive(Debug, Clone, PartialEq)]
pub struct Teaser {
    /// The transform.
    pub target_from_source: Similarity,
    /// Indices of the matches selected for rotation and translation.
    pub selected: Vec<usize>,
    /// The selected matches within the noise bound along every axis.
    pub inliers: Vec<usize>,
    /// Whether the selection is proven to be the maximum clique.
    pub is_largest_clique: bool,
}

/// Estimates the similarity from corresponding points. With [`Turns::About`] the vertical, this is Quatro (Lim et al., "A
/// Single Correspondence Is Enough", ICRA 2022): fewer correct matches suffice for the rotation about it.
///
/// # Errors
/// [`ErrorCode::NoConsensus`] if fewer than three matches agree or their rotation is undetermined;
/// [`ErrorCode::WrongLength`], [`ErrorCode::NonFinite`], [`ErrorCode::InvalidOption`] for a noise bound or a scale that
/// is not above 0.
pub fn solve(
    source: &[Vector3<f64>],
    target: &[Vector3<f64>],
    settings: &TeaserSettings,
    turns: Turns,
) -> Result<Teaser> {
    let matched = Matched::from_points(source, target)?;
    let beta = positive("options.noiseBound", settings.noise_bound)?;
    let count = matched.len();
    let too_few = |agreeing: usize| no_consensus(count, agreeing, "three that are not on one line");
    if count < MIN_MATCHES {
        return Err(too_few(count));
    }
    let matched = matched.thinned(settings.max_matches.max(MIN_MATCHES), settings.seed);
    let scale = match settings.scale {
        ScaleMode::Fixed(scale) => positive("options.scale", scale)?,
        ScaleMode::Free => voted_scale(&matched, beta, settings.seed).ok_or_else(|| too_few(0))?,
    };
    let (indices, is_largest_clique) = select(&matched, scale, beta, settings.selection);
    if indices.len() < MIN_MATCHES {
        return Err(too_few(indices.len()));
    }
    let selected = matched.select(&indices);

    let mut vectors = selected.differences(&links(selected.len(), settings.links.max(1), settings.seed));
    vectors.iter_mut().for_each(|[a, _]| *a *= scale);
    // The noise bound of the difference of two points is twice that of a point.
    let rotation = gnc_tls(&vectors, 2.0 * beta, turns).ok_or_else(|| too_few(indices.len()))?.rotation;
    let (translation, agrees) = voted_translation(&selected, scale, rotation, beta).ok_or_else(|| too_few(0))?;
    let inliers: Vec<usize> = (0..selected.len()).filter(|&i| agrees[i]).map(|i| selected.numbers[i]).collect();
    if inliers.len() < MIN_MATCHES {
        return Err(too_few(inliers.len()));
    }
    let target_from_source = Similarity { scale, rotation, translation };
    Ok(Teaser { target_from_source, selected: selected.numbers, inliers, is_largest_clique })
}

fn positive(argument: &'static str, value: f64) -> Result<f64> {
    if value.is_finite() && value > 0.0 {
        return Ok(value);
    }
    let remedy = "Leave it out, or pass it in the unit of the target's points.";
    Err(Error::new(ErrorCode::InvalidOption, argument, number(value), "a number above 0", remedy))
}

/// The scale with the most votes among the length ratios. A length has a noise bound of 2β.
fn voted_scale(matched: &Matched, beta: f64, seed: u64) -> Option<f64> {
    let pairs = links(matched.len(), (MAX_RATIOS / matched.len()).max(1), seed);
    let (mut ratios, mut ranges) = (Vec::with_capacity(pairs.len()), Vec::with_capacity(pairs.len()));
    for [a, b] in matched.differences(&pairs) {
        let length = a.norm();
        // Coincident points have no ratio.
        if length > 0.0 {
            ratios.push(b.norm() / length);
            ranges.push(2.0 * beta / length);
        }
    }
    vote(&ratios, &ranges).map(|vote| vote.value).filter(|scale| *scale > 0.0)
}

/// Indices of the selected matches, and whether they are proven to be the maximum clique.
fn select(matched: &Matched, scale: f64, beta: f64, selection: InlierSelection) -> (Vec<usize>, bool) {
    if selection == InlierSelection::None {
        return ((0..matched.len()).collect(), false);
    }
    let mut graph = Graph::new(matched.len());
    for i in 0..matched.len() {
        for j in 0..i {
            let (a, b) = (matched.source[i] - matched.source[j], matched.target[i] - matched.target[j]);
            if (b.norm() - scale * a.norm()).abs() <= 2.0 * beta {
                graph.connect(i, j);
            }
        }
    }
    if selection == InlierSelection::LargestClique {
        let clique = graph.largest_clique(CLIQUE_BUDGET);
        if clique.is_largest {
            return (clique.vertices, true);
        }
    }
    (graph.innermost_core(), false)
}

/// The translation, and the matches that agree with it along every axis.
fn voted_translation(
    matched: &Matched,
    scale: f64,
    rotation: Rotation3<f64>,
    beta: f64,
) -> Option<(Vector3<f64>, Vec<bool>)> {
    let (mut translation, mut agrees) = (Vector3::zeros(), vec![true; matched.len()]);
    let ranges = vec![beta; matched.len()];
    for axis in 0..3 {
        let off = |(a, b): (&Vector3<f64>, &Vector3<f64>)| b[axis] - (rotation * a)[axis] * scale;
        let offsets: Vec<f64> = matched.source.iter().zip(&matched.target).map(off).collect();
        let vote = vote(&offsets, &ranges)?;
        translation[axis] = vote.value;
        agrees.iter_mut().zip(vote.agreeing).for_each(|(all, this)| *all &= this);
    }
    Some((translation, agrees))
}
