//! Stable poses: the attitudes in which a mesh stands on a plane.
//!
//! A body at rest has its centre of mass as low as it gets by small turns. From many directions, the mesh rolls down to
//! such attitudes; the plane of a face that touches the ground then gives the direction more exactly than the few
//! vertices that a generated underside happens to stand on.

use glam::{DMat3, DVec3, Vec3};

use crate::geometry::angle::sin_cos;
use crate::geometry::cloud::farthest_along;
use crate::geometry::mesh::Mesh;
use crate::geometry::rotations::fibonacci_sphere;
use crate::geometry::surface::SurfaceMoments;
use crate::geometry::symmetric_eigen::SymmetricEigen;

/// A stable attitude of a mesh on a plane, in the normalised frame of the mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StablePose {
    /// The unit direction that points into the plane.
    pub down: DVec3,
    /// The centre of what touches the plane.
    pub base: DVec3,
    /// Two unit axes about which the object may tip, perpendicular to `down` and to each other.
    pub axes: [DVec3; 2],
    /// The stability about each axis, 0 (it rolls) to 1.
    pub stability: [f64; 2],
}

/// Directions in which extreme vertices are found.
const DIRECTIONS: usize = 600;
/// Directions from which the mesh rolls.
const STARTS: usize = 150;
/// Steps of the descent, the angle of the first one in radians, and the ratio of successive steps: three radians in
/// total.
const STEPS: usize = 150;
const FIRST_STEP: f64 = 0.12;
const SHORTER: f64 = 0.96;
/// Minimum angle between attitudes, as a difference of unit vectors.
const APART: f64 = 0.06;
/// Maximum number of attitudes.
const MOST: usize = 48;
/// Height over the lowest point within which the surface may touch the ground, relative to the diagonal.
const BASE: f64 = 0.025;
/// Cosine of the angle to the ground up to which a triangle may be of the base, and the area that a base has at least,
/// relative to the squared diagonal.
const FACING: f32 = 0.85;
const BASE_AREA: f64 = 0.004;
/// Maximum difference between the face and the direction of the descent.
const FACE_TILT: f64 = 0.2;
/// The tilt at which stability is measured, radians, and the radius of a base that stands securely, relative to the
/// diagonal.
const TIP: f64 = 0.1;
const FIRM_RADIUS: f64 = 0.1;
/// The rise below which it falls over, relative to the diagonal and the tilt.
const FALL_RISE: f64 = -0.02;

/// The attitudes of a mesh in its normalised frame.
pub fn stable_poses(mesh: &Mesh) -> Vec<StablePose> {
    let center = SurfaceMoments::of(mesh).centroid;
    let extremes = extremes(mesh.positions(), center);
    let mut stable_poses: Vec<StablePose> = Vec::new();
    for k in 0..STARTS {
        let down = rolled(&extremes, fibonacci_sphere(k, STARTS));
        // Compared before the face is fitted, which takes longer.
        if stable_poses.len() >= MOST || stable_poses.iter().any(|known| (known.down - down).length() < APART) {
            continue;
        }
        let Some(stable) = standing(mesh, center, &extremes, down) else { continue };
        if stable_poses.iter().all(|known| (known.down - stable.down).length() >= APART) {
            stable_poses.push(stable);
        }
    }
    stable_poses
}

/// The extreme vertices, relative to the centre.
fn extremes(positions: &[Vec3], center: DVec3) -> Vec<DVec3> {
    let mut kept = vec![false; positions.len()];
    for k in 0..DIRECTIONS {
        let farthest = farthest_along(positions, fibonacci_sphere(k, DIRECTIONS).as_vec3());
        farthest.into_iter().for_each(|i| kept[i] = true);
    }
    positions.iter().zip(kept).filter(|(_, kept)| *kept).map(|(p, _)| p.as_dvec3() - center).collect()
}

/// The extreme point of a direction.
fn lowest(points: &[DVec3], down: DVec3) -> DVec3 {
    let mut best = (f64::NEG_INFINITY, DVec3::ZERO);
    for p in points {
        let along = p.dot(down);
        if along > best.0 {
            best = (along, *p);
        }
    }
    best.1
}

/// The direction in which the mesh comes to stable when it is put down in the direction `down`.
fn rolled(points: &[DVec3], mut down: DVec3) -> DVec3 {
    let mut step = FIRST_STEP;
    for _ in 0..STEPS {
        let touching = lowest(points, down);
        // The centre is highest over the touching point when that is straight below: it rolls the other way.
        let Some(uphill) = (touching - down * touching.dot(down)).try_normalize() else { break };
        down = (down - uphill * step).normalize_or(down);
        step *= SHORTER;
    }
    down
}

/// The attitude near a direction: the face that touches the ground, and how firmly it stands; `None` where it falls over,
/// balanced on an edge.
fn standing(mesh: &Mesh, center: DVec3, extremes: &[DVec3], rolled: DVec3) -> Option<StablePose> {
    let mut down = rolled;
    let mut base = center + down * lowest(extremes, down).dot(down);
    for _ in 0..2 {
        let Some((normal, middle)) = face(mesh, center, extremes, down) else { break };
        if (normal - rolled).length() > FACE_TILT {
            break;
        }
        (down, base) = (normal, middle);
    }
    let height = |down: DVec3| lowest(extremes, down).dot(down);
    let across = down.any_orthonormal_vector();
    let other = down.cross(across);
    // How much the centre rises when it tips: about the radius of the base times the angle.
    let rise = |angle: f64| {
        let (sin, cos) = sin_cos(angle);
        let side = across * cos + other * sin;
        let tipped = |sign: f64| height((down + side * (sign * TIP)).normalize_or(down)) - height(down);
        tipped(1.0).min(tipped(-1.0)) / TIP
    };
    let angles = (0..8).map(|k| core::f64::consts::PI * f64::from(k) / 8.0);
    let loosest =
        angles.map(|angle| (rise(angle), angle)).fold((f64::INFINITY, 0.0), |a, b| if b.0 < a.0 { b } else { a });
    if loosest.0 < FALL_RISE {
        return None;
    }
    let firm = |radius: f64| (radius / FIRM_RADIUS).clamp(0.0, 1.0);
    let (sin, cos) = sin_cos(loosest.1);
    let moves = across * cos + other * sin;
    // To move `down` along `moves`, it tips about the axis perpendicular to it.
    let tips = down.cross(moves);
    let along = rise(loosest.1 + core::f64::consts::FRAC_PI_2);
    Some(StablePose { down, base, axes: [tips, moves], stability: [firm(loosest.0), firm(along)] })
}

/// The unit normal, outwards, and the centre of the face that touches the ground.
fn face(mesh: &Mesh, center: DVec3, extremes: &[DVec3], down: DVec3) -> Option<(DVec3, DVec3)> {
    let ground = lowest(extremes, down).dot(down) - BASE;
    let (mut area, mut sum, mut second) = (0.0, DVec3::ZERO, DMat3::ZERO);
    let outer = |v: DVec3| DMat3::from_cols(v * v.x, v * v.y, v * v.z);
    for triangle in mesh.triangles() {
        let [a, b, c] = mesh.corners(*triangle);
        let normal = (b - a).cross(c - a);
        // Meshes may be inside out.
        if normal.dot(down.as_vec3()).abs() < FACING * normal.length() {
            continue;
        }
        let [a, b, c] = [a, b, c].map(|p| p.as_dvec3() - center);
        let all = a + b + c;
        if all.dot(down) < 3.0 * ground {
            continue;
        }
        let weight = 0.5 * f64::from(normal.length());
        area += weight;
        sum += all * (weight / 3.0);
        // ∫ x xᵀ over a triangle is A/12 · (Σ vᵢvᵢᵀ + (Σ vᵢ)(Σ vᵢ)ᵀ).
        second += (outer(a) + outer(b) + outer(c) + outer(all)) * (weight / 12.0);
    }
    if area < BASE_AREA {
        return None;
    }
    let mean = sum / area;
    let spread = second * (1.0 / area) - outer(mean);
    let eigen = SymmetricEigen::of(spread);
    // A strip has no plane.
    if eigen.values[1] < 10.0 * eigen.values[0] {
        return None;
    }
    let normal = eigen.vectors[0];
    let normal = if normal.dot(down) < 0.0 { -normal } else { normal };
    Some((normal, mean + center))
}
