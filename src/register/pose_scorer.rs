//! Scores poses between two scenes by the agreement of both complete scenes and by their free space.

use super::cloud_pair::{CloudPair, CloudPyramid};
use crate::geometry::similarity::Similarity;
use crate::register::fpfh::{DIMENSION, Descriptor};
use crate::register::free_space::FreeSpace;

/// Cost of a point in observed free space of the other cloud, relative to the gain of an average matched point. Streets
/// and corridors also agree with themselves after a half turn, sometimes better than at the correct pose; free space
/// distinguishes the two.
const CONTRADICTION: f64 = 4.0;

/// Maximum weight of a point; the mean is 1.
const MAX_WEIGHT: f32 = 4.0;

/// Scores poses on the voxel grids of both clouds.
pub(super) struct PoseScorer<'a> {
    pub clouds: &'a CloudPair<'a>,
    /// Weights of the points of source and target; see [`distinctiveness`].
    pub weights: [Vec<f32>; 2],
    /// Free space in the frames of source and target, if the position of the sensor is known.
    pub free: [Option<FreeSpace>; 2],
    /// Maximum distance of a matched point.
    pub distance: f32,
}

impl PoseScorer<'_> {
    /// The units of work of a score.
    pub fn work(&self) -> f64 {
        6e-4 * (self.clouds.source.grid.cloud.len() + self.clouds.target.grid.cloud.len()) as f64
    }

    /// The agreement of the grids under a pose, in both directions: near points with similar normals, weighted by
    /// distinctiveness, minus the contradictions of free space. Higher is better.
    pub fn score(&self, pose: &Similarity) -> f64 {
        let [there, back] = self.both_ways(pose);
        there + back
    }

    /// Like [`PoseScorer::score`], comparable between scales: the area on which both grids agree, relative to the
    /// geometric mean of their areas. A source that shrinks agrees everywhere, but with ever less of the target.
    pub fn balanced(&self, pose: &Similarity) -> f64 {
        let [there, back] = self.both_ways(pose);
        let CloudPair { source, target } = self.clouds;
        let [n, m] = [source, target].map(|side| side.grid.cloud.len().max(1) as f64);
        // Linear size of the source relative to the target, by the areas that their voxels cover.
        let size = pose.scale * (n / m).sqrt();
        there / n * size + back / m / size
    }

    /// The agreement of the source's grid with the target, and of the target's grid with the source.
    fn both_ways(&self, pose: &Similarity) -> [f64; 2] {
        let [source_free, target_free] = self.free.each_ref().map(Option::as_ref);
        let CloudPair { source, target } = self.clouds;
        [
            self.one_way([source, target], &self.weights[0], target_free, pose),
            self.one_way([target, source], &self.weights[1], source_free, &pose.inverse()),
        ]
    }

    fn one_way(
        &self,
        [from, to]: [&CloudPyramid<'_>; 2],
        weights: &[f32],
        free: Option<&FreeSpace>,
        to_from: &Similarity,
    ) -> f64 {
        let (from, to, tree) = (&from.grid.cloud, &to.grid.cloud, &to.grid.tree);
        let transform = to_from.to_f32();
        let mut sum = 0.0;
        for ((&point, &normal), &weight) in from.points.iter().zip(&from.normals).zip(weights) {
            let landed = transform.apply(point);
            if let Some(near) = tree.nearest_within(landed, self.distance) {
                let cosine = transform.rotate(normal).dot(to.normals[near.index as usize]).abs();
                let share = 1.0 - near.distance_squared / (self.distance * self.distance);
                sum += f64::from(weight * share * (2.0 * cosine - 1.0).max(0.0));
            } else if free.is_some_and(|free| free.contradicts(landed)) {
                sum -= CONTRADICTION;
            }
        }
        sum
    }
}

/// Squared distance of each descriptor from the mean one, which is about that of a plane; 1 on average. Points on
/// planes match under sliding, and would dominate the score.
pub(super) fn distinctiveness(descriptors: &[Descriptor]) -> Vec<f32> {
    let count = descriptors.len().max(1) as f32;
    let mut mean = [0.0; DIMENSION];
    for descriptor in descriptors {
        mean.iter_mut().zip(descriptor).for_each(|(mean, x)| *mean += x / count);
    }
    let far = |descriptor: &Descriptor| descriptor.iter().zip(&mean).map(|(x, m)| (x - m) * (x - m)).sum::<f32>();
    let all: Vec<f32> = descriptors.iter().map(far).collect();
    let whole = all.iter().sum::<f32>() / count;
    let weight = |x: f32| if whole > 0.0 { (x / whole).min(MAX_WEIGHT) } else { 1.0 };
    all.into_iter().map(weight).collect()
}
