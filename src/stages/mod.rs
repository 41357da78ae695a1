//! The steps of the method, one noun a file. Depends on geometry only.

pub mod compatibility;
pub mod density;
pub mod extents;
pub mod filter;
pub mod fpfh;
pub mod free_space;
pub mod grid_cloud;
pub mod icp;
pub mod matching;
pub mod normals;
pub mod observe;
pub mod ransac;
pub mod sample;
pub mod search;
pub mod tukey;
pub mod umeyama;
