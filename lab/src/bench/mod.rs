//! The benchmark: runs methods over cases, keeps records of the results, and imports results of other programs.

pub mod benchmark;
pub mod case_line;
pub mod generators;
pub mod imported;
pub mod option_text;
pub mod overlay;
pub mod proportions;
pub mod records;
pub mod scene_bench;
pub mod statistics;
pub mod warning_tally;
