//! Errors of depth sensors and depth models at steps between an object and its background.
//!
//! The true edge moves in or out by an offset that changes along it. Beside the moved edge, readings are missing or mixed.

use super::noise::Noise;
use crate::conditions::{DepthSource, Tier};
use crate::prelude::*;
use crate::world::view::Rendering;

/// Smallest step, as a share of the distance: about a pixel of a stereo camera's disparity.
const STEP: f64 = 0.02;
/// Farthest that edges move, in pixels of an image 640 wide.
const REACH: f64 = 8.0;
/// Focal length times baseline of stereo and structured light, pixels of an image 640 wide times metres: RealSense D400
/// at 50 mm, PrimeSense at 75 mm.
const STEREO_BASE: f64 = 30.0;
const PROJECTOR_BASE: f64 = 43.0;
/// Widest shadow, pixels of an image 640 wide.
const WIDEST: f64 = 15.0;

/// Magnitudes at the edges by tier, pixels of an image 640 wide.
struct EdgeErrors {
    /// Mean of the offset, and its deviation from map to map.
    offset: [[f64; 2]; 3],
    /// How much the offset changes along the edge, and the size of the places where it does.
    wobble: [f64; 3],
    place: f64,
    /// Half the width of the ramp from one depth to the other, and its share without readings.
    ramp: [f64; 3],
    lost_ramp: f64,
    /// Width without readings outside of the moved edge, and inside of the true edge where it is eroded.
    gap: [f64; 3],
    /// Focal length times baseline of what casts a shadow, and the share of the shadow that is not filled in.
    shadow: (f64, f64),
    /// Shift of the whole map relative to photo and mask.
    shift: [f64; 3],
}

const ACTIVE_STEREO: EdgeErrors = EdgeErrors {
    offset: [[0.0, 0.8], [0.0, 1.4], [0.0, 2.2]],
    wobble: [2.5, 4.0, 6.0],
    place: 7.0,
    ramp: [0.3, 0.3, 0.3],
    lost_ramp: 0.0,
    gap: [0.5, 0.5, 0.5],
    shadow: (STEREO_BASE, 0.7),
    shift: [0.7, 1.5, 3.0],
};
const STRUCTURED_LIGHT: EdgeErrors = EdgeErrors {
    offset: [[-0.8, 0.1], [-1.6, 0.2], [-2.8, 0.4]],
    wobble: [2.0, 3.0, 4.5],
    place: 5.0,
    ramp: [0.0, 0.0, 0.0],
    gap: [1.5, 2.5, 3.5],
    shadow: (PROJECTOR_BASE, 1.0),
    ..ACTIVE_STEREO
};
const TIME_OF_FLIGHT: EdgeErrors = EdgeErrors {
    offset: [[0.0, 0.4], [0.0, 0.4], [0.0, 0.4]],
    wobble: [0.8, 0.8, 0.8],
    place: 5.0,
    ramp: [0.8, 1.4, 2.0],
    lost_ramp: 0.4,
    gap: [0.0, 0.0, 0.0],
    shadow: (0.0, 0.0),
    ..ACTIVE_STEREO
};
/// Made from the photo: no shift.
const PREDICTED: EdgeErrors = EdgeErrors {
    offset: [[0.1, 0.3], [0.3, 0.6], [0.5, 1.0]],
    wobble: [1.0, 2.0, 3.5],
    place: 8.0,
    ramp: [0.8, 1.5, 3.0],
    lost_ramp: 0.0,
    shift: [0.0, 0.0, 0.0],
    ..TIME_OF_FLIGHT
};

/// The scene's depth, metres, with the edges of a source but without noise; 0 for no reading.
pub fn edges(source: DepthSource, rendering: &Rendering, tier: Tier, random: &mut Random) -> Vec<f32> {
    let width = rendering.view.width;
    let resolution = rendering.view.resolution();
    let errors = match source {
        DepthSource::ActiveStereo => ACTIVE_STEREO,
        DepthSource::StructuredLight => STRUCTURED_LIGHT,
        DepthSource::TimeOfFlight => TIME_OF_FLIGHT,
        DepthSource::Predicted => PREDICTED,
    };
    let much = resolution * between(random, 0.6, 1.0);
    let of_tier = |values: [f64; 3]| much * values[tier as usize];
    let [mean, deviation] = errors.offset[tier as usize];
    let mean = resolution * (mean + deviation * normal(random));
    let wobble = Noise::new(&rendering.view, errors.place * resolution, random);
    let filling = Noise::new(&rendering.view, 6.0 * resolution, random);
    let reach = REACH * resolution;
    let near = Beside::all(rendering, reach);
    let mut depth = rendering.depth.clone();
    let (ramp, gap) = (of_tier(errors.ramp), of_tier(errors.gap));
    let wobbling = of_tier(errors.wobble);
    for (i, beside) in near.iter().enumerate() {
        let Some(beside) = beside else { continue };
        let offset = (mean + wobbling * wobble.at(i)).clamp(-reach, reach);
        // Pixels outwards from the moved edge.
        let outwards = beside.signed - offset;
        // An eroded edge leaves no reading on the object, or the background's.
        let is_eroded = beside.signed < 0.0 && outwards >= 0.0 && (gap > 0.6 * resolution || filling.at(i) > 0.0);
        let is_beside = outwards >= 0.0 && outwards < gap;
        depth[i] = if outwards.abs() < ramp {
            let share = (0.5 * (outwards / ramp + 1.0)) as f32;
            let mixed = if beside.far > 0.0 { beside.near * (1.0 - share) + beside.far * share } else { 0.0 };
            if chance(random, errors.lost_ramp) { 0.0 } else { mixed }
        } else if is_eroded || is_beside {
            0.0
        } else if outwards < 0.0 {
            if beside.signed < 0.0 { rendering.depth[i] } else { beside.near }
        } else if beside.signed < 0.0 {
            beside.far
        } else {
            rendering.depth[i]
        };
    }
    let side = sign(random);
    let (base, share) = errors.shadow;
    if base > 0.0 {
        let dark = |i: usize| 0.5 * (filling.at(i) + 1.0) < 0.2 + 0.8 * share;
        cast_shadow(rendering, [base * resolution, WIDEST * resolution], side, &mut depth, &dark);
    }
    let shift = crate::world::unit(TAU * random.uniform()) * of_tier(errors.shift);
    shifted(&depth, width, shift.to_array())
}

/// The nearest depth edge of a pixel.
#[derive(Clone, Copy)]
struct Beside {
    /// Distance to it, pixels: negative on the nearer side.
    signed: f64,
    /// Depths of the two sides; the farther is 0 where the scene is empty.
    near: f32,
    far: f32,
}

impl Beside {
    /// For each pixel, its nearest edge, if one is within `reach` pixels.
    fn all(rendering: &Rendering, reach: f64) -> Vec<Option<Self>> {
        let (width, height) = (rendering.view.width, rendering.view.height);
        let mut all: Vec<Option<Self>> = vec![None; width * height];
        for v in 0..height {
            for u in 0..width {
                let i = v * width + u;
                let beside = [
                    (u + 1 < width).then_some((i + 1, [0.5, 0.0])),
                    (v + 1 < height).then_some((i + width, [0.0, 0.5])),
                ];
                for (j, [du, dv]) in beside.into_iter().flatten() {
                    let (a, b) = (rendering.depth[i], rendering.depth[j]);
                    // An empty scene is far.
                    let (near, far) = if b == 0.0 || (a > 0.0 && a < b) { (a, b) } else { (b, a) };
                    if near > 0.0 && (far == 0.0 || f64::from(far - near) > STEP * f64::from(near)) {
                        spread(&mut all, rendering, [u as f64 + du, v as f64 + dv], reach, [near, far]);
                    }
                }
            }
        }
        all
    }
}

/// Records an edge at the pixels around it that have no nearer one.
fn spread(all: &mut [Option<Beside>], rendering: &Rendering, [u, v]: [f64; 2], reach: f64, [near, far]: [f32; 2]) {
    let range = |x: f64, side: usize| (x - reach).max(0.0).ceil() as usize..=((x + reach) as usize).min(side - 1);
    for y in range(v, rendering.view.height) {
        for x in range(u, rendering.view.width) {
            let distance = libm::sqrt((x as f64 - u).powi(2) + (y as f64 - v).powi(2));
            let slot = &mut all[y * rendering.view.width + x];
            if distance > reach || slot.is_some_and(|known| known.signed.abs() <= distance) {
                continue;
            }
            let z = rendering.depth[y * rendering.view.width + x];
            let is_near = z > 0.0 && (far == 0.0 || z < 0.5 * (near + far));
            // The middle between the two pixels of an edge is half a pixel from each.
            *slot = Some(Beside { signed: if is_near { -distance } else { distance }, near, far });
        }
    }
}

/// Loses the readings that a second eye or a projector beside the camera does not see: `base` is its focal length in pixels
/// times its distance in metres, `widest` the limit of the shadow in pixels.
fn cast_shadow(
    rendering: &Rendering,
    [base, widest]: [f64; 2],
    side: f64,
    depth: &mut [f32],
    is_dark: &dyn Fn(usize) -> bool,
) {
    let width = rendering.view.width;
    for (v, row) in rendering.depth.chunks(width).enumerate() {
        for u in 1..width {
            // The nearer pixel, and the one beside it on the side of the shadow.
            let (near, first) = if side > 0.0 { (u - 1, u) } else { (u, u - 1) };
            let (z, behind) = (f64::from(row[near]), f64::from(row[first]));
            if z <= 0.0 || behind <= z * (1.0 + STEP) {
                continue;
            }
            let length = (base * (1.0 / z - 1.0 / behind)).min(widest) as usize;
            for k in 0..=length {
                let Some(x) = first.checked_add_signed(if side > 0.0 { k as isize } else { -(k as isize) }) else {
                    break;
                };
                if x >= width || f64::from(row[x]) <= z * (1.0 + 0.5 * STEP) {
                    break;
                }
                if is_dark(v * width + x) {
                    depth[v * width + x] = 0.0;
                }
            }
        }
    }
}

/// The map moved by a number of pixels.
fn shifted(depth: &[f32], width: usize, [right, down]: [f64; 2]) -> Vec<f32> {
    let height = depth.len() / width;
    let from = |x: usize, by: f64, side: usize| (x as f64 - by).round().clamp(0.0, side as f64 - 1.0) as usize;
    (0..depth.len()).map(|i| depth[from(i / width, down, height) * width + from(i % width, right, width)]).collect()
}
