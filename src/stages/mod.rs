//! The steps of the method, one noun a file. Depends on geometry only.

pub mod extents;
pub mod fpfh;
pub mod matching;
pub mod observe;
pub mod umeyama;
