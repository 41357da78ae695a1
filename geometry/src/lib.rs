//! Shapes and spaces, without any notion of alignment. Depends on nothing above it.

pub mod angle;
pub mod clip;
pub mod cloud;
pub mod decimate;
pub mod distance_transform;
pub mod error;
pub mod image;
pub mod kd_tree;
pub mod mesh;
pub mod normal_equations;
pub mod number;
pub mod order;
pub mod pinhole;
pub mod random;
pub mod rasteriser;
pub mod rotations;
pub mod similarity;
pub mod singular_values;
pub mod symmetric_eigen;
pub mod triangle_tree;
pub mod voxel_grid;
