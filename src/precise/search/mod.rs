//! The search: from an observation and a mesh to the best poses.
//!
//! In: an observation, a prepared mesh and the settings of the [`recipe`]. Out: [`Rounds`](rounds::Rounds) with the poses
//! found, best first. Only the score accepts a step of a refinement, and ties are broken by the order of the tasks: pauses
//! and workers must not change a bit of the result.

pub mod ascent;
pub mod cascade;
pub mod coarse;
pub mod efforts;
pub mod plate;
pub mod problem;
pub mod proportions;
pub mod ranking;
pub mod recipe;
pub mod refine;
pub mod rounds;
pub mod start;
pub mod tasks;
