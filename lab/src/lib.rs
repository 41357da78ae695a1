//! Generated cases with known true poses, readers and writers of case folders, and benchmarks. Not part of the published
//! package.

pub mod bench;
pub mod case;
pub mod case_folder;
pub mod clouds;
mod conditions;
mod effects;
mod files;
mod names;
mod numbers;
mod objects;
pub mod parallel;
pub mod prelude;
pub mod sets;
mod world;
