//! The vocabulary of the lab, which nearly every file uses: geometry, observations, what the aligner takes, errors and
//! random draws.

pub use core::f64::consts::{FRAC_PI_2, PI, TAU};
pub use std::path::{Path, PathBuf};

pub use glam::{DAffine3, DMat3, DQuat, DVec2, DVec3, Vec3};
pub use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

pub(crate) use crate::names::named;
pub(crate) use crate::numbers::{between, chance, mixed, normal, sign};
pub use sim3align::evidence::frame::Frame;
pub use sim3align::evidence::observation::Observation;
pub use sim3align::evidence::photo::Photo;
pub use sim3align::metrics::symmetry::{Symmetry, SymmetryAxis};
pub use sim3align::options::scale::ScaleOption;
pub use sim3align::paper::options::PaperOptions;
pub use sim3align::precise::drawing::prepared_mesh::PreparedMesh;
pub use sim3align::precise::options::{AlignOptions, Quality};
pub use sim3align::progress::Silent;
pub use sim3align_geometry::cloud::{Bounds, Cloud};
pub use sim3align_geometry::image::{DepthMap, Image, Mask};
pub use sim3align_geometry::kd_tree::KdTree;
pub use sim3align_geometry::mesh::Mesh;
pub use sim3align_geometry::pinhole::Pinhole;
pub use sim3align_geometry::random::Random;
pub use sim3align_geometry::rasteriser::{NO_TRIANGLE, Rasteriser};
pub use sim3align_geometry::similarity::{Similarity, vec3, vector3};
pub use sim3align_geometry::surface_colors::SurfaceColors;
pub use sim3align_runtime::error::{Error, ErrorCode};

/// A result, by default with the error of the package.
pub type Result<T, E = Error> = core::result::Result<T, E>;
