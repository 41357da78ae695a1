//! The observation: the evidence of a depth map and a mask.
//!
//! In: an [`Observation`](crate::evidence::observation::Observation). Out: the [`CleanObservation`](clean::CleanObservation),
//! which holds the pixels and depths that reliably belong to the object, its grids of cells at any resolution, and where
//! the mask is cut. Nothing here depends on the mesh: the evidence must not depend on the hypothesis that it judges.

pub mod box_fits;
pub mod clean;
pub mod grid;
pub mod mask_boundary;
pub mod ramp;
pub mod resolution;
pub mod thinning;
