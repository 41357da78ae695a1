//! The tests of what the aligner is measured with, in one binary. Native only, as the lab is.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod baselines;
mod baselines_agreement;
mod baselines_solvers;
mod bop_folder;
mod colors;
mod common;
mod evaluation;
mod imported;
mod monocular;
mod outlines;
mod overlay;
mod real_cases;
mod records;
mod registration;
mod registration_program;
mod samples;
mod scenes;
mod sensors;
// Some of it serves the core's tests alone.
#[allow(dead_code)]
#[path = "../../../tests/suite/shapes.rs"]
mod shapes;
// Some of it serves the core's tests alone.
#[allow(dead_code)]
#[path = "../../../tests/suite/support.rs"]
mod support;
mod typescript;
mod warnings;
