//! Mass, centre of mass and inertia of bodies of one density.

use glam::{DMat3, DQuat, DVec3};
use sim3align_geometry::symmetric_eigen::{SymmetricEigen, outer};

use super::part::ConvexPart;

/// Mass properties of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mass {
    /// Kilograms.
    pub mass: f64,
    /// The centre of mass.
    pub center: DVec3,
    /// Moments of inertia about the principal axes through the centre of mass, kg·m².
    pub moments: DVec3,
    /// The rotation from the principal axes to the frame of the body.
    pub axes: DQuat,
}

impl Mass {
    /// Of parts that do not overlap.
    pub fn of(parts: &[ConvexPart], density: f64) -> Self {
        Self::inside(parts.iter().flat_map(ConvexPart::corners), density)
    }

    /// Of what triangles that face outward enclose.
    pub fn inside(corners: impl Iterator<Item = [DVec3; 3]>, density: f64) -> Self {
        let (mut volume, mut first, mut second) = (0.0, DVec3::ZERO, DMat3::ZERO);
        for [a, b, c] in corners {
            // The tetrahedron of the triangle and the origin: the integrals of 1, x and x·xᵀ over it.
            let six = a.dot(b.cross(c));
            let sum = a + b + c;
            volume += six / 6.0;
            first += six / 24.0 * sum;
            second += (outer(a) + outer(b) + outer(c) + outer(sum)) * (six / 120.0);
        }
        let center = first / volume.max(1e-300);
        let about = (second - outer(center) * volume) * density;
        let trace = about.x_axis.x + about.y_axis.y + about.z_axis.z;
        let SymmetricEigen { values, vectors } = SymmetricEigen::of(DMat3::IDENTITY * trace - about);
        let [x, y] = [vectors[0], vectors[1]];
        let axes = DQuat::from_mat3(&DMat3::from_cols(x, y, x.cross(y))).normalize();
        Self { mass: density * volume, center, moments: DVec3::from_array(values).max(DVec3::splat(1e-12)), axes }
    }
}
