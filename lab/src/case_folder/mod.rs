//! Case folders: one observation, one mesh and optionally the true pose.

pub mod camera;
pub mod case;
pub(crate) mod contents;
pub mod json;
pub mod pose;
pub mod write;
