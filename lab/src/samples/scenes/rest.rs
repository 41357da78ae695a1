//! How an object comes to rest on a plane.

use core::f64::consts::PI;

use glam::DVec3;
use nalgebra::{Matrix3, Rotation3, Vector3};

use sim3align::evidence::sample::SurfaceMoments;
use sim3align_geometry::mesh::Mesh;

/// Steps of the descent, the first one's angle, and how much shorter each next one is: up to half a turn in all, down to
/// 10⁻⁵ rad.
const STEPS: usize = 400;
const FIRST_STEP: f64 = 0.03;
const SHORTER: f64 = 0.98;

/// The direction, in the object's frame, that points down once the object, put on a plane with `down` downwards, has
/// rolled to rest: there its centroid is as low as it gets by small turns.
pub fn resting(mesh: &Mesh, down: DVec3) -> DVec3 {
    let centroid = SurfaceMoments::of(mesh).centroid;
    let points: Vec<DVec3> = mesh.positions().iter().map(|p| p.as_dvec3() - centroid).collect();
    let mut down = down.normalize_or(DVec3::NEG_Z);
    let mut step = FIRST_STEP;
    for _ in 0..STEPS {
        let lowest = points.iter().copied().max_by(|a, b| a.dot(down).total_cmp(&b.dot(down)));
        // Towards the lowest point the centroid stands higher: it rolls the other way.
        let Some(uphill) = lowest.map(|p| p - down * p.dot(down)).and_then(DVec3::try_normalize) else { break };
        down = (down - uphill * step).normalize_or(down);
        step *= SHORTER;
    }
    down
}

/// The turn that brings a direction down and then the object round by `heading` radians.
pub fn turn_down(down: DVec3, heading: f64) -> Matrix3<f64> {
    let below = -Vector3::z();
    let down = Vector3::from(down.to_array());
    let upside_down = || Rotation3::from_axis_angle(&Vector3::x_axis(), PI);
    let lain = Rotation3::rotation_between(&down, &below).unwrap_or_else(upside_down);
    *(Rotation3::from_axis_angle(&Vector3::z_axis(), heading) * lain).matrix()
}
