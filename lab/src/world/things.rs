//! Things around objects: neighbours, occluders, clutter.

use crate::objects::solid::Solid;
use crate::prelude::*;

use super::view::View;

/// Adds a random cylinder, box or ellipsoid of this half width and height, which stands on `spot`, tilted by `lean`
/// radians.
pub fn block(solid: &mut Solid, spot: DVec3, lean: f64, half_width: f64, height: f64, random: &mut Random) {
    let heading = DAffine3::from_rotation_z(TAU * random.uniform());
    let frame = DAffine3::from_translation(spot) * heading * DAffine3::from_rotation_x(lean);
    match random.below(3) {
        0 => solid.at(frame).cylinder([half_width, half_width * between(random, 0.6, 1.0)], height),
        1 => {
            let half = DVec3::new(half_width, half_width * between(random, 0.4, 1.0), 0.5 * height);
            solid.at(frame * lifted(half.z)).cuboid(half, 0.05 * half_width);
        }
        _ => {
            let radii = DVec3::new(half_width, half_width * between(random, 0.7, 1.0), 0.5 * height);
            solid.at(frame * lifted(radii.z)).ellipsoid(radii);
        }
    }
}

/// Adds a bar that crosses the object in the image, nearer than the object: a pen, a cable, the edge of a shelf.
pub fn bar(object: &[f32], view: &View, random: &mut Random, solid: &mut Solid) {
    let pixels = || {
        let set = object.iter().enumerate().filter(|(_, z)| **z > 0.0);
        set.map(|(i, _)| view.place(i).map(|x| x as f64)).map(DVec2::from_array)
    };
    let count = pixels().count().max(1) as f64;
    let nearest = object.iter().filter(|z| **z > 0.0).fold(f64::INFINITY, |near, z| near.min(f64::from(*z)));
    let mean = pixels().sum::<DVec2>() / count;
    let (mut uu, mut uv, mut vv) = (0.0, 0.0, 0.0);
    for DVec2 { x, y } in pixels().map(|p| p - mean) {
        (uu, uv, vv) = (uu + x * x / count, uv + x * y / count, vv + y * y / count);
    }
    let long = 0.5 * libm::atan2(2.0 * uv, uu - vv);
    let along = super::unit(long);
    let deviation = (uu * along.x * along.x + 2.0 * uv * along.x * along.y + vv * along.y * along.y).max(1.0).sqrt();
    // About at right angles to the longest direction, off its middle, so that the parts differ.
    let centre = mean + along * (deviation * between(random, -0.8, 0.8));
    let across = super::unit(long + FRAC_PI_2 + between(random, -0.6, 0.6));
    let thickness = (deviation * between(random, 0.2, 0.6)).max(7.0 * view.resolution());
    let z = nearest * between(random, 0.75, 0.93);
    let ends = [-4.0, 4.0].map(|t| {
        let pixel = centre + across * (t * deviation);
        let point = view.camera.back_project(pixel.x, pixel.y, z * between(random, 0.96, 1.04));
        DVec3::from_array(view.camera_from_world.inverse().apply(vector3(point)).into())
    });
    let axis = ends[1] - ends[0];
    let turn = DQuat::from_rotation_arc(DVec3::Z, axis.normalize_or(DVec3::Z));
    let radius = 0.5 * thickness * z / view.camera.fx;
    let frame = DAffine3::from_rotation_translation(turn, ends[0]);
    solid.at(frame).cylinder([radius, radius * between(random, 0.7, 1.0)], axis.length());
}

fn lifted(height: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::Z * height)
}
