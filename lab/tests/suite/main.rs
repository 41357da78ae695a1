//! The test of case folders, and the check of the generated TypeScript. Native only.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod folders;
mod typescript;
