//! Generated cases with a known true pose, readers of case folders, and other methods for comparison. Not part of the
//! published package.

pub mod baselines;
pub mod bench;
pub mod case_folder;
pub mod cases;
pub mod clouds;
pub mod cpu_time;
mod draws;
pub mod files;
pub mod monocular;
pub mod names;
pub mod outlines;
pub mod parallel;
pub mod prelude;
pub mod samples;
pub mod scenes;
pub mod sequences;
