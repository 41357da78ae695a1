//! Undersides that a generative model invents: nobody has seen them.

use crate::cases::distortion::{box_of, normals, with_vertices};
use crate::prelude::*;

/// Height of what counts as the underside, relative to the height of the object.
const BAND: f64 = 0.3;
/// Largest tilt of the underside, radians, and largest bulge and change of height, relative to the diagonal.
const TILT: f64 = 0.07;
const BULGE: f64 = 0.015;
const LIFT: f64 = 0.012;

/// A mesh in the world's frame with another underside: tilted, bulged, higher or lower. Returns its tilt, radians.
pub fn invented_underside(mesh: &Mesh, random: &mut Random) -> Result<(Mesh, f64)> {
    let points: Vec<DVec3> = mesh.positions().iter().map(|p| p.as_dvec3()).collect();
    let (low, high) = box_of(points.iter().copied());
    let (middle, diagonal) = ((low + high) * 0.5, (high - low).length());
    let tilt = between(random, 0.0, TILT);
    let (sine, cosine) = libm::sincos(TAU * random.uniform());
    let slope = DVec3::new(cosine, sine, 0.0) * libm::tan(tilt);
    let [bulge, lift] = [BULGE, LIFT].map(|most| between(random, -most, most) * diagonal);
    let radius = 0.5 * (high - low).truncate().length();
    let smooth = |x: f64| {
        let x = x.clamp(0.0, 1.0);
        x * x * (3.0 - 2.0 * x)
    };
    let positions = points.iter().zip(normals(mesh)).map(|(p, normal)| {
        let is_low = smooth(1.0 - (p.z - low.z) / (BAND * (high.z - low.z)).max(1e-9));
        let is_below = smooth((-normal.z - 0.2) / 0.6);
        let across = (*p - middle).with_z(0.0);
        let round = 1.0 - (across.length() / radius.max(1e-9)).min(1.0);
        let change = across.dot(slope) + lift - bulge * round;
        (*p + DVec3::Z * (is_low * is_below * change)).as_vec3()
    });
    Ok((with_vertices(mesh, positions)?, tilt))
}
