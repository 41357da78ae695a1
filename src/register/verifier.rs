//! Which of many poses of two scenes is right, by the scenes themselves.

use super::global::Side;
use crate::geometry::similarity::Similarity;
use crate::register::fpfh::{DIMENSION, Descriptor};
use crate::register::free_space::FreeSpace;

/// What a point costs that stands where the other cloud's sensor has looked through, as a multiple of what an ordinary
/// point gains that has a counterpart. Streets and corridors agree with themselves the wrong way round as well as the
/// right way, or better; but not with what was seen to be empty.
const CONTRADICTION: f64 = 4.0;

/// Most weight of a point, where the mean is 1.
const MAX_WEIGHT: f32 = 4.0;

/// Holds poses against both voxel grids.
pub(super) struct Verifier<'a> {
    pub source: &'a Side<'a>,
    pub target: &'a Side<'a>,
    /// Of the source's points and the target's; see [`distinctiveness`].
    pub weights: [Vec<f32>; 2],
    /// What is known to be empty, in the source's frame and in the target's, where a sensor's place is known.
    pub free: [Option<FreeSpace>; 2],
    /// How near a counterpart is.
    pub distance: f32,
}

impl Verifier<'_> {
    /// How well the grids agree under a pose, there and back: near points with like normals, those of corners before
    /// those of planes, less contradictions of free space.
    pub fn score(&self, pose: &Similarity) -> f64 {
        let [source_free, target_free] = self.free.each_ref().map(Option::as_ref);
        self.one_way([self.source, self.target], &self.weights[0], target_free, pose)
            + self.one_way([self.target, self.source], &self.weights[1], source_free, &pose.inverse())
    }

    fn one_way(
        &self,
        [from, to]: [&Side<'_>; 2],
        weights: &[f32],
        free: Option<&FreeSpace>,
        to_from: &Similarity,
    ) -> f64 {
        let transform = to_from.to_f32();
        let mut sum = 0.0;
        for ((&point, &normal), &weight) in from.voxels.points.iter().zip(&from.voxels.normals).zip(weights) {
            let landed = transform.apply(point);
            if let Some(near) = to.tree.nearest_within(landed, self.distance) {
                let cosine = transform.rotate(normal).dot(to.voxels.normals[near.index as usize]).abs();
                let share = 1.0 - near.distance_squared / (self.distance * self.distance);
                sum += f64::from(weight * share * (2.0 * cosine - 1.0).max(0.0));
            } else if free.is_some_and(|free| free.contradicts(landed)) {
                sum -= CONTRADICTION;
            }
        }
        sum
    }
}

/// How far each descriptor is from the mean one, which is about a plane's: 1 on average. Planes slide on planes, and
/// would outvote everything else.
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
