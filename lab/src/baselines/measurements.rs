//! Matched points, and the translation-invariant vectors between them.

use crate::prelude::*;
use sim3align::register::matching::Match;

/// Random stream of the subsampling.
const STREAM: u64 = 7;

/// Random stream of [`links`].
const LINKS_STREAM: u64 = 9;

/// Finite corresponding points.
#[derive(Debug, Clone, PartialEq)]
pub struct Matched {
    /// Points in the source frame.
    pub source: Vec<Vector3<f64>>,
    /// Corresponding points in the target frame.
    pub target: Vec<Vector3<f64>>,
    /// Index of each correspondence in the original list.
    pub numbers: Vec<usize>,
}

impl Matched {
    /// The points of matches; matches of points that do not exist are skipped.
    ///
    /// # Errors
    /// [`ErrorCode::NonFinite`].
    pub fn of(source: &[Vec3], target: &[Vec3], matches: &[Match]) -> Result<Self> {
        let mut matched = Self { source: Vec::new(), target: Vec::new(), numbers: Vec::new() };
        for (number, m) in matches.iter().enumerate() {
            if let (Some(&p), Some(&q)) = (source.get(m.source as usize), target.get(m.target as usize)) {
                matched.source.push(vector3(p));
                matched.target.push(vector3(q));
                matched.numbers.push(number);
            }
        }
        matched.checked()
    }

    /// Corresponding points, by position.
    ///
    /// # Errors
    /// [`ErrorCode::WrongLength`] if the lengths differ, [`ErrorCode::NonFinite`].
    pub fn from_points(source: &[Vector3<f64>], target: &[Vector3<f64>]) -> Result<Self> {
        if source.len() != target.len() {
            return Err(Error::new(
                ErrorCode::WrongLength,
                "correspondences",
                format!("{} source points and {} target points", source.len(), target.len()),
                "as many of both",
                "Repeat a point that has several counterparts.",
            ));
        }
        Self { source: source.to_vec(), target: target.to_vec(), numbers: (0..source.len()).collect() }.checked()
    }

    fn checked(self) -> Result<Self> {
        let finite = |points: &[Vector3<f64>]| points.iter().all(|p| p.iter().all(|x| x.is_finite()));
        if finite(&self.source) && finite(&self.target) {
            return Ok(self);
        }
        Err(Error::new(
            ErrorCode::NonFinite,
            "correspondences",
            "a coordinate that is not finite",
            "finite numbers",
            "Leave points without a reading out.",
        ))
    }

    /// Number of correspondences.
    pub fn len(&self) -> usize {
        self.numbers.len()
    }

    /// Whether there are no correspondences.
    pub fn is_empty(&self) -> bool {
        self.numbers.is_empty()
    }

    /// The correspondences at `indices`.
    pub fn select(&self, indices: &[usize]) -> Self {
        Self {
            source: indices.iter().map(|&i| self.source[i]).collect(),
            target: indices.iter().map(|&i| self.target[i]).collect(),
            numbers: indices.iter().map(|&i| self.numbers[i]).collect(),
        }
    }

    /// At most `count` correspondences, one drawn from each of `count` equal intervals.
    pub fn thinned(self, count: usize, seed: u64) -> Self {
        if self.len() <= count {
            return self;
        }
        let drawn: Vec<usize> = Random::new(seed, STREAM).one_of_each_run(self.len(), count).collect();
        self.select(&drawn)
    }

    /// The vectors from the first to the second of each pair, in both frames.
    pub fn differences(&self, pairs: &[[usize; 2]]) -> Vec<[Vector3<f64>; 2]> {
        pairs.iter().map(|&[i, j]| [self.source[j] - self.source[i], self.target[j] - self.target[i]]).collect()
    }
}

/// Pairs of `n` points: each with those `count` places further on, the places drawn one from each of as many equal runs
/// of half the round, so that no order of the points is hit or missed by their regularity; all pairs once where there
/// are no more. One link is a closed chain.
pub fn links(n: usize, count: usize, seed: u64) -> Vec<[usize; 2]> {
    let half = n / 2;
    let steps: Vec<usize> = if count == 1 && half > 0 {
        vec![1]
    } else {
        Random::new(seed, LINKS_STREAM).one_of_each_run(half, count.min(half)).map(|place| 1 + place).collect()
    };
    let mut pairs = Vec::with_capacity(n * steps.len());
    for step in steps {
        // Half the round leads from both ends to the same pair.
        let begins = if 2 * step == n { step } else { n };
        pairs.extend((0..begins).map(|i| [i, (i + step) % n]));
    }
    pairs
}

/// Error of methods without a result.
pub(super) fn no_consensus(matches: usize, agreeing: usize, expected: &'static str) -> Error {
    Error::new(
        ErrorCode::NoConsensus,
        "correspondences",
        format!("{matches} matches, {agreeing} of them in agreement"),
        format!("matches that agree on one transform: {expected}"),
        "Check that both clouds show the same thing; try another voxel size.",
    )
}
