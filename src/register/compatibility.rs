//! Poses from mostly incorrect matches with a known scale. Correct matches preserve the distances between their points,
//! so that they have many compatible matches in common (second-order spatial compatibility: Chen et al., "SC²-PCR",
//! CVPR 2022).

use glam::Vec3;

use super::matching::Match;
use super::ransac::pair_of;
use super::umeyama::{Pair, ScaleMode, umeyama};
use crate::geometry::order::{index_of, pack, select_smallest, sort};
use crate::geometry::similarity::Similarity;
use crate::scheduler::Scheduler;

/// Number of compatible matches from which the first pose of a seed is computed.
const SEED_NEIGHBORS: usize = 30;

/// Power iterations that compute their weights.
const POWER_ROUNDS: usize = 10;

/// Maximum number of closed-form refits on the inliers.
const REFITS: usize = 5;

/// Units of work of two matches that are compared, of a word of bits of two matches, and of a match that is tested.
const COMPARED: f64 = 1e-5;
const WORD: f64 = 1e-6;
const TESTED: f64 = 2e-5;

/// A pose and its consensus.
#[derive(Debug, Clone, PartialEq)]
pub struct Hypothesis {
    /// The transform.
    pub target_from_source: Similarity,
    /// Indices of the inliers.
    pub inliers: Vec<usize>,
    /// Σ (1 − r²/d²) over the inliers.
    pub score: f64,
}

/// Up to `count` poses of scale 1 from disjoint seeds, those with the highest compatibility first. A match within
/// `distance` is an inlier. Empty if a match refers to a point that does not exist.
pub async fn hypotheses(
    source: &[Vec3],
    target: &[Vec3],
    matches: &[Match],
    distance: f32,
    count: usize,
    scheduler: &Scheduler,
) -> Vec<Hypothesis> {
    let pairs: Option<Vec<Pair>> = matches.iter().map(|m| pair_of(source, target, m)).collect();
    let Some(pairs) = pairs else { return Vec::new() };
    let ends: Vec<(Vec3, Vec3)> =
        matches.iter().map(|m| (source[m.source as usize], target[m.target as usize])).collect();
    let mut graph = Graph::new(ends.len());
    for i in 0..ends.len() {
        graph.connect(i, &ends, distance);
        scheduler.yield_after(COMPARED * (ends.len() - i) as f64).await;
    }
    let mut order: Vec<u64> = Vec::with_capacity(pairs.len());
    for i in 0..pairs.len() {
        order.push(pack(-graph.weight(i), i as u32));
        scheduler.yield_after(WORD * graph.words as f64 * f64::from(1 + graph.common(i, i))).await;
    }
    sort(&mut order);
    let mut taken = vec![false; pairs.len()];
    let mut found: Vec<Hypothesis> = Vec::new();
    for seed in order.into_iter().map(|key| index_of(key) as usize) {
        if found.len() >= count || !scheduler.may_continue(!found.is_empty()) {
            break;
        }
        if taken[seed] {
            continue;
        }
        scheduler.yield_after(TESTED * (REFITS * pairs.len()) as f64).await;
        let Some(first) = graph.consensus(seed, &pairs) else { continue };
        let Some(hypothesis) = refit(first, &pairs, f64::from(distance)) else { continue };
        taken[seed] = true;
        for &i in &hypothesis.inliers {
            taken[i] = true;
        }
        found.push(hypothesis);
    }
    found
}

/// The compatibility graph: a bit per pair of matches, set if the pair preserves its distance.
struct Graph {
    words: usize,
    rows: Vec<u64>,
}

impl Graph {
    fn new(count: usize) -> Self {
        let words = count.div_ceil(64);
        Self { words, rows: vec![0; words * count] }
    }

    /// Connects a match with the compatible ones after it, by the points of all.
    fn connect(&mut self, i: usize, ends: &[(Vec3, Vec3)], tolerance: f32) {
        let Self { words, rows } = self;
        let (p, q) = ends[i];
        for (j, (other_p, other_q)) in ends.iter().enumerate().skip(i + 1) {
            let (a, b) = (p.distance(*other_p), q.distance(*other_q));
            // Short distances are preserved by any pose.
            if (a - b).abs() < tolerance && a.min(b) > tolerance {
                rows[i * *words + j / 64] |= 1 << (j % 64);
                rows[j * *words + i / 64] |= 1 << (i % 64);
            }
        }
    }

    fn row(&self, i: usize) -> &[u64] {
        &self.rows[i * self.words..(i + 1) * self.words]
    }

    fn companions(&self, i: usize) -> impl Iterator<Item = usize> {
        self.row(i)
            .iter()
            .enumerate()
            .flat_map(|(word, &bits)| (0..64).filter(move |bit| bits >> bit & 1 == 1).map(move |bit| 64 * word + bit))
    }

    fn are_compatible(&self, i: usize, j: usize) -> bool {
        self.row(i)[j / 64] >> (j % 64) & 1 == 1
    }

    /// Number of matches compatible with both.
    fn common(&self, i: usize, j: usize) -> u32 {
        self.row(i).iter().zip(self.row(j)).map(|(a, b)| (a & b).count_ones()).sum()
    }

    /// Twice the number of triangles that contain a match.
    fn weight(&self, i: usize) -> f32 {
        self.companions(i).map(|j| self.common(i, j)).sum::<u32>() as f32
    }

    /// The pose of a seed and its most compatible matches, weighted by the principal eigenvector of their affinity.
    fn consensus(&self, seed: usize, pairs: &[Pair]) -> Option<Similarity> {
        let mut keys: Vec<u64> =
            self.companions(seed).map(|j| pack(-(self.common(seed, j) as f32), j as u32)).collect();
        select_smallest(&mut keys, SEED_NEIGHBORS);
        keys.truncate(SEED_NEIGHBORS);
        sort(&mut keys);
        let mut members = vec![seed];
        members.extend(keys.into_iter().map(|key| index_of(key) as usize));
        let n = members.len();
        let mut affinity = vec![0.0; n * n];
        for (a, b) in (0..n).flat_map(|a| (0..a).map(move |b| (a, b))) {
            if self.are_compatible(members[a], members[b]) {
                let common = f64::from(self.common(members[a], members[b]));
                (affinity[a * n + b], affinity[b * n + a]) = (common, common);
            }
        }
        let mut weights = vec![1.0; n];
        for _ in 0..POWER_ROUNDS {
            let next: Vec<f64> =
                affinity.chunks_exact(n).map(|row| row.iter().zip(&weights).map(|(a, w)| a * w).sum()).collect();
            let largest = next.iter().fold(0.0, |m: f64, x| m.max(*x));
            if largest <= 0.0 {
                return None;
            }
            weights = next.into_iter().map(|x| x / largest).collect();
        }
        let weighted = members.iter().zip(weights).map(|(&i, weight)| Pair { weight, ..pairs[i] });
        umeyama(weighted, ScaleMode::Fixed(1.0)).ok()
    }
}

/// Refits on the inliers while the score increases.
fn refit(first: Similarity, pairs: &[Pair], distance: f64) -> Option<Hypothesis> {
    let agree = |pose: Similarity| {
        let (mut inliers, mut score) = (Vec::new(), 0.0);
        for (i, pair) in pairs.iter().enumerate() {
            let share = 1.0 - (pose.apply(pair.source) - pair.target).norm_squared() / (distance * distance);
            if share > 0.0 {
                inliers.push(i);
                score += share;
            }
        }
        Hypothesis { target_from_source: pose, inliers, score }
    };
    let mut best = agree(first);
    for _ in 0..REFITS {
        let Ok(pose) = umeyama(best.inliers.iter().map(|&i| pairs[i]), ScaleMode::Fixed(1.0)) else { break };
        let next = agree(pose);
        if next.score <= best.score {
            break;
        }
        best = next;
    }
    (best.inliers.len() >= 3).then_some(best)
}
