//! Case folders: one observation, one mesh and, where it is known, the true pose.

pub mod case;
pub mod write;
