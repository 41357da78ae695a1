//! Scale initialisation from bounding boxes (paper §3.1), and the normalised frames of the later stages.
//!
//! In the normalised frames, both clouds are centred with a box diagonal of 1: the mesh is thus scaled by s_init, one
//! support radius fits both clouds, and the scale of a hypothesis is its ratio to s_init.

use nalgebra::{Rotation3, Vector3};

use crate::error::{Error, ErrorCode, Result};
use crate::geometry::cloud::{Bounds, Cloud};
use crate::geometry::similarity::{Similarity, vec3, vector3};
use crate::number::number;

/// The bounding box of a cloud: its centre and the length of its diagonal, in the unit of the cloud.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extents {
    center: Vector3<f64>,
    diagonal: f64,
}

impl Extents {
    /// The extents of points. `argument` names them in errors.
    ///
    /// # Errors
    /// [`ErrorCode::TooFewPoints`] for no points, [`ErrorCode::DegeneratePoints`] if all coincide.
    pub fn of(argument: &str, points: &[glam::Vec3]) -> Result<Self> {
        let bounds = Bounds::of(points).ok_or_else(|| no_points(argument))?;
        Self::from_corners(argument, vector3(bounds.min), vector3(bounds.max))
    }

    /// The extents of f64 points (interleaved x, y, z): coordinates far from the origin (map frames, UTM) keep their
    /// precision.
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

    /// The same centre with another diagonal, for clouds whose relative scale is known.
    pub fn with_diagonal(self, diagonal: f64) -> Self {
        Self { diagonal, ..self }
    }

    /// The transform from the frame of the cloud to its normalised frame: box centred, diagonal 1.
    pub fn unit_from_own(&self) -> Similarity {
        let scale = 1.0 / self.diagonal;
        Similarity { scale, rotation: Rotation3::identity(), translation: -self.center * scale }
    }

    /// The cloud in its normalised frame; normals are unchanged.
    pub fn normalized(&self, cloud: &Cloud) -> Cloud {
        let unit_from_own = self.unit_from_own();
        let points = cloud.points.iter().map(|&p| vec3(&unit_from_own.apply(vector3(p)))).collect();
        Cloud { points, normals: cloud.normals.clone() }
    }

    /// Like [`Extents::normalized`], for f64 points (interleaved x, y, z).
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

/// Converts a transform between normalised frames to the frames of the clouds.
pub fn target_from_source(target: &Extents, unit: &Similarity, source: &Extents) -> Similarity {
    target.unit_from_own().inverse().compose(unit).compose(&source.unit_from_own())
}

fn no_points(argument: &str) -> Error {
    Error::new(ErrorCode::TooFewPoints, argument.to_owned(), "no points", "points", "Check the source of the cloud.")
}
