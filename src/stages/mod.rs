//! The steps of the method, one noun a file. Depends on geometry only.

pub mod observe;
