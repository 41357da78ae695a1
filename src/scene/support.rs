//! Support: which plane of the scene the objects stand on, and what each object may stand on.

use core::f64::consts::TAU;

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

use super::layers::extremes_along;
use super::local::{View, bend, level_below, touch_m};
use super::placement::{Body, Placement};
use super::plane::{Plane, SupportChoice};
use super::planes::{FoundPlane, find_planes};
use crate::geometry::angle::sin_cos;

/// The plane that the objects stand on.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Support {
    /// The plane.
    #[serde(flatten)]
    pub plane: Plane,
    /// How much of the scene agrees that it is one that things stand on, 0 to 1; 1 for a plane that was given.
    pub confidence: f64,
}

/// The thing on which an object rests.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum RestsOn {
    /// The support.
    Support,
    /// A level surface at another height.
    Level,
    /// The object with this index.
    Object(usize),
}

/// A plane on which an object may stand.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Ground {
    /// The plane near the object: depth maps are bent.
    pub plane: Plane,
    /// The gap that halves the credit of the contact, metres.
    pub gap_m: f64,
    /// The thing to which it belongs.
    pub on: RestsOn,
}

/// Gap that halves the credit of the contact: metres, metres per metre of depth, and relative to the size of the object.
const GAP: [f64; 3] = [0.002, 0.003, 0.015];
/// Least credit of all objects for a plane that is the support.
const LEAST_CREDIT: f64 = 0.15;
/// Credit of a plane that faces sideways, relative to one that faces up in the image: cameras are mostly held upright.
const SIDEWAYS: f64 = 0.5;
/// Largest offset between what things stand on and what the sensor shows of it, and the steps in which it is sought,
/// metres.
const MAX_OFFSET_M: f64 = 0.012;
const OFFSET_STEP_M: f64 = 0.000_25;
/// Offset that costs one unit; and the error of an object's lowest point: metres, and relative to its size.
const OFFSET: [f64; 3] = [0.005, 0.0015, 0.008];
/// Distance from the plane up to which an object is evidence of the offset, metres, and the weight of one that is certainly
/// misplaced.
const FARTHEST_M: f64 = 0.03;
const UNSURE: f64 = 0.3;

/// The support, and what each object may stand on.
pub fn find_support(view: &View, placements: &[Option<Placement>]) -> (Option<Support>, Vec<Option<Ground>>) {
    let support = match &view.choice {
        SupportChoice::None => None,
        SupportChoice::Plane(plane) => Some(Support { plane: *plane, confidence: 1.0 }),
        SupportChoice::Auto => {
            let planes = find_planes(&view.depth, &view.camera, &view.taken, view.seed);
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
    let all: f64 = objects.clone().map(|p| 0.2 + p.search_state.confidence).sum();
    let credit = |found: &FoundPlane| {
        let touching = |p: &Placement| {
            let gap = p.body.extent(&found.plane)[0] / (touch_m(&p.body));
            (0.2 + p.search_state.confidence) / (1.0 + gap * gap)
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

fn gap_m(body: &Body) -> f64 {
    GAP[0] + GAP[1] * body.depth_m() + GAP[2] * body.diameter()
}

/// The offset of the objects from the visible part of the plane: sensors misplace tables. The offset on which
/// most objects agree; one that is off by itself hardly counts.
fn common_offset(planes: &[Option<Plane>], placements: &[Option<Placement>]) -> f64 {
    let gap = |(plane, p): (&Option<Plane>, &Option<Placement>)| {
        let (plane, p) = plane.as_ref().zip(p.as_ref())?;
        let gap = p.body.extent(plane)[0];
        let noise = OFFSET[1] + OFFSET[2] * p.body.diameter();
        // A half turn that shape does not exclude makes a pose uncertain, but not its height.
        (gap.abs() < FARTHEST_M).then_some((gap, noise, UNSURE + (1.0 - UNSURE) * p.search_state.confidence))
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
    let tolerance = touch_m(body);
    let low = body.extent(plane)[0];
    let mut best: Option<(f64, usize, f64)> = None;
    for (k, other) in placements.iter().enumerate() {
        let Some(other) = other.as_ref().filter(|_| k != i) else { continue };
        let top = other.body.extent(plane)[1];
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
        let (sin, cos) = sin_cos(TAU * f64::from(k) / 24.0);
        let direction = across * cos + along * sin;
        let [_, reach] = extremes_along(&other.points, direction);
        direction.dot(center.as_dvec3()) <= reach
    })
}
