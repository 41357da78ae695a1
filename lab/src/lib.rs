//! What the aligner is measured with, and never ships: generated cases with a known truth, readers of case folders, and
//! other methods for the same task.

pub mod baselines;
pub mod case_folder;
pub mod samples;
