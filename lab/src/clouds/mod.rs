//! Pairs of point clouds with a known transform: the protocols of 3DMatch, 3DLoMatch and KITTI odometry, and generated
//! pairs in the same layouts.

pub mod cloud_file;
pub mod generated;
pub mod kitti;
pub mod overlap;
pub mod pair;
mod places;
mod sensors;
pub mod three_d_match;
mod trajectory;
