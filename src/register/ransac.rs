//! Guarded Sim(3) RANSAC over correspondences (paper §3.2).
//!
//! With an unconstrained scale, RANSAC maximises inliers by shrinking the mesh into a patch of the observation. The
//! loop therefore compares the scale of each hypothesis with the initial one: outside [λmin, λmax]·s_init, the
//! hypothesis is rejected (or, in clamp mode, its scale is projected back).

use super::matching::Match;
pub use super::options::GuardMode;
use super::tukey::biweights;
use super::umeyama::{Pair, ScaleMode, umeyama};
use crate::error::{Error, ErrorCode, Result};
use crate::geometry::random::Random;
use crate::geometry::similarity::{Similarity, vector3};
use crate::report::Counts;
use crate::scheduler::Scheduler;

const STREAM: u64 = 3;

/// Iterations of [`reweighted`]; the weights converge within a few.
const REWEIGHTINGS: usize = 12;

/// Rounding error of f32 coordinates in a unit box.
const ROUNDING: f64 = 1e-6;

/// Maximum number of closed-form refits of a new best hypothesis.
const LOCAL_REFITS: usize = 4;

/// Number of pairs by which hypotheses are judged, at most: evenly many of all. The inliers are those of all pairs.
const JUDGES: usize = 20_000;

/// Units of work between two yield points, of a draw, and of the distance of a pair.
const STRIDE: f64 = 1.0;
const DRAW: f64 = 2e-4;
const DISTANCE: f64 = 6e-6;

/// Units of work of a pair that is collected, and of one that is weighed.
const COLLECTED: f64 = 3e-5;
const WEIGHED: f64 = 5e-5;

/// Pairs that are collected between two yield points.
const CHUNK: usize = 1 << 16;

/// The interval of permitted scales, in the frames of the matched clouds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Guard {
    /// Smallest scale.
    pub min: f64,
    /// Largest scale.
    pub max: f64,
    /// Treatment of scales outside the interval.
    pub mode: GuardMode,
}

impl Guard {
    /// Whether a scale is at a bound.
    pub fn is_bound(&self, scale: f64) -> bool {
        scale <= self.min * (1.0 + ROUNDING) || scale >= self.max * (1.0 - ROUNDING)
    }
}

/// Settings of [`ransac`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RansacSettings {
    /// Maximum distance of an inlier, in the target frame.
    pub inlier_distance: f64,
    /// Minimum ratio of the smallest to the largest edge scale within a minimal set, in [0, 1].
    pub edge_similarity: f64,
    /// Maximum number of minimal sets.
    pub max_iterations: usize,
    /// RANSAC stops once it has found the best consensus with this probability, in [0, 1).
    pub confidence: f64,
    /// Whether the scale is estimated or fixed.
    pub scale_mode: ScaleMode,
    /// Bounds of the scale; `None` for an unconstrained scale (ablation).
    pub guard: Option<Guard>,
    /// Seed of the draws.
    pub seed: u64,
}

/// The best hypothesis.
#[derive(Debug, Clone, PartialEq)]
pub struct Consensus {
    /// The transform.
    pub target_from_source: Similarity,
    /// Indices of the inliers.
    pub inliers: Vec<usize>,
    /// Whether the scale was projected to a bound of the guard.
    pub clamped: bool,
    /// Matches, inliers and events; what RANSAC does not count is 0.
    pub counts: Counts,
}

/// Estimates the similarity with the highest consensus (MSAC scoring: near inliers count more).
///
/// # Errors
/// [`ErrorCode::NoConsensus`] for fewer than three matches, or if no hypothesis inside the guard has three inliers.
pub async fn ransac(
    source: &[glam::Vec3],
    target: &[glam::Vec3],
    matches: &[Match],
    settings: &RansacSettings,
    scheduler: &Scheduler,
) -> Result<Consensus> {
    let (numbers, pairs) = pairs_of(source, target, matches, scheduler).await;
    let mut search = Search::new(&pairs, settings);
    while pairs.len() >= 3 && scheduler.may_continue(search.counts.iterations > 0) {
        let (work, is_over) = search.advance(&pairs, settings);
        scheduler.yield_after(work).await;
        if is_over {
            break;
        }
    }
    scheduler.yield_after(COLLECTED * pairs.len() as f64).await;
    let mut consensus = search.consensus(&numbers, &pairs, settings)?;
    consensus.counts.matches = matches.len();
    Ok(consensus)
}

/// The pairs of matches, and their indices. Skips matches of points that do not exist.
async fn pairs_of(
    source: &[glam::Vec3],
    target: &[glam::Vec3],
    matches: &[Match],
    scheduler: &Scheduler,
) -> (Vec<usize>, Vec<Pair>) {
    let (mut numbers, mut pairs) = (Vec::with_capacity(matches.len()), Vec::with_capacity(matches.len()));
    for from in (0..matches.len()).step_by(CHUNK) {
        for (i, m) in matches.iter().enumerate().skip(from).take(CHUNK) {
            let Some(pair) = pair_of(source, target, m) else { continue };
            numbers.push(i);
            pairs.push(pair);
        }
        scheduler.yield_after(COLLECTED * CHUNK as f64).await;
    }
    (numbers, pairs)
}

/// The points of a match; `None` if one does not exist.
pub(super) fn pair_of(source: &[glam::Vec3], target: &[glam::Vec3], m: &Match) -> Option<Pair> {
    let (source, target) = (source.get(m.source as usize)?, target.get(m.target as usize)?);
    Some(Pair { source: vector3(*source), target: vector3(*target), weight: 1.0 })
}

/// A search for the best hypothesis.
struct Search {
    /// The pairs that judge hypotheses.
    judges: Vec<Pair>,
    random: Random,
    needed: usize,
    counts: Counts,
    best: Option<Hypothesis>,
}

impl Search {
    #[inline(never)]
    fn new(pairs: &[Pair], settings: &RansacSettings) -> Self {
        Self {
            judges: pairs.iter().step_by(pairs.len().div_ceil(JUDGES).max(1)).copied().collect(),
            random: Random::new(settings.seed, STREAM),
            needed: settings.max_iterations,
            counts: Counts::default(),
            best: None,
        }
    }

    /// Draws for about [`STRIDE`] units of work. Returns what it took, and whether no draw is left.
    #[inline(never)]
    fn advance(&mut self, pairs: &[Pair], settings: &RansacSettings) -> (f64, bool) {
        let Self { judges, random, needed, counts, best } = self;
        let mut work = 0.0;
        while counts.iterations < *needed && work < STRIDE {
            work += DRAW;
            counts.iterations += 1;
            let minimal_set = draw_three(random, pairs);
            if !edges_agree(&minimal_set, settings.edge_similarity) {
                counts.inconsistent += 1;
                continue;
            }
            let Some(hypothesis) = fit(minimal_set.iter(), settings, counts) else { continue };
            work += DISTANCE * judges.len() as f64;
            let score = score(&hypothesis.transform, judges, settings.inlier_distance);
            if best.as_ref().is_none_or(|b| score > b.score) {
                work += (2 * LOCAL_REFITS) as f64 * DISTANCE * judges.len() as f64;
                let improved = refit(Hypothesis { score, ..hypothesis }, judges, settings);
                let agreeing = inliers(&improved.transform, judges, settings.inlier_distance).len();
                let share = agreeing as f64 / judges.len() as f64;
                *needed = (*needed).min(iterations_needed(share, settings.confidence));
                *best = Some(improved);
            }
        }
        (work, counts.iterations >= *needed)
    }

    /// The consensus of all pairs on the best hypothesis.
    #[inline(never)]
    fn consensus(self, numbers: &[usize], pairs: &[Pair], settings: &RansacSettings) -> Result<Consensus> {
        let Self { best, counts, .. } = self;
        let consensus = best.map(|b| (inliers(&b.transform, pairs, settings.inlier_distance), b));
        match consensus {
            Some((inliers, b)) if inliers.len() >= 3 => {
                let inliers: Vec<usize> = inliers.into_iter().map(|i| numbers[i]).collect();
                let counts = Counts { inliers: inliers.len(), ..counts };
                Ok(Consensus { target_from_source: b.transform, inliers, clamped: b.clamped, counts })
            }
            _ => Err(no_consensus(pairs.len(), &counts)),
        }
    }
}

/// Refits a consensus on its inliers by iteratively reweighted least squares, which excludes matches that are near by
/// chance. Keeps the last pose if too few remain for the closed form, or if the scale leaves the guard.
pub async fn reweighted(
    source: &[glam::Vec3],
    target: &[glam::Vec3],
    matches: &[Match],
    consensus: &Consensus,
    settings: &RansacSettings,
    scheduler: &Scheduler,
) -> Similarity {
    let mut inliers: Vec<Pair> = Vec::with_capacity(consensus.inliers.len());
    inliers.extend(consensus.inliers.iter().filter_map(|&i| pair_of(source, target, matches.get(i)?)));
    let mut best = consensus.target_from_source;
    if consensus.clamped {
        return best;
    }
    for _ in 0..REWEIGHTINGS {
        scheduler.yield_after(WEIGHED * inliers.len() as f64).await;
        let residuals: Vec<f64> = inliers.iter().map(|pair| residual_squared(&best, pair).sqrt()).collect();
        for (pair, weight) in inliers.iter_mut().zip(biweights(&residuals, ROUNDING)) {
            pair.weight = weight;
        }
        scheduler.yield_after(WEIGHED * inliers.len() as f64).await;
        let Ok(next) = umeyama(inliers.iter().copied(), settings.scale_mode) else { break };
        if settings.guard.is_some_and(|guard| next.scale < guard.min || next.scale > guard.max) {
            break;
        }
        best = next;
    }
    best
}

#[derive(Debug, Clone, Copy)]
struct Hypothesis {
    transform: Similarity,
    clamped: bool,
    score: f64,
}

fn draw_three(random: &mut Random, pairs: &[Pair]) -> [Pair; 3] {
    let n = pairs.len();
    let a = random.below(n);
    // Draws from the n − 1 (n − 2) others: three distinct pairs in exactly three draws.
    let b = (a + 1 + random.below(n - 1)) % n;
    let (low, high) = (a.min(b), a.max(b));
    let mut c = random.below(n - 2);
    c += usize::from(c >= low);
    c += usize::from(c >= high);
    [pairs[a], pairs[b], pairs[c]]
}

/// Whether the scales of the three edges agree, as for a similarity.
fn edges_agree(set: &[Pair; 3], edge_similarity: f64) -> bool {
    let stretch = |i: usize, j: usize| (set[i].target - set[j].target).norm() / (set[i].source - set[j].source).norm();
    let ratios = [stretch(0, 1), stretch(1, 2), stretch(2, 0)];
    let (min, max) = ratios.iter().fold((f64::INFINITY, 0.0_f64), |(min, max), &r| (min.min(r), max.max(r)));
    // Edges between coincident points have a scale of 0, ∞ or NaN, and agree with nothing.
    ratios.iter().all(|r| r.is_finite()) && min >= edge_similarity * max && min > 0.0
}

/// The closed form on some pairs, subject to the guard.
fn fit<'a>(
    pairs: impl Iterator<Item = &'a Pair> + Clone,
    settings: &RansacSettings,
    counts: &mut Counts,
) -> Option<Hypothesis> {
    let transform = umeyama(pairs.clone().copied(), settings.scale_mode).ok()?;
    let Some(guard) = settings.guard else { return Some(Hypothesis { transform, clamped: false, score: 0.0 }) };
    // Unlike `clamp`, this does not panic if the bounds are swapped.
    let scale = transform.scale.min(guard.max).max(guard.min);
    if scale == transform.scale {
        return Some(Hypothesis { transform, clamped: false, score: 0.0 });
    }
    match guard.mode {
        GuardMode::Reject => {
            counts.rejected += 1;
            None
        }
        GuardMode::Clamp => {
            counts.clamped += 1;
            let transform = umeyama(pairs.copied(), ScaleMode::Fixed(scale)).ok()?;
            Some(Hypothesis { transform, clamped: true, score: 0.0 })
        }
    }
}

/// Refits on the inliers while the score increases.
fn refit(mut best: Hypothesis, pairs: &[Pair], settings: &RansacSettings) -> Hypothesis {
    // The counts are those of minimal sets; refits are not counted.
    let mut uncounted = Counts::default();
    for _ in 0..LOCAL_REFITS {
        let inliers = inliers(&best.transform, pairs, settings.inlier_distance);
        let Some(refitted) = fit(inliers.iter().map(|&i| &pairs[i]), settings, &mut uncounted) else { break };
        let score = score(&refitted.transform, pairs, settings.inlier_distance);
        if score <= best.score {
            break;
        }
        best = Hypothesis { score, ..refitted };
    }
    best
}

fn residual_squared(transform: &Similarity, pair: &Pair) -> f64 {
    (transform.apply(pair.source) - pair.target).norm_squared()
}

/// Σ max(0, 1 − r²/d²).
fn score(transform: &Similarity, pairs: &[Pair], distance: f64) -> f64 {
    let limit = distance * distance;
    pairs.iter().map(|pair| (1.0 - residual_squared(transform, pair) / limit).max(0.0)).sum()
}

fn inliers(transform: &Similarity, pairs: &[Pair], distance: f64) -> Vec<usize> {
    let near = |pair: &Pair| residual_squared(transform, pair) <= distance * distance;
    pairs.iter().enumerate().filter(|(_, pair)| near(pair)).map(|(i, _)| i).collect()
}

/// Number of draws after which a minimal set of inliers was drawn with the given probability.
fn iterations_needed(inlier_share: f64, confidence: f64) -> usize {
    let hit = inlier_share * inlier_share * inlier_share;
    if hit >= 1.0 {
        return 1;
    }
    // Saturates for ratios near 0; `max_iterations` then applies.
    libm::ceil(libm::log(1.0 - confidence) / libm::log1p(-hit)) as usize
}

fn no_consensus(matches: usize, counts: &Counts) -> Error {
    Error::new(
        ErrorCode::NoConsensus,
        "mesh",
        format!(
            "{matches} matches; of {} minimal sets {} had inconsistent edges and {} a scale out of bounds",
            counts.iterations, counts.inconsistent, counts.rejected
        ),
        "at least three matches of mesh and observation that agree on one transform inside the guard",
        "Check that mesh and mask show the same object; widen options.guard, or raise options.voxelDivisions for small details.",
    )
}
