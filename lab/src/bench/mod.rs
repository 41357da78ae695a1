//! The benchmark: rows of calls over cases, and one form of result for all of them.

pub mod calls;
mod imported;
pub mod records;
pub mod result;
pub mod row;
pub mod table;
pub mod variants;
