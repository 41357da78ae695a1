//! Structural fuzzing: inputs that are valid by type and hostile by content, drawn from a seed.
//!
//! A generator turns a list of integers, the [`choices`], into an input; 0 is always the simplest choice. The list is
//! short even if the input has a million triangles. It can be drawn from a seed, read from a file, taken from a
//! coverage-guided fuzzer, and minimised without knowledge of the input.

pub mod call;
pub mod choices;
pub mod memory;
pub mod minimise;
mod options;
pub mod target;
mod targets;
mod views;

mod clouds;
mod meshes;
