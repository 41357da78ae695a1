//! A spinning lidar of 64 beams.

use super::street::Body;
use crate::prelude::*;

/// Random stream of the errors of the lidar.
pub(super) const LIDAR_STREAM: u64 = 0x6c69_6461;

/// Height of the sensor above the ground.
pub const HEIGHT_M: f64 = 1.73;

const BEAMS: u32 = 64;
/// Readings of a beam in a turn.
const STEPS: u32 = 1000;
/// Highest and lowest beam, degrees above the horizon.
const ELEVATIONS_DEG: [f64; 2] = [2.0, -24.8];
const RANGE_M: [f64; 2] = [2.5, 80.0];
const NOISE_M: f64 = 0.02;
/// Share of the readings that get lost.
const LOST: f64 = 0.06;
/// How far a ray goes through foliage, on average.
const FOLIAGE_M: f64 = 1.2;

/// One turn at `place`, as points in the sensor's frame (x forward, y left, z up), which is turned by `rotation`.
pub fn sweep(bodies: &[Body], place: DVec3, rotation: DQuat, seed: u64) -> Vec<Vec3> {
    let random = &mut Random::new(seed, LIDAR_STREAM);
    let mut points = Vec::new();
    // By sector, so that a ray is only held against what is in its direction.
    for step in 0..STEPS {
        let (sine, cosine) = libm::sincos(TAU * f64::from(step) / f64::from(STEPS));
        let ahead = (rotation * DVec3::new(cosine, sine, 0.0)).truncate().normalize_or_zero();
        let is_ahead = |body: &&Body| {
            let to = (body.center() - place).truncate();
            let reach = body.reach() + 0.5;
            to.perp_dot(ahead).abs() < reach && to.dot(ahead) > -reach && to.length() < RANGE_M[1] + reach
        };
        let near: Vec<&Body> = bodies.iter().filter(is_ahead).collect();
        for beam in 0..BEAMS {
            let share = f64::from(beam) / f64::from(BEAMS - 1);
            let elevation = ELEVATIONS_DEG[0] + share * (ELEVATIONS_DEG[1] - ELEVATIONS_DEG[0]);
            let (up, out) = libm::sincos(elevation.to_radians());
            let own = DVec3::new(out * cosine, out * sine, up);
            let direction = rotation * own;
            let (noise, lost) = (normal(random), random.uniform());
            let mut range = if direction.z < 0.0 { -place.z / direction.z } else { f64::INFINITY };
            for body in &near {
                let Some([begin, end]) = body.hit(place, direction) else { continue };
                let begin = match body {
                    Body::Crown { .. } => begin - FOLIAGE_M * libm::log(1.0 - random.uniform()),
                    _ => begin,
                };
                if begin < end && begin < range {
                    range = begin;
                }
            }
            if lost > LOST && (RANGE_M[0]..=RANGE_M[1]).contains(&range) {
                points.push((own * (range + NOISE_M * noise)).as_vec3());
            }
        }
    }
    points
}
