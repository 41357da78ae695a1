//! Fast Point Feature Histograms, 33 bins (Rusu, Blodow, Beetz 2009; paper §3.2): descriptors of the surface around a
//! point that do not depend on its pose.

use glam::Vec3;

use crate::geometry::cloud::Cloud;
use crate::geometry::kd_tree::{KdTree, Neighbor};
use crate::geometry::order::{index_of, pack, select_smallest, sort, value_of};
use crate::scheduler::Scheduler;

/// Bins per angle.
const BINS: usize = 11;

/// Length of a descriptor.
pub const DIMENSION: usize = 3 * BINS;

/// A descriptor: three histograms, each with sum 1 (or all 0 for a point without neighbours).
pub type Descriptor = [f32; DIMENSION];

/// Maximum number of neighbours in a histogram; the nearest are used. Bounds the time for uneven clouds.
const MAX_NEIGHBORS: usize = 128;

/// Sine of the angle between normal and connecting line below which they are parallel up to rounding.
const PARALLEL: f32 = 1e-5;

/// Units of work of a neighbour that is found, and of one in a histogram.
const FOUND: f64 = 3e-5;
const COUNTED: f64 = 1e-4;

/// The descriptors of a cloud with normals, one per point, from the neighbours within `radius`. `tree` is the search
/// tree over the same points.
pub async fn fpfh(cloud: &Cloud, tree: &KdTree, radius: f32, scheduler: &Scheduler) -> Vec<Descriptor> {
    let mut found = Vec::new();
    let mut neighborhoods: Vec<Vec<Neighbor>> = Vec::with_capacity(cloud.len());
    for (i, &point) in cloud.points.iter().enumerate() {
        tree.within(point, radius, &mut found);
        scheduler.yield_after(FOUND * found.len() as f64).await;
        neighborhoods.push(nearest_others(i, &mut found));
    }

    let mut simplified: Vec<Descriptor> = Vec::with_capacity(cloud.len());
    for (i, near) in neighborhoods.iter().enumerate() {
        simplified.push(simplified_histogram(cloud, i, near));
        scheduler.yield_after(COUNTED * near.len() as f64).await;
    }

    let mut combined: Vec<Descriptor> = Vec::with_capacity(cloud.len());
    for (near, own) in neighborhoods.iter().zip(&simplified) {
        combined.push(combined_histogram(near, own, &simplified));
        scheduler.yield_after(COUNTED * near.len() as f64).await;
    }
    combined
}

/// The nearest of the points in the neighbourhood of the `i`th, itself excluded.
fn nearest_others(i: usize, found: &mut Vec<Neighbor>) -> Vec<Neighbor> {
    found.retain(|n| n.index as usize != i && n.distance_squared > 0.0);
    let mut keys: Vec<u64> = found.iter().map(|n| pack(n.distance_squared, n.index)).collect();
    select_smallest(&mut keys, MAX_NEIGHBORS);
    keys.truncate(MAX_NEIGHBORS);
    // Sorts by index (the low half of the keys), because f32 sums depend on the order.
    keys.iter_mut().for_each(|key| *key = key.rotate_left(32));
    sort(&mut keys);
    let neighbor = |key: u64| Neighbor { index: index_of(key), distance_squared: value_of(key) };
    keys.into_iter().map(|key| neighbor(key.rotate_left(32))).collect()
}

/// SPFH(p), and the weighted mean of those of the neighbours.
fn combined_histogram(near: &[Neighbor], own: &Descriptor, simplified: &[Descriptor]) -> Descriptor {
    let mut sum = [0.0; DIMENSION];
    for neighbor in near {
        let weight = 1.0 / neighbor.distance_squared.sqrt();
        for (bin, value) in sum.iter_mut().zip(simplified.get(neighbor.index as usize).into_iter().flatten()) {
            *bin += weight * value;
        }
    }
    // Both have equal weight, independent of the unit of distance.
    normalize(&mut sum);
    for (bin, own) in sum.iter_mut().zip(own) {
        *bin += own;
    }
    normalize(&mut sum);
    sum
}

/// SPFH: histograms of the three angles between a point and its neighbours.
fn simplified_histogram(cloud: &Cloud, i: usize, near: &[Neighbor]) -> Descriptor {
    let mut histogram = [0.0; DIMENSION];
    for neighbor in near {
        let oriented = |i: usize| Some((*cloud.points.get(i)?, *cloud.normals.get(i)?));
        if let (Some(p), Some(q)) = (oriented(i), oriented(neighbor.index as usize))
            && let Some(features) = pair_features(p, q)
        {
            for (third, feature) in features.into_iter().enumerate() {
                let bin = (feature * BINS as f32) as usize;
                histogram[third * BINS + bin.min(BINS - 1)] += 1.0;
            }
        }
    }
    normalize(&mut histogram);
    histogram
}

/// α, φ, θ of the Darboux frame between two oriented points, each mapped to [0, 1].
/// `None` if a normal is unknown or parallel to the connecting line.
fn pair_features((p, p_normal): (Vec3, Vec3), (q, q_normal): (Vec3, Vec3)) -> Option<[f32; 3]> {
    let line = (q - p).try_normalize()?;
    // The frame is that of the point whose normal is closer to the line, so that the order of the pair has no effect.
    let (u, other, line) = if p_normal.dot(line).abs() >= q_normal.dot(line).abs() {
        (p_normal, q_normal, line)
    } else {
        (q_normal, p_normal, -line)
    };
    if u == Vec3::ZERO || other == Vec3::ZERO {
        return None;
    }
    let v = line.cross(u);
    // The direction of a tiny cross product is dominated by rounding.
    if v.length_squared() < PARALLEL * PARALLEL {
        return None;
    }
    let v = v.normalize();
    let w = u.cross(v);
    let alpha = v.dot(other);
    let phi = u.dot(line);
    let theta = libm::atan2f(w.dot(other), u.dot(other));
    Some([0.5 * (alpha + 1.0), 0.5 * (phi + 1.0), 0.5 * (theta / core::f32::consts::PI + 1.0)])
}

/// Scales each third of the histogram to a sum of 1.
fn normalize(histogram: &mut Descriptor) {
    for third in histogram.chunks_exact_mut(BINS) {
        let sum: f32 = third.iter().sum();
        if sum > 0.0 {
            third.iter_mut().for_each(|bin| *bin /= sum);
        }
    }
}
