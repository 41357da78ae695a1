//! Poses at which a body rests on a level surface.

use glam::{DQuat, DVec3};

use super::body::{Body, Pose};
use super::part::ConvexPart;

/// The pose of a body on the facet of its hull that it comes to lie on, with its centre of mass over the same place and its
/// lowest point at the height 0; and the angle by which it turns, radians.
///
/// A body that is let go on a level surface rolls from facet to facet, each time over the edge that its centre of mass is
/// beyond, and gets lower until it is over a facet.
pub fn levelled(body: &Body) -> Option<(Pose, f64)> {
    let points: Vec<DVec3> = body.parts.iter().flat_map(|part| part.positions.iter().copied()).collect();
    let hull = ConvexPart::hull(&points)?;
    let down = body.pose.rotation.inverse() * DVec3::NEG_Z;
    let normal = resting_normal(&hull, body.mass.center, down)?;
    let turn = DQuat::from_rotation_arc((body.pose.rotation * normal).normalize(), DVec3::NEG_Z);
    let rotation = (turn * body.pose.rotation).normalize();
    let center = body.pose.apply(body.mass.center);
    let mut pose = Pose { rotation, translation: center - rotation * body.mass.center };
    pose.translation.z -= body.points(pose).map(|p| p.z).fold(f64::INFINITY, f64::min);
    Some((pose, libm::acos(down.dot(normal).clamp(-1.0, 1.0))))
}

/// The outward normal of the facet that a body comes to lie on when it is let go with this direction down.
fn resting_normal(hull: &ConvexPart, center: DVec3, down: DVec3) -> Option<DVec3> {
    let normals: Vec<DVec3> = hull.corners().map(|[a, b, c]| (b - a).cross(c - a).normalize_or_zero()).collect();
    let best = |a: &usize, b: &usize| down.dot(normals[*a]).total_cmp(&down.dot(normals[*b]));
    let mut facet = (0..normals.len()).max_by(best)?;
    // The height of the centre falls with each step, but for rounding.
    for _ in 0..normals.len() {
        let corners = hull.triangles[facet].map(|i| hull.positions[i as usize]);
        let outside = |i: usize| {
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            normals[facet].dot((b - a).cross(center - a)) / (b - a).length().max(1e-300)
        };
        let edge = (0..3).min_by(|i, k| outside(*i).total_cmp(&outside(*k)))?;
        if outside(edge) >= 0.0 {
            break;
        }
        let [a, b] = [edge, (edge + 1) % 3].map(|i| hull.triangles[facet][i]);
        let other = (0..normals.len()).find(|&k| {
            let t = hull.triangles[k];
            k != facet && (0..3).any(|i| t[i] == b && t[(i + 1) % 3] == a)
        })?;
        facet = other;
    }
    Some(normals[facet])
}
