//! Other registration methods for comparison, implemented as published on the clouds and solvers of the aligner.
//!
//! All are rigid except TEASER, which can estimate the scale. Descriptors, normals and voxel grids are those of the
//! paper's method, so that methods are compared and not preprocessing.

pub mod align;
mod baseline;
pub mod clique;
mod clouds;
pub mod fgr;
pub mod gicp;
pub mod gnc;
pub mod icp;
pub mod measurements;
mod pair;
pub mod teaser;
pub mod voting;

pub use baseline::Baseline;
pub use clouds::{Clouds, Settings, Solved};
pub use pair::register_pair;
