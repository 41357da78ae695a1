//! Pairs of point clouds with a known transform: the protocols of 3DMatch, 3DLoMatch and KITTI odometry, and generated
//! pairs of decreasing overlap in the same layouts.

pub mod cloud_file;
mod depth_camera;
pub mod kitti;
pub mod lidar;
pub mod lidar_set;
pub mod overlap;
pub mod pair;
pub mod room;
pub mod room_set;
pub mod street;
pub mod three_d_match;
pub mod trajectory;
