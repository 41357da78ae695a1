//! The body on which most calls are tried, and what cameras see of it.

use sim3align::align::align;
use sim3align::evidence::frame::Frame;
use sim3align::metrics::pose_error::{PoseErrors, pose_errors};
use sim3align::views::View;

use crate::prelude::*;
use crate::shapes::rendered;
pub use crate::shapes::truth;

pub const WIDTH: usize = 200;
pub const HEIGHT: usize = 160;

/// A body that no turn maps onto itself.
pub fn body() -> Mesh {
    let wave = |x: f32| libm::sinf(x);
    mapped(&ellipsoid(Vec3::new(0.5, 0.38, 0.3), 24), |p| {
        p * (1.0 + 0.5 * wave(4.0 * p.x + 1.0) * wave(5.0 * p.y + 0.5) + 0.3 * wave(9.0 * p.z + 5.0 * p.x - 1.0))
    })
}

pub fn camera() -> Pinhole {
    Pinhole::new(350.0, 350.0, 99.5, 79.5).unwrap()
}

/// The mesh as `pose` puts it, 15 cm or more before a wall.
pub fn observe(mesh: &Mesh, pose: &Similarity) -> Observation {
    rendered(mesh, pose, camera(), [WIDTH, HEIGHT], |z| if z > 0.0 { z } else { 0.9 })
}

/// Few rotations and few candidates: the body is clear.
pub fn quick() -> AlignOptions {
    AlignOptions {
        quality: Quality::Fast,
        surface_samples: 500,
        max_observed_points: 500,
        symmetry: Symmetry::None,
        ..AlignOptions::default()
    }
}

pub fn solve(options: &AlignOptions) -> Alignment {
    let mesh = body();
    align(&observe(&mesh, &truth()), &mesh, options, &mut Silent).unwrap()
}

/// The pose of an object that has turned about the vertical of the camera.
pub fn orbit(angle: f64) -> Similarity {
    let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), angle);
    Similarity { rotation: turn * truth().rotation, ..truth() }
}

/// An observation as a frame of a video, or of one of several views.
pub fn frame_of(seen: &Observation) -> Frame {
    Frame {
        depth: seen.depth().clone(),
        camera: seen.camera(),
        mask: Some(seen.mask().clone()),
        photo: None,
        relief_deviation: 0.0,
    }
}

pub fn turn_deg(a: &Similarity, b: &Similarity) -> f64 {
    a.rotation_angle_to(b).to_degrees()
}

pub fn errors(mesh: &Mesh, found: &Similarity, truth: &Similarity) -> PoseErrors {
    pose_errors(mesh, found, truth, &Symmetry::None.group(mesh).unwrap()).unwrap()
}

/// Panics unless a pose is right: size and place within 5 %, rotation within 10°.
#[track_caller]
pub fn assert_right(mesh: &Mesh, found: &Similarity, truth: &Similarity, what: &str) {
    let errors = errors(mesh, found, truth);
    let is_right =
        errors.scale_error < 0.05 && errors.rotation_error_deg < 10.0 && errors.translation_error_relative < 0.05;
    assert!(is_right, "{what}: {errors:?}");
}

/// The images of cameras that are turned about the object by these angles; the world is the frame of the camera at 0.
pub fn views(mesh: &Mesh, angles: &[f64]) -> Vec<View> {
    let view = |angle: &f64| View {
        frame: frame_of(&observe(mesh, &orbit(*angle))),
        world_from_camera: Some(truth().compose(&orbit(*angle).inverse())),
    };
    angles.iter().map(view).collect()
}
