//! TEASER++ (Yang, Shi, Carlone, "TEASER: Fast and Certifiable Point Cloud Registration", T-RO 2021), without its
//! certificate: scale, then rotation, then translation, each of what does not depend on the next.
//!
//! 1. Scale by adaptive voting over the ratios of lengths, or known.
//! 2. Matches that agree pairwise on lengths: the largest clique, found exactly within a budget of work; beyond it the
//!    innermost core, as KISS-Matcher (Lim et al. 2025) has it always.
//! 3. Rotation by graduated non-convexity on the vectors between the matches that are left.
//! 4. Translation by adaptive voting, axis by axis.
//!
//! On purpose otherwise: a rotation is fitted to vectors across the whole set ([`TeaserSettings::links`]), where TEASER++
//! chains each match to the next, which in the order of a voxel grid is its neighbour: short vectors are mostly noise.
//! Ratios of lengths are drawn where there are very many of them. What has no answer is an error, not the identity.

use nalgebra::{Rotation3, Vector3};

use super::clique::Graph;
use super::gnc::{Turns, gnc_tls};
use super::measurements::{Matched, links, no_consensus};
use super::voting::vote;
use sim3align::register::umeyama::ScaleMode;
use sim3align_geometry::error::{Error, ErrorCode, Result};
use sim3align_geometry::number::number;
use sim3align_geometry::similarity::Similarity;

/// Matches that an answer needs.
const MIN_MATCHES: usize = 3;

/// Ratios of lengths that vote on the scale, about.
const MAX_RATIOS: usize = 250_000;

/// Words of bitsets that the search for the largest clique may look at: about half a second.
const CLIQUE_BUDGET: u64 = 300_000_000;

/// Which matches rotation and translation are estimated from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InlierSelection {
    /// The largest clique of matches that agree pairwise; the innermost core where it is not found within the budget.
    LargestClique,
    /// The innermost core.
    InnermostCore,
    /// All.
    None,
}

/// Settings of [`solve`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TeaserSettings {
    /// β: how far a right match may be off, in the target's unit, above 0.
    pub noise_bound: f64,
    /// Whether the scale is estimated, or known.
    pub scale: ScaleMode,
    /// Which matches are left out.
    pub selection: InlierSelection,
    /// Vectors for each match that the rotation is fitted to; 1 is TEASER++'s chain.
    pub links: usize,
    /// Matches that are used at most: an even share of more. 5000 take 3 MB and 12.5 million comparisons.
    pub max_matches: usize,
    /// Seed of the share.
    pub seed: u64,
}

impl TeaserSettings {
    /// The usual ones.
    pub fn new(noise_bound: f64, scale: ScaleMode) -> Self {
        let selection = InlierSelection::LargestClique;
        Self { noise_bound, scale, selection, links: 32, max_matches: 5000, seed: 0 }
    }
}

/// What [`solve`] found.
#[derive(Debug, Clone, PartialEq)]
pub struct Teaser {
    /// The transform.
    pub target_from_source: Similarity,
    /// The matches that rotation and translation were estimated from, by their numbers.
    pub selected: Vec<usize>,
    /// Those of them that are within the noise bound along every axis.
    pub inliers: Vec<usize>,
    /// Whether they are certainly the largest clique.
    pub is_largest_clique: bool,
}

/// The similarity that takes matched points to each other, the first to the first.
///
/// # Errors
/// [`ErrorCode::NoConsensus`] where fewer than three matches agree or their rotation is free; [`ErrorCode::WrongLength`],
/// [`ErrorCode::NonFinite`], [`ErrorCode::InvalidOption`] for a noise bound or a scale that is not above 0.
pub fn solve(source: &[Vector3<f64>], target: &[Vector3<f64>], settings: &TeaserSettings) -> Result<Teaser> {
    solve_with(&Matched::from_points(source, target)?, settings, Turns::All)
}

/// [`solve`], over some rotations only.
pub(super) fn solve_with(matched: &Matched, settings: &TeaserSettings, turns: Turns) -> Result<Teaser> {
    let beta = positive("options.noiseBound", settings.noise_bound)?;
    let count = matched.len();
    let too_few = |agreeing: usize| no_consensus(count, agreeing, "three that are not on one line");
    if count < MIN_MATCHES {
        return Err(too_few(count));
    }
    let matched = matched.clone().thinned(settings.max_matches.max(MIN_MATCHES), settings.seed);
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
    // The difference of two points is off by twice as much.
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

/// The scale that most ratios of lengths agree with. A length of the source is known to within 2β.
fn voted_scale(matched: &Matched, beta: f64, seed: u64) -> Option<f64> {
    let pairs = links(matched.len(), (MAX_RATIOS / matched.len()).max(1), seed);
    let (mut ratios, mut ranges) = (Vec::with_capacity(pairs.len()), Vec::with_capacity(pairs.len()));
    for [a, b] in matched.differences(&pairs) {
        let length = a.norm();
        // Points that coincide have no ratio.
        if length > 0.0 {
            ratios.push(b.norm() / length);
            ranges.push(2.0 * beta / length);
        }
    }
    vote(&ratios, &ranges).map(|vote| vote.value).filter(|scale| *scale > 0.0)
}

/// Indices of the matches that agree on lengths, and whether they are certainly the largest clique.
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

/// The translation, and which matches agree with it along every axis.
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
