//! Ramps: how wide the edges of the depth are at the outline of the object.
//!
//! A sensor measures either surface: at an outline, its depth steps within one or two pixels, or lacks readings. A network
//! that predicts depth, and whoever enlarges a depth map smoothly, turns steps into ramps. Readings on a ramp belong to
//! no surface.

use super::mask_boundary::{BoundaryImages, Ray};
use crate::geometry::order::quantile;

/// Length of a ray to either side of the outline: relative to the square root of the mask's area, and the least of it,
/// pixels.
const REACH: (f64, f64) = (0.12, 9.0);
/// Parts of a ray where depths are those of a surface, relative to its length: the far and the near one, to either side.
const SURFACE: [f64; 3] = [1.0, 0.75, 0.5];
/// Least step between the surfaces where they are continued to the outline, relative to their distance on the ray. Less is
/// a slanted table.
const STEEP: f64 = 0.5;
/// Distance inside the outline from which on depths belong to the object even where the mask is too large, pixels.
const INSIDE: f32 = -2.0;
/// Least step, relative to the width of the object and to its distance.
const JUMP: [f64; 2] = [0.25, 0.017];
/// Edges are ramps if no more than this share of them is narrower than this width, pixels. That quantile is .8 to 1.06 on real
/// objects of four sensors, also with holes filled, and 2.5 to 8 where a fortieth of the object blurs them.
const SHARPER: f64 = 0.1;
const SHARP: f32 = 2.0;
/// Minimum number of rays that cross an edge, and their minimum share of the rays: flat objects on a table have fewer.
const MIN_RAYS: usize = 24;
const MIN_SHARE: f64 = 0.2;
/// Number of rays that are enough.
const RAYS: usize = 300;

/// The width of the edges of the depth at the outline, pixels: the step over the steepest slope, in the median. 0 for the steps of a
/// sensor, and where the depth shows no edges. The object is so many metres wide, and so far away.
pub fn ramp_width(images: BoundaryImages<'_>, pixels: usize, [extent_m, distance_m]: [f64; 2]) -> f64 {
    let reach = (REACH.0 * (pixels as f64).sqrt()).max(REACH.1);
    let jump_m = JUMP[0] * extent_m + JUMP[1] * distance_m;
    let mut rays = Vec::new();
    images.rays(|ray| rays.extend(ray));
    let every = rays.len().div_ceil(RAYS).max(1);
    let widths: Vec<f32> = rays.iter().step_by(every).filter_map(|ray| width(ray, reach, jump_m)).collect();
    let least = MIN_SHARE * rays.len().div_ceil(every) as f64;
    if widths.len() < MIN_RAYS || (widths.len() as f64) < least {
        return 0.0;
    }
    let at = |share: f64| quantile(widths.iter().copied(), share);
    if at(SHARPER).is_none_or(|width| width < SHARP) { 0.0 } else { at(0.5).map_or(0.0, f64::from) }
}

/// The width of the edge on a ray.
fn width(ray: &Ray<'_>, reach: f64, jump_m: f64) -> Option<f32> {
    let [far, middle, near] = SURFACE.map(|share| share * reach);
    // Sums and numbers of the readings of the object, far from the outline and near it, and of the background.
    let mut parts = [[0.0; 2]; 4];
    let (mut last, mut steepest) = (None, 0.0f64);
    let steps = reach as i32;
    for t in (-steps..=steps).map(f64::from) {
        let Some(z) = ray.depth(t) else { continue };
        // A gap between readings is an edge, too.
        steepest = steepest.max(last.map_or(0.0, |last| z - last));
        last = Some(z);
        let part = usize::from(t.abs() < middle);
        let outline = ray.outline(t);
        if t.abs() >= near && t.abs() <= far && (if t < 0.0 { outline < INSIDE } else { outline > 0.0 }) {
            let [sum, count] = &mut parts[part + 2 * usize::from(t > 0.0)];
            *sum += z;
            *count += 1.0;
        }
    }
    if parts.iter().any(|[_, count]| *count == 0.0) {
        return None;
    }
    let [object_far, object, background_far, background] = parts.map(|[sum, count]| sum / count);
    // To the outline, from the middles of the two parts.
    let beyond = (middle + near) / (far - near);
    let object_there = object + beyond * (object - object_far);
    let background_there = background + beyond * (background - background_far);
    let (apart, step) = (background - object, background_there - object_there);
    (apart >= jump_m && step >= jump_m.max(STEEP * apart)).then(|| (step / steepest) as f32)
}
