//! Where mask, depth and photo change along a ray across the true outline.

use super::silhouette::{OutlinePoint, Silhouette};
use super::view::OutlineView;
use crate::prelude::*;
use sim3align_geometry::order::median;

/// Step along a ray, pixels.
const STEP: f64 = 0.25;
/// Farthest places of the outlines of mask and depth from the true one, pixels of an image 640 wide.
const REACH: [f64; 2] = [-8.0, 10.0];
/// Where the background is read.
const BACKGROUND: [f64; 2] = [7.0, 14.0];
/// Half the width of the band that is looked through for occluders.
const BAND: f64 = 4.0;
/// Distance inside of the true outline of the true depth that stands for the object's edge.
const EDGE: f64 = 1.0;
/// Least distance of the object's two outlines along a ray.
const THICKNESS: f64 = 3.0;
/// Least distance to the true outline per distance along a ray, and what the distances are off by, pixels.
const STRAIGHT: f64 = 0.7;
const SLACK: f64 = 0.3;
/// Least number of readings of the background.
const LEAST_READINGS: usize = 6;
/// Mixed pixels are looked for this close to the depth edge.
const MIXED: f64 = 3.0;
/// Share of the step from the object to the background within which a reading is one of the two.
const PURE: f64 = 0.15;
/// Reach and least strength of a photo's edge: levels per pixel, of 256.
const PHOTO_REACH: f64 = 4.0;
const PHOTO_LEAST: f64 = 6.0;

/// What limits the differences of depth, metres.
#[derive(Debug, Clone, Copy)]
pub struct Depths {
    /// Measured less true depth.
    pub bias: f64,
    /// Standard deviation of the difference.
    pub noise: f64,
    /// Least step from the object to what is behind it.
    pub step: f64,
    /// What is nearer than the object by more is an occluder.
    pub nearer: f64,
}

/// The outlines along a ray: offsets outwards from the true one, pixels.
#[derive(Debug, Clone, Copy)]
pub struct Ray {
    /// Unit vector outwards.
    pub normal: DVec2,
    /// The mask's outline; `None` if the mask has none near the true one.
    pub mask: Option<f64>,
    /// What the depth shows, if the background is farther by a clear step.
    pub depth: Option<DepthEdge>,
    /// The strongest edge of the photo.
    pub photo: Option<f64>,
}

/// The edge in the depth map.
#[derive(Debug, Clone, Copy)]
pub struct DepthEdge {
    /// Where the last reading of the object ends, pixels outwards from the true outline.
    pub offset: f64,
    /// From there to the first reading of the background, pixels.
    pub gap: f64,
    /// Readings between object and background.
    pub mixed: usize,
    /// All readings near the edge.
    pub readings: usize,
}

/// What the rays of an object share.
pub struct Rays<'a> {
    /// The view.
    pub view: &'a OutlineView,
    /// The object at its true pose.
    pub silhouette: &'a Silhouette,
    /// Limits.
    pub depths: Depths,
}

impl Rays<'_> {
    /// Pixels of the image per pixel of an image 640 wide.
    fn resolution(&self) -> f64 {
        self.view.depth.width() as f64 / 640.0
    }

    /// The reading at a point; `None` outside the image, and `Some(0)` where there is none.
    fn reading(&self, at: DVec2) -> Option<f64> {
        pixel(at, self.view.depth.width()).and_then(|[u, v]| self.view.depth.get(u, v)).map(f64::from)
    }

    /// The outlines across a point of the true outline; `None` at the image's border, next to an occluder, and at thin
    /// parts.
    pub fn ray(&self, point: OutlinePoint) -> Option<Ray> {
        let resolution = self.resolution();
        let along = |t: f64| point.at + point.normal * (t * resolution);
        // The ray leaves the object once, and in the image.
        self.reading(along(BACKGROUND[1]))?;
        let is_leaving = |t: f64| {
            let distance = self.silhouette.signed(along(t))? * t.signum();
            Some(distance >= STRAIGHT * t.abs() * resolution - SLACK)
        };
        let mut inner = 0.0;
        while inner > REACH[0] && is_leaving(inner - STEP)? {
            inner -= STEP;
        }
        let mut outer = 0.0;
        while outer < REACH[1] && is_leaving(outer + STEP)? {
            outer += STEP;
        }
        if inner > -0.5 * THICKNESS || outer < REACH[1] {
            return None;
        }
        let near = self.silhouette.depth(along(-EDGE))? + self.depths.bias;
        if self.is_next_to_occluder(point, inner, near) {
            return None;
        }
        let mask = self.mask_offset(&along, [inner, REACH[1]]);
        let depth = self.depth_edge(&along, [inner, BACKGROUND[1]], near);
        let photo = self.photo_edge(&along, point.normal, inner);
        Some(Ray { normal: point.normal, mask, depth, photo })
    }

    fn is_next_to_occluder(&self, point: OutlinePoint, inner: f64, near: f64) -> bool {
        let (resolution, across) = (self.resolution(), point.normal.perp());
        let ts = (0..).map(|k| inner + k as f64).take_while(|t| *t <= REACH[1]);
        ts.flat_map(|t| [-BAND, 0.0, BAND].map(|s| (t, s))).any(|(t, s)| {
            let at = point.at + (point.normal * t + across * s) * resolution;
            let object = self.silhouette.depth(at).map_or(near, |z| z + self.depths.bias);
            // The object itself may be nearer than at its edge.
            let object = if t > -EDGE { object.min(near) } else { object };
            self.reading(at).is_none_or(|z| z > 0.0 && z < object - self.depths.nearer)
        })
    }

    fn mask_offset(&self, along: &dyn Fn(f64) -> DVec2, [inner, outer]: [f64; 2]) -> Option<f64> {
        let mask = &self.view.mask;
        let is_in = |t: f64| pixel(along(t), mask.width()).and_then(|[u, v]| mask.get(u, v)).is_some_and(|m| m != 0);
        let steps = ((outer - inner) / STEP) as usize;
        let ends = (0..steps).map(|k| inner + k as f64 * STEP).filter(|t| is_in(*t) && !is_in(t + STEP));
        // Of several, the one nearest to the true outline.
        ends.map(|t| t + 0.5 * STEP).min_by(|a, b| a.abs().total_cmp(&b.abs()))
    }

    fn depth_edge(&self, along: &dyn Fn(f64) -> DVec2, [inner, outer]: [f64; 2], near: f64) -> Option<DepthEdge> {
        let readings = |[from, to]: [f64; 2]| {
            let steps = ((to - from) / STEP) as usize;
            (0..=steps).map(move |k| from + k as f64 * STEP).filter_map(|t| {
                let z = self.reading(along(t))?;
                (z > 0.0).then_some((t, z))
            })
        };
        let behind: Vec<f32> = readings(BACKGROUND).map(|(_, z)| z as f32).collect();
        let far = f64::from(median(behind.iter().copied())?);
        let step = far - near;
        if step < self.depths.step {
            return None;
        }
        // Something else stands there, or the background is too uneven.
        let is_even = |z: &&f32| (f64::from(**z) - far).abs() < 0.4 * step;
        let even = behind.iter().filter(is_even).count();
        if behind.len() < LEAST_READINGS || even * 10 < behind.len() * 9 {
            return None;
        }
        let (mut last, mut first) = (None, None);
        for (t, z) in readings([inner, outer]) {
            if z < near + 0.5 * step {
                last = Some(t);
            } else if last.is_some() {
                first = Some(t);
                break;
            }
        }
        let (last, first) = (last?, first?);
        let offset = last + 0.5 * STEP;
        let pure = (PURE * step).max(4.0 * self.depths.noise);
        let around = readings([offset - MIXED, offset + MIXED]);
        let (mut mixed, mut count) = (0, 0);
        for (_, z) in around {
            count += 1;
            mixed += usize::from(z > near + pure && z < far - pure);
        }
        Some(DepthEdge { offset, gap: (first - last - STEP).max(0.0), mixed, readings: count })
    }

    fn photo_edge(&self, along: &dyn Fn(f64) -> DVec2, normal: DVec2, inner: f64) -> Option<f64> {
        let photo = self.view.photo.as_ref()?;
        let size = photo.width() as f64 / self.view.depth.width() as f64;
        // A mean of three across the ray.
        let across = normal.perp() * self.resolution();
        let color = |t: f64| -> Option<[f64; 3]> {
            let mut sum = [0.0; 3];
            for s in [-1.0, 0.0, 1.0] {
                let at = (along(t) + across * s + 0.5) * size - 0.5;
                let [u, v] = [at.x.floor(), at.y.floor()];
                for (k, weight) in corners(at.x - u, at.y - v).into_iter().enumerate() {
                    let [x, y] = [u + (k % 2) as f64, v + (k / 2) as f64];
                    let shown = photo.get(pixel(DVec2::new(x, y), photo.width())?[0], y as usize)?;
                    sum.iter_mut().zip(shown).for_each(|(sum, c)| *sum += weight * f64::from(c) / 3.0);
                }
            }
            Some(sum)
        };
        let steps = (2.0 * PHOTO_REACH / STEP) as usize;
        let from = -PHOTO_REACH;
        let slope = |k: usize| -> Option<f64> {
            let t = from + k as f64 * STEP;
            let (a, b) = (color(t - 0.5)?, color(t + 0.5)?);
            Some((0..3).map(|c| (b[c] - a[c]).abs()).fold(0.0, f64::max) / self.resolution())
        };
        let slopes = (0..=steps).map(slope).collect::<Option<Vec<f64>>>()?;
        let strongest =
            (1..steps).filter(|k| from + *k as f64 * STEP >= inner).max_by(|a, b| slopes[*a].total_cmp(&slopes[*b]))?;
        let [before, peak, after] = [slopes[strongest - 1], slopes[strongest], slopes[strongest + 1]];
        if peak < PHOTO_LEAST || peak < before || peak < after {
            return None;
        }
        let bend = before - 2.0 * peak + after;
        let between = if bend < 0.0 { 0.5 * (before - after) / bend } else { 0.0 };
        Some(from + (strongest as f64 + between) * STEP)
    }
}

/// The weights of the four pixels about a point between them.
fn corners(x: f64, y: f64) -> [f64; 4] {
    [(1.0 - x) * (1.0 - y), x * (1.0 - y), (1.0 - x) * y, x * y]
}

/// The pixel of a point; `None` left of or above the image, and beyond its width.
fn pixel(at: DVec2, width: usize) -> Option<[usize; 2]> {
    let [u, v] = [at.x + 0.5, at.y + 0.5];
    (u >= 0.0 && v >= 0.0 && u < width as f64).then_some([u as usize, v as usize])
}
