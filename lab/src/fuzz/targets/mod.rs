//! The generators of calls.

pub mod align;
pub mod evaluate;
pub mod readers;
pub mod register;
