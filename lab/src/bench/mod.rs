//! The benchmark: rows of calls over cases, and one form of result for all of them.

pub mod calls;
pub mod imported;
pub mod option_text;
pub mod options;
pub mod records;
pub mod result;
pub mod table;
