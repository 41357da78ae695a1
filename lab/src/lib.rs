//! Generated cases with known true poses, readers and writers of case folders, and benchmarks. Not part of the published
//! package.

pub mod bench;
pub mod case;
pub mod case_folder;
pub mod clouds;
mod conditions;
pub mod cost;
mod draws;
mod effects;
mod files;
pub mod names;
mod objects;
pub mod parallel;
pub mod prelude;
pub mod sets;
pub mod statistics;
mod world;
