//! The tests of the generator and of the readers of case folders, and the check of the generated TypeScript. Native only.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod folders;
mod generator;
mod real_cases;
mod typescript;
