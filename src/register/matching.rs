//! Matches of descriptors: mutual nearest neighbours (paper §3.2), supplemented by one-way matches.

use super::fpfh::{DIMENSION, Descriptor};
use crate::scheduler::Scheduler;

/// A correspondence: indices of a source point and a target point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Match {
    /// Index into the source cloud.
    pub source: u32,
    /// Index into the target cloud.
    pub target: u32,
}

/// The nearest target descriptor of each source descriptor, and the nearest source descriptor of each target descriptor
/// (Euclidean distance; ties go to the smaller index). Descriptors that are all 0 (points without neighbours) have none.
///
/// Brute force, |source| × |target| distances: in 33 dimensions, search trees visit most of their leaves.
pub struct Nearest {
    forward: Vec<Option<u32>>,
    backward: Vec<Option<u32>>,
}

/// Below this number of mutual matches, too few are correct.
const MIN_MUTUAL_MATCHES: usize = 50;

/// Comparisons of descriptors in a unit of work, and between two yield points.
const COMPARISONS: f64 = 60_000.0;
const STRIDE: usize = 1 << 18;

impl Nearest {
    /// Compares all descriptors.
    pub async fn of(source: &[Descriptor], target: &[Descriptor], scheduler: &Scheduler) -> Self {
        let mut found = [Vec::with_capacity(source.len()), Vec::with_capacity(target.len())];
        for (found, [descriptors, among]) in found.iter_mut().zip([[source, target], [target, source]]) {
            for some in descriptors.chunks((STRIDE / among.len().max(1)).max(1)) {
                found.extend(some.iter().map(|descriptor| nearest(descriptor, among)));
                scheduler.yield_after((some.len() * among.len()) as f64 / COMPARISONS).await;
            }
        }
        let [forward, backward] = found;
        Self { forward, backward }
    }

    /// All mutual nearest neighbours, in the order of the source.
    pub fn mutual(&self) -> Vec<Match> {
        let mutual = self.forward.iter().zip(0..).filter_map(|(&t, s)| {
            let t = t?;
            (self.backward.get(t as usize).copied().flatten() == Some(s)).then_some(Match { source: s, target: t })
        });
        mutual.collect()
    }

    /// The mutual matches or, if these are too few, the one-way matches, for a robust estimator.
    pub fn enough(&self) -> Vec<Match> {
        let mutual = self.mutual();
        if mutual.len() < MIN_MUTUAL_MATCHES { self.one_way() } else { mutual }
    }

    /// The nearest source descriptor for each target descriptor, in the order of the target. More pairs than the mutual
    /// ones, most of them incorrect; for targets so partial or noisy that few pairs are mutual.
    pub fn one_way(&self) -> Vec<Match> {
        self.backward.iter().zip(0..).filter_map(|(&s, t)| Some(Match { source: s?, target: t })).collect()
    }

    /// The mutual matches, followed by an even selection of the one-way matches of both directions, up to about `count` in
    /// total.
    pub fn best(&self, count: usize) -> Vec<Match> {
        let Self { forward, backward } = self;
        let (mut mutual, mut others) = (Vec::new(), Vec::new());
        for (&t, s) in forward.iter().zip(0..) {
            let Some(target) = t else { continue };
            let found = Match { source: s, target };
            if backward.get(target as usize).copied().flatten() == Some(s) {
                mutual.push(found)
            } else {
                others.push(found)
            }
        }
        for (&s, target) in backward.iter().zip(0..) {
            let Some(source) = s else { continue };
            if forward.get(source as usize).copied().flatten() != Some(target) {
                others.push(Match { source, target });
            }
        }
        let wanted = count.saturating_sub(mutual.len());
        if wanted > 0 {
            let step = others.len().div_ceil(wanted).max(1);
            mutual.extend(others.into_iter().step_by(step));
        }
        mutual
    }
}

/// Index of the nearest descriptor of `among`.
fn nearest(descriptor: &Descriptor, among: &[Descriptor]) -> Option<u32> {
    if is_empty(descriptor) {
        return None;
    }
    let mut best = (f32::INFINITY, None);
    for (candidate, index) in among.iter().zip(0..) {
        if let Some(distance) = distance_below(descriptor, candidate, best.0)
            && !is_empty(candidate)
        {
            best = (distance, Some(index));
        }
    }
    best.1
}

/// The squared distance if it is below `bound`. Most candidates exceed it after the first third.
fn distance_below(a: &Descriptor, b: &Descriptor, bound: f32) -> Option<f32> {
    let mut sum = 0.0;
    for (a, b) in a.chunks_exact(DIMENSION / 3).zip(b.chunks_exact(DIMENSION / 3)) {
        sum += a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f32>();
        if sum >= bound {
            return None;
        }
    }
    Some(sum)
}

fn is_empty(descriptor: &Descriptor) -> bool {
    descriptor.iter().all(|&bin| bin == 0.0)
}
