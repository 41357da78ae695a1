//! The generators of calls.

pub mod align;
pub mod evaluate;
pub mod joint;
pub mod readers;
pub mod register;
