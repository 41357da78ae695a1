//! Other methods for the same task, to compare with: each as published, on the crate's own clouds and solvers.
//!
//! All are rigid but TEASER, which can estimate the scale. Where they need descriptors, normals or a voxel grid, they
//! get those of the paper's method, so that a comparison is one of methods and not of preprocessing.

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
pub mod quatro;
pub mod teaser;
pub mod voting;

pub use baseline::Baseline;
pub use clouds::{Clouds, Solved, UnitSettings};
pub use pair::{PairSettings, register_pair};
