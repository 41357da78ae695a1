//! The readings around an object: how far a plane is bent there, and the level surface that it may stand on.

use glam::{DVec2, DVec3};

use super::placement::Body;
use super::plane::{Plane, SupportChoice};
use crate::geometry::image::{DepthMap, Mask};
use crate::geometry::order::median;
use crate::geometry::pinhole::Pinhole;

/// The images in which the support is found.
#[derive(Debug, Clone)]
pub struct View {
    /// The depth map.
    pub depth: DepthMap,
    /// Its camera.
    pub camera: Pinhole,
    /// The pixels of all objects, and their rims.
    pub taken: Mask,
    /// The support, or how to find it.
    pub choice: SupportChoice,
    /// Seed of the draws.
    pub seed: u64,
}

/// Distance of the lowest point from the plane that halves the credit of standing on it: metres, and relative to the
/// size.
const TOUCH: [f64; 2] = [0.01, 0.06];
/// Readings around an object that determine how far the plane is bent there, the width of their band relative to the box of
/// the object, and the largest bend, metres and metres per metre of depth.
const LOCAL_READINGS: usize = 150;
const LOCAL_BAND: f64 = 0.35;
const MAX_BEND: [f64; 2] = [0.004, 0.012];
/// Distance from a body up to which a level surface may be the one that it stands on and least standard deviation of its
/// readings in every direction, relative to the size of the body; and the thickness of its readings, relative to the
/// largest bend.
const LEVEL_REACH: f64 = 1.0;
const LEVEL_WIDTH: f64 = 0.08;
const LEVEL_HEIGHT: f64 = 0.7;

/// The distance of the lowest point from a plane that halves the credit of standing on it, metres.
pub fn touch_m(body: &Body) -> f64 {
    TOUCH[0] + TOUCH[1] * body.diameter()
}

/// The height over the plane of the readings around a body.
pub fn bend(view: &View, plane: &Plane, body: &Body) -> f64 {
    let limit = MAX_BEND[0] + MAX_BEND[1] * body.depth_m();
    let mut heights = Vec::new();
    around(view, body, |point| {
        let h = plane.height(point);
        if h.abs() < limit {
            heights.push(h as f32);
        }
    });
    if heights.len() < LOCAL_READINGS {
        return 0.0;
    }
    median(heights.into_iter()).map_or(0.0, f64::from)
}

/// Visits the readings of the scene in the band around a body.
fn around(view: &View, body: &Body, mut visit: impl FnMut(DVec3)) {
    let layer = &body.layer;
    let (width, height) = (view.depth.width(), view.depth.height());
    let rows = layer.spans.len() / layer.width.max(1);
    let band = (LOCAL_BAND * layer.width.max(rows) as f64) as usize + 8;
    let columns = layer.origin[0].saturating_sub(band)..(layer.origin[0] + layer.width + band).min(width);
    for v in layer.origin[1].saturating_sub(band)..(layer.origin[1] + rows + band).min(height) {
        for u in columns.clone() {
            let i = v * width + u;
            let z = view.depth.data()[i];
            if z > 0.0 && view.taken.data()[i] == 0 {
                visit(view.camera.back_project(u as f64, v as f64, f64::from(z)).as_dvec3());
            }
        }
    }
}

/// The height over the support of the level surface that a body is nearer to than to the support, if the depth map shows
/// one below it.
pub fn level_below(view: &View, plane: &Plane, body: &Body) -> Option<f64> {
    let size = body.diameter();
    let low = body.extent(plane)[0];
    let tolerance = 1.5 * touch_m(body);
    let slack = MAX_BEND[0] + MAX_BEND[1] * body.depth_m();
    // Nearer to the surface than to the support, and within reach of it.
    let reach = tolerance.min(0.5 * low);
    if low - reach < slack {
        return None;
    }
    let across = plane.normal.any_orthonormal_vector();
    let along = plane.normal.cross(across);
    let on_plane = |p: DVec3| DVec2::new(across.dot(p), along.dot(p));
    let centre = on_plane(body.points.iter().map(|p| p.as_dvec3()).sum::<DVec3>() / body.points.len().max(1) as f64);
    let mut near: Vec<(f64, DVec2)> = Vec::new();
    around(view, body, |point| {
        let (height, place) = (plane.height(point), on_plane(point) - centre);
        if (height - low).abs() < reach + slack && place.length() < LEVEL_REACH * size {
            near.push((height, place));
        }
    });
    near.sort_by(|a, b| a.0.total_cmp(&b.0));
    // The window with the most readings.
    let (mut best, mut first) = (0..0, 0);
    for last in 0..near.len() {
        while near[last].0 - near[first].0 > LEVEL_HEIGHT * slack {
            first += 1;
        }
        if last + 1 - first > best.len() {
            best = first..last + 1;
        }
    }
    let surface = near.get(best)?;
    if surface.len() < LOCAL_READINGS {
        return None;
    }
    let height = surface[surface.len() / 2].0;
    // A wall, or the side of a thing, fills the window as a strip.
    let count = surface.len() as f64;
    let mean = surface.iter().map(|(_, p)| *p).sum::<DVec2>() / count;
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for (_, place) in surface {
        let p = *place - mean;
        (xx, xy, yy) = (xx + p.x * p.x, xy + p.x * p.y, yy + p.y * p.y);
    }
    let (middle, half) = (0.5 * (xx + yy), (0.25 * (xx - yy) * (xx - yy) + xy * xy).sqrt());
    let narrow = ((middle - half).max(0.0) / count).sqrt();
    (narrow > LEVEL_WIDTH * size && (height - low).abs() < reach).then_some(height)
}
