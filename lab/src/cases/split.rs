//! A bar in front of the object, and the parts into which it cuts the visible region.

use super::solid::Solid;
use crate::prelude::*;
use sim3align_geometry::components::{Component, components};

/// Minimum share of the visible pixels that counts as a part.
const LEAST_PART: f64 = 0.12;
/// Share of the visible pixels that the two largest parts make up at least.
const LEAST_BOTH: f64 = 0.97;

/// Adds a bar that crosses the object in the image, nearer than the object: a pen, a cable, the edge of a shelf.
pub fn bar(object: &[f32], width: usize, view: (&Pinhole, &Similarity), random: &mut Random, solid: &mut Solid) {
    let (camera, camera_from_world) = view;
    let pixels = || object.iter().enumerate().filter(|(_, z)| **z > 0.0);
    let count = pixels().count().max(1) as f64;
    let (mut mean, mut nearest) = ([0.0; 2], f64::INFINITY);
    for (i, z) in pixels() {
        mean = [mean[0] + (i % width) as f64 / count, mean[1] + (i / width) as f64 / count];
        nearest = nearest.min(f64::from(*z));
    }
    let (mut uu, mut uv, mut vv) = (0.0, 0.0, 0.0);
    for (i, _) in pixels() {
        let [u, v] = [(i % width) as f64 - mean[0], (i / width) as f64 - mean[1]];
        (uu, uv, vv) = (uu + u * u / count, uv + u * v / count, vv + v * v / count);
    }
    let long = 0.5 * libm::atan2(2.0 * uv, uu - vv);
    let (sine, cosine) = libm::sincos(long);
    let deviation = (uu * cosine * cosine + 2.0 * uv * sine * cosine + vv * sine * sine).max(1.0).sqrt();
    // About at right angles to the longest direction, off its middle, so that the parts differ.
    let off = deviation * between(random, -0.8, 0.8);
    let centre = [mean[0] + off * cosine, mean[1] + off * sine];
    let (sine, cosine) = libm::sincos(long + FRAC_PI_2 + between(random, -0.6, 0.6));
    let half = 4.0 * deviation;
    let thickness = (deviation * between(random, 0.2, 0.6)).max(7.0 * width as f64 / 640.0);
    let z = nearest * between(random, 0.75, 0.93);
    let ends = [-half, half].map(|t| {
        let z = z * between(random, 0.96, 1.04);
        let point = camera.back_project(centre[0] + t * cosine, centre[1] + t * sine, z);
        DVec3::from_array(camera_from_world.inverse().apply(vector3(point)).into())
    });
    let along = ends[1] - ends[0];
    let turn = DQuat::from_rotation_arc(DVec3::Z, along.normalize_or(DVec3::Z));
    let radius = 0.5 * thickness * z / camera.fx;
    let frame = DAffine3::from_rotation_translation(turn, ends[0]);
    solid.at(frame).cylinder([radius, radius * between(random, 0.7, 1.0)], along.length());
}

/// The parts of a region, the largest first.
pub fn parts(region: &[bool], width: usize) -> Vec<Component> {
    let mut parts = components(region, width, region.len() / width);
    parts.sort_by_key(|part| core::cmp::Reverse(part.count()));
    parts
}

/// Whether a region consists of two large parts, apart from a few pixels.
pub fn in_two(region: &[bool], width: usize) -> bool {
    let parts = parts(region, width);
    let total = parts.iter().map(|part| part.count()).sum::<usize>() as f64;
    let [first, second] = [0, 1].map(|k| parts.get(k).map_or(0.0, |part| part.count() as f64));
    second >= LEAST_PART * total && first + second >= LEAST_BOTH * total
}
