//! Aligns generated 3D meshes with a masked depth map: the similarity x_cam = s·R·p + t, after "Robust 3D Alignment of
//! Generative Reconstructions via Partial Monocular Observations".
//!
//! Every module imports only from those below it in this list: [`bindings`], [`track`], [`views`], [`scene`], [`align`],
//! [`precise`], [`paper`], [`register`], [`report`], [`options`], [`metrics`], [`evidence`], [`progress`], [`geometry`].

pub mod align;
pub mod bindings;
pub mod calibrate;
pub mod evidence;
pub mod metrics;
pub mod options;
pub mod paper;
pub mod precise;
pub mod progress;
pub mod register;
pub mod report;
pub mod scene;
pub mod track;
pub mod views;

pub use sim3align_geometry as geometry;
pub use sim3align_runtime::{counts, error, helpers, number, scheduler};
