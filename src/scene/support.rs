//! Support: which plane of the scene the objects stand on, and what each object may stand on.

use glam::{DVec2, DVec3, Vec3};
use serde::Serialize;

use super::layers::extremes_along;
use super::placement::{Body, Placement};
use super::plane::Plane;
use super::planes::{FoundPlane, find_planes};
use crate::geometry::image::{DepthMap, Mask};
use crate::geometry::order::median;
use crate::geometry::pinhole::Pinhole;

/// What is known of the support.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum SupportChoice {
    /// It is found in the depth map.
    #[default]
    Auto,
    /// The plane.
    Plane(Plane),
    /// There is none.
    None,
}

/// The plane that the objects stand on.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Support {
    /// The plane.
    #[serde(flatten)]
    pub plane: Plane,
    /// How much of the scene agrees that it is one that things stand on, 0 to 1; 1 for a plane that was given.
    pub confidence: f64,
}

/// What an object rests on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RestsOn {
    /// The support.
    Support,
    /// A level surface at another height.
    Level,
    /// The object with this index.
    Object(usize),
}

impl Serialize for RestsOn {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Support => serializer.serialize_str("support"),
            Self::Level => serializer.serialize_str("level"),
            Self::Object(index) => serializer.serialize_u32(*index as u32),
        }
    }
}

/// What an object may stand on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ground {
    /// The plane near the object: depth maps are bent.
    pub plane: Plane,
    /// The gap that halves the credit of the contact, metres.
    pub gap_m: f64,
    /// What it belongs to.
    pub on: RestsOn,
}

impl Ground {
    /// What a search is told of it: see [`Neighbourhood::ground`](crate::precise::surroundings::Neighbourhood::ground).
    pub fn known(&self) -> (DVec3, f64, f64) {
        (self.plane.normal, self.plane.d, self.gap_m)
    }
}

/// The images that the support is found in.
#[derive(Debug, Clone, Copy)]
pub struct View<'a> {
    /// The depth map.
    pub depth: &'a DepthMap,
    /// Its camera.
    pub camera: &'a Pinhole,
    /// The pixels of all objects, and their rims.
    pub taken: &'a Mask,
    /// Seed of the draws.
    pub seed: u64,
}

/// Gap that halves the credit of the contact: metres, metres per metre of depth, and relative to the size of the object.
const GAP: [f64; 3] = [0.002, 0.003, 0.015];
/// Distance of the lowest point from the plane that halves the credit of standing on it: metres, and relative to the
/// size.
const TOUCH: [f64; 2] = [0.01, 0.06];
/// Least credit of all objects for a plane that is the support.
const LEAST_CREDIT: f64 = 0.15;
/// Credit of a plane that faces sideways, relative to one that faces up in the image: cameras are mostly held upright.
const SIDEWAYS: f64 = 0.5;
/// Readings around an object that tell how far the plane is bent there, the width of their band relative to the box of
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
/// Largest offset between what things stand on and what the sensor shows of it, and the steps in which it is sought,
/// metres.
const MAX_OFFSET_M: f64 = 0.012;
const OFFSET_STEP_M: f64 = 0.000_25;
/// Offset that costs one unit; and the error of an object's lowest point: metres, and relative to its size.
const OFFSET: [f64; 3] = [0.005, 0.0015, 0.008];
/// Distance from the plane up to which an object may tell of the offset, metres, and the weight of one that is certainly
/// misplaced.
const FARTHEST_M: f64 = 0.03;
const UNSURE: f64 = 0.3;

/// The support, and what each object may stand on.
pub fn find_support(
    view: &View<'_>,
    choice: &SupportChoice,
    placements: &[Option<Placement>],
) -> (Option<Support>, Vec<Option<Ground>>) {
    let support = match choice {
        SupportChoice::None => None,
        SupportChoice::Plane(plane) => Some(Support { plane: *plane, confidence: 1.0 }),
        SupportChoice::Auto => {
            let planes = find_planes(view.depth, view.camera, view.taken, view.seed);
            chosen(&planes, placements)
        }
    };
    let Some(support) = support else { return (None, vec![None; placements.len()]) };
    let bent: Vec<Option<Plane>> = placements
        .iter()
        .map(|p| p.as_ref().map(|p| support.plane.raised(bend(view, &support.plane, &p.body))))
        .collect();
    let offset = common_offset(&bent, placements);
    let ground = |(i, plane): (usize, &Option<Plane>)| {
        let plane = plane.as_ref()?.raised(offset);
        let body = &placements[i].as_ref()?.body;
        let gap_m = gap_m(body);
        if let Some((on, top)) = below(i, &plane, placements) {
            return Some(Ground { plane: plane.raised(top), gap_m, on: RestsOn::Object(on) });
        }
        Some(match level_below(view, &support.plane, body) {
            Some(height) => Ground { plane: support.plane.raised(height), gap_m, on: RestsOn::Level },
            None => Ground { plane, gap_m, on: RestsOn::Support },
        })
    };
    let grounds = bent.iter().enumerate().map(ground).collect();
    (Some(support), grounds)
}

/// The plane that most objects stand on.
fn chosen(planes: &[FoundPlane], placements: &[Option<Placement>]) -> Option<Support> {
    let objects = placements.iter().flatten();
    let all: f64 = objects.clone().map(|p| 0.2 + p.confidence).sum();
    let credit = |found: &FoundPlane| {
        let touching = |p: &Placement| {
            let gap = extent(&p.body, &found.plane)[0] / (TOUCH[0] + TOUCH[1] * diameter(&p.body));
            (0.2 + p.confidence) / (1.0 + gap * gap)
        };
        let up = found.plane.normal.dot(DVec3::NEG_Y).max(0.0);
        // A plane that more of the scene lies on is more likely the one that objects stand on.
        let size = found.share / (found.share + 0.02);
        objects.clone().map(touching).sum::<f64>() / all.max(1e-9) * (SIDEWAYS + (1.0 - SIDEWAYS) * up) * size
    };
    let best =
        planes.iter().map(|found| (credit(found), found)).fold(None, |best: Option<(f64, &FoundPlane)>, next| {
            if best.is_none_or(|best| next.0 > best.0) { Some(next) } else { best }
        })?;
    let confidence = best.0.min(1.0);
    (confidence >= LEAST_CREDIT).then_some(Support { plane: best.1.plane, confidence })
}

/// The lowest and the highest point of a body over a plane.
pub fn extent(body: &Body, plane: &Plane) -> [f64; 2] {
    extremes_along(&body.points, plane.normal).map(|h| h + plane.d)
}

/// The longest side of a body's box, about its diameter.
pub fn diameter(body: &Body) -> f64 {
    crate::geometry::cloud::Bounds::of(&body.points).map_or(0.0, |b| f64::from(b.diagonal()))
}

fn gap_m(body: &Body) -> f64 {
    GAP[0] + GAP[1] * depth_of(body) + GAP[2] * diameter(body)
}

fn depth_of(body: &Body) -> f64 {
    let sum: f64 = body.points.iter().map(|p| f64::from(p.z)).sum();
    sum / body.points.len().max(1) as f64
}

/// How far the readings around a body are over the plane.
fn bend(view: &View<'_>, plane: &Plane, body: &Body) -> f64 {
    let limit = MAX_BEND[0] + MAX_BEND[1] * depth_of(body);
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
fn around(view: &View<'_>, body: &Body, mut visit: impl FnMut(DVec3)) {
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
fn level_below(view: &View<'_>, plane: &Plane, body: &Body) -> Option<f64> {
    let size = diameter(body);
    let low = extent(body, plane)[0];
    let tolerance = 1.5 * (TOUCH[0] + TOUCH[1] * size);
    let slack = MAX_BEND[0] + MAX_BEND[1] * depth_of(body);
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

/// How far the objects stand over what the depth map shows of the plane: sensors misplace tables. The offset on which
/// most objects agree; one that is off by itself hardly counts.
fn common_offset(planes: &[Option<Plane>], placements: &[Option<Placement>]) -> f64 {
    let gap = |(plane, p): (&Option<Plane>, &Option<Placement>)| {
        let (plane, p) = plane.as_ref().zip(p.as_ref())?;
        let gap = extent(&p.body, plane)[0];
        let noise = OFFSET[1] + OFFSET[2] * diameter(&p.body);
        // A half turn that shape does not tell makes a pose uncertain, but not its height.
        (gap.abs() < FARTHEST_M).then_some((gap, noise, UNSURE + (1.0 - UNSURE) * p.confidence))
    };
    let gaps: Vec<(f64, f64, f64)> = planes.iter().zip(placements).filter_map(gap).collect();
    let loss = |offset: f64| {
        let prior = offset / OFFSET[0];
        let off = |(gap, noise, weight): &(f64, f64, f64)| {
            let q = (gap - offset) / noise;
            weight * libm::log(1.0 + q * q)
        };
        prior * prior + gaps.iter().map(off).sum::<f64>()
    };
    let steps = (MAX_OFFSET_M / OFFSET_STEP_M) as i32;
    let tried = (-steps..=steps).map(|k| f64::from(k) * OFFSET_STEP_M).map(|offset| (loss(offset), offset));
    tried.fold((f64::INFINITY, 0.0), |best, next| if next.0 < best.0 { next } else { best }).1
}

/// The object that another one stands on, and the height of its top over the plane.
fn below(i: usize, plane: &Plane, placements: &[Option<Placement>]) -> Option<(usize, f64)> {
    let body = &placements[i].as_ref()?.body;
    let tolerance = TOUCH[0] + TOUCH[1] * diameter(body);
    let low = extent(body, plane)[0];
    let mut best: Option<(f64, usize, f64)> = None;
    for (k, other) in placements.iter().enumerate() {
        let Some(other) = other.as_ref().filter(|_| k != i) else { continue };
        let top = extent(&other.body, plane)[1];
        let apart = (low - top).abs();
        // Nearer to the top of the other than to the plane.
        let is_near = apart < 1.5 * tolerance && apart < low && best.is_none_or(|(least, ..)| apart < least);
        if is_near && is_over(body, &other.body, plane) {
            best = Some((apart, k, top));
        }
    }
    best.map(|(_, k, top)| (k, top))
}

/// Whether the centre of a body is over another one.
fn is_over(body: &Body, other: &Body, plane: &Plane) -> bool {
    let center = body.points.iter().copied().sum::<Vec3>() / body.points.len().max(1) as f32;
    let across = plane.normal.any_orthonormal_vector();
    let along = plane.normal.cross(across);
    (0..24).all(|k| {
        let (sin, cos) = crate::geometry::angle::sin_cos(core::f64::consts::TAU * f64::from(k) / 24.0);
        let direction = across * cos + along * sin;
        let [_, reach] = extremes_along(&other.points, direction);
        direction.dot(center.as_dvec3()) <= reach
    })
}
