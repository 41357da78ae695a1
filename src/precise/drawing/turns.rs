//! Turns: the half and quarter turns of a pose, in which many objects look alike.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DQuat, DVec3};

use super::pose::CropPose;
use crate::geometry::rotations::exp;
use crate::geometry::surface::SurfaceMoments;

/// Angles of the turns about an axis, radians.
const ANGLES: [f64; 3] = [PI, FRAC_PI_2, -FRAC_PI_2];
/// Number of [`Turns::of`] a pose: about three axes and the line of sight.
pub const TURNS: usize = 4 * ANGLES.len();
/// Minimum depth of a turned pose relative to that of the pose, so that the mesh stays in front of the camera.
const NEAREST: f64 = 0.1;

/// The centre and the axes of turns of a mesh, in its normalised frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turns {
    /// Centroid of the surface.
    center: DVec3,
    /// Principal axes of the surface.
    axes: [DVec3; 3],
}

impl Turns {
    /// The turns of a mesh with these moments of its surface.
    pub fn new(moments: &SurfaceMoments) -> Self {
        Self { center: moments.centroid, axes: moments.principal_axes().vectors }
    }

    /// A pose turned about the principal axes of the mesh, and about the line of sight to its centre.
    pub fn of(&self, pose: &CropPose) -> Vec<CropPose> {
        let (scale, translation) = pose.scale_translation();
        let sight = (pose.rotation * self.center * scale + translation).normalize_or(DVec3::Z);
        let about_axes = self.axes.iter().flat_map(|axis| ANGLES.map(|angle| pose.rotation * exp(*axis * angle)));
        let about_sight = ANGLES.map(|angle| exp(sight * angle) * pose.rotation);
        about_axes.chain(about_sight).map(|rotation| self.turned(pose, rotation)).collect()
    }

    /// A pose turned by `rolls` steps about each principal axis of the mesh, and each of these after a half turn about
    /// another one.
    pub fn about_axes(&self, pose: &CropPose, rolls: usize) -> Vec<CropPose> {
        let turns = (0..3).flat_map(|k| dihedral(self.axes[k], self.axes[(k + 1) % 3], rolls));
        turns.map(|turn| self.turned(pose, pose.rotation * turn)).collect()
    }

    /// The pose with another rotation, and the centre where it was.
    pub fn turned(&self, pose: &CropPose, rotation: DQuat) -> CropPose {
        let rotation = rotation.normalize();
        let (scale, translation) = pose.scale_translation();
        let mut moved = translation + (pose.rotation * self.center - rotation * self.center) * scale;
        moved.z = moved.z.max(NEAREST * translation.z);
        CropPose::new(rotation, scale, moved)
    }
}

/// The rotations of a dihedral group about `axis`: rolls, and as many after a half turn about `across`. The first is none.
pub fn dihedral(axis: DVec3, across: DVec3, rolls: usize) -> impl Iterator<Item = DQuat> {
    let flips = [DQuat::IDENTITY, exp(across * PI)];
    flips.into_iter().flat_map(move |flip| (0..rolls).map(move |k| exp(axis * (TAU * k as f64 / rolls as f64)) * flip))
}
