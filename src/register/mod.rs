//! General registration of two point clouds, without camera or mesh, and the parts that the preset `paper` shares.
//!
//! In: two clouds and [`options`]. Out: a [`Registration`](report::Registration), target from source. The stages are voxel grid,
//! normals, FPFH, mutual matches, consensus and ICP; `paper` and the benchmark compose them anew, so that a stage must not
//! know which method calls it.

pub mod cloud_pair;
pub mod compatibility;
pub mod density;
mod estimate_sim3;
pub(crate) mod feature_registration;
pub mod fpfh;
mod free_scale;
pub mod free_space;
pub mod grid_cloud;
pub mod icp;
mod input;
pub mod matching;
mod normalized_pair;
pub mod options;
mod pose_scorer;
mod pose_selector;
pub mod ransac;
mod registration;
pub mod report;
mod rigid;
pub mod settings;
pub mod support;
pub mod tukey;
pub mod umeyama;

pub use estimate_sim3::{estimate_sim3, estimate_sim3_task};
pub use registration::{register, register_task};
