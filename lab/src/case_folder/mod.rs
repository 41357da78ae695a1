//! Case folders: one observation, one mesh and optionally the true pose.

pub mod case;
pub(crate) mod contents;
pub mod write;
