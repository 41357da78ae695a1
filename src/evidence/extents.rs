//! Scale initialisation from the clouds' boxes (paper §3.1), and the frames in which the stages work.
//!
//! Every stage after this one sees both clouds centred and with a box diagonal of 1: the mesh is thereby
//! already scaled by s_init, one support radius fits both, and a hypothesis' scale *is* its ratio to s_init.

use nalgebra::{Rotation3, Vector3};

use crate::error::{Error, ErrorCode, Result};
use crate::geometry::cloud::{Bounds, Cloud};
use crate::geometry::similarity::{Similarity, vec3, vector3};
use crate::number::number;

/// The box of a cloud: its middle and the length of its diagonal, in the cloud's own unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extents {
    center: Vector3<f64>,
    diagonal: f64,
}

impl Extents {
    /// The extents of points. `argument` names them in errors.
    ///
    /// # Errors
    /// [`ErrorCode::TooFewPoints`] for no points, [`ErrorCode::DegeneratePoints`] where all coincide.
    pub fn of(argument: &str, points: &[glam::Vec3]) -> Result<Self> {
        let bounds = Bounds::of(points).ok_or_else(|| no_points(argument))?;
        Self::from_corners(argument, vector3(bounds.min), vector3(bounds.max))
    }

    /// The extents of points in f64, x, y, z one after the other: coordinates far from the origin
    /// (map frames, UTM) keep their digits.
    ///
    /// # Errors
    /// As [`Extents::of`].
    pub fn of_flat(argument: &str, xyz: &[f64]) -> Result<Self> {
        let mut points = xyz.chunks_exact(3).map(Vector3::from_column_slice);
        let first = points.next().ok_or_else(|| no_points(argument))?;
        let (min, max) = points.fold((first, first), |(min, max), p| (min.inf(&p), max.sup(&p)));
        Self::from_corners(argument, min, max)
    }

    fn from_corners(argument: &str, min: Vector3<f64>, max: Vector3<f64>) -> Result<Self> {
        let diagonal = (max - min).norm();
        if !(diagonal.is_finite() && diagonal > 0.0) {
            return Err(Error::new(
                ErrorCode::DegeneratePoints,
                argument.to_owned(),
                format!("a box diagonal of {}", number(diagonal)),
                "points that span a finite box",
                "Check that the points are not all the same and not beyond what an f32 holds.",
            ));
        }
        Ok(Self { center: (min + max) * 0.5, diagonal })
    }

    /// The length of the box diagonal.
    pub fn diagonal(&self) -> f64 {
        self.diagonal
    }

    /// The same middle with another diagonal: where the scale between two clouds is known, their boxes need not say it.
    pub fn with_diagonal(self, diagonal: f64) -> Self {
        Self { diagonal, ..self }
    }

    /// The transform from the cloud's own frame to the one with the box centred and its diagonal 1.
    pub fn unit_from_own(&self) -> Similarity {
        let scale = 1.0 / self.diagonal;
        Similarity { scale, rotation: Rotation3::identity(), translation: -self.center * scale }
    }

    /// The cloud, centred and scaled to a diagonal of 1.
    pub fn normalized(&self, cloud: &Cloud) -> Cloud {
        let unit_from_own = self.unit_from_own();
        let points = cloud.points.iter().map(|&p| vec3(&unit_from_own.apply(vector3(p)))).collect();
        Cloud { points, normals: cloud.normals.clone() }
    }

    /// As [`Extents::normalized`], for f64 points.
    pub fn normalized_flat(&self, xyz: &[f64]) -> Cloud {
        let unit_from_own = self.unit_from_own();
        let points = xyz.chunks_exact(3).map(|p| vec3(&unit_from_own.apply(Vector3::from_column_slice(p))));
        Cloud::from_points(points.collect())
    }
}

/// s_init = ‖extent(P_obs)‖ / ‖extent(P_rec)‖.
pub fn initial_scale(observed: &Extents, reconstructed: &Extents) -> f64 {
    observed.diagonal / reconstructed.diagonal
}

/// A transform between the normalised frames, taken back to the clouds' own frames.
pub fn target_from_source(target: &Extents, unit: &Similarity, source: &Extents) -> Similarity {
    target.unit_from_own().inverse().compose(unit).compose(&source.unit_from_own())
}

fn no_points(argument: &str) -> Error {
    Error::new(ErrorCode::TooFewPoints, argument.to_owned(), "no points", "points", "Check how the cloud was made.")
}
