//! Structural fuzzing: inputs that are valid by type and hostile by content, drawn from a seed.
//!
//! An input is what a generator makes of a list of whole numbers, its [`choices`]; 0 is always the plainest choice. The
//! list is short even where the input has a million triangles. It can be drawn from a seed, read from a file, taken from
//! a coverage-guided fuzzer, and made smaller without knowledge of what it describes.

pub mod choices;
pub mod cpu;
pub mod memory;
pub mod minimise;
mod options;
pub mod target;
mod targets;
mod views;

mod clouds;
mod meshes;
