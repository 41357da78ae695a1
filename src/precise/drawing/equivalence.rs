//! Equivalence: poses that a symmetry of the mesh makes one.

use glam::{DMat3, DQuat, DVec3};
use nalgebra::{Quaternion, UnitQuaternion};

use crate::geometry::rotations::angle_between;
use crate::metrics::symmetry::SymmetryGroup;
use crate::report::FoundSymmetry;

/// Rolls about an axis of revolution that average a symmetric matrix.
const ROLLS: usize = 4;

/// Minimum rotation between different poses, radians.
pub const DISTINCT_MIN_ANGLE_RAD: f64 = 0.26;

/// The symmetry of a mesh, for comparing its poses.
#[derive(Debug, Clone, Default)]
pub struct Equivalence(SymmetryGroup);

impl Equivalence {
    /// Of a mesh with this symmetry.
    pub fn new(group: SymmetryGroup) -> Self {
        Self(group)
    }

    /// The rotation from one pose to the other, or to one that is equivalent to it, whichever is smallest, radians.
    pub fn angle(&self, a: DQuat, b: DQuat) -> f64 {
        angle_between(self.nearest(a, b), b)
    }

    /// The rotation nearest to `b` of those that are equivalent to `a`.
    pub fn nearest(&self, a: DQuat, b: DQuat) -> DQuat {
        if !self.is_any() {
            return a;
        }
        a * DQuat::from_array(self.0.nearest(&turn_between(a, b)).coords.into())
    }

    /// The rotations that are equivalent to `a`, by their nearness to `b`; about an axis of revolution, the nearest one.
    pub fn by_nearness(&self, a: DQuat, b: DQuat) -> Vec<DQuat> {
        let members = self.0.by_nearness(&turn_between(a, b));
        members.iter().map(|member| a * DQuat::from_array(member.coords.into())).collect()
    }

    /// The rotations that are equivalent to this one, without it: all of a finite group, and `rolls` about an axis of
    /// revolution. None for a sphere.
    pub fn others(&self, rotation: DQuat, rolls: usize) -> Vec<DQuat> {
        let members = self.0.members(rolls).into_iter().skip(1);
        members.map(|turn| rotation * DQuat::from_array(turn.coords.into())).collect()
    }

    /// The probability of any of so many rotations that are equivalent to one another, `rolls` of them about an axis of revolution;
    /// `None` if a rotation has no equivalent.
    pub fn chance(&self, rolls: usize) -> Option<f64> {
        let count = self.0.members(rolls).len();
        (count > 1).then(|| 1.0 / count as f64)
    }

    /// The mean of a symmetric matrix in the frame of the mesh over all rotations that leave its shape as it is.
    pub fn mean(&self, matrix: &DMat3) -> DMat3 {
        if self.is_sphere() {
            let third = (matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z) / 3.0;
            return DMat3::from_diagonal(DVec3::splat(third));
        }
        // Three rolls or more average what has two waves in a turn.
        let members = self.0.members(ROLLS);
        let turned = members.iter().map(|turn| {
            let turn = DMat3::from_quat(DQuat::from_array(turn.coords.into()));
            turn.transpose() * *matrix * turn
        });
        turned.fold(DMat3::ZERO, |sum, one| sum + one) * (1.0 / members.len() as f64)
    }

    /// The axis, in the camera frame, about which the symmetry leaves the rotation of a pose free.
    pub fn free_axis(&self, rotation: DQuat) -> Option<DVec3> {
        self.0.axis_of_revolution().map(|axis| rotation * DVec3::from_array(axis.into_inner().into()))
    }

    /// The axes that generate the symmetry.
    pub fn axes(&self) -> Vec<FoundSymmetry> {
        self.0.axes().iter().map(FoundSymmetry::from).collect()
    }

    /// Whether the symmetry makes some poses one.
    pub fn is_any(&self) -> bool {
        !self.0.is_trivial()
    }

    /// Whether every rotation is a symmetry.
    pub fn is_sphere(&self) -> bool {
        self.0.is_sphere()
    }
}

/// The rotation from `a` to `b`, in the frame of the mesh.
fn turn_between(a: DQuat, b: DQuat) -> UnitQuaternion<f64> {
    UnitQuaternion::new_normalize(Quaternion::from((a.conjugate() * b).to_array()))
}
