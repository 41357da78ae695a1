//! The vocabulary of the tests.

pub use glam::{DMat3, DQuat, DVec2, DVec3, Vec3};
pub use nalgebra::{Rotation3, Vector3};
pub use sim3align::error::ErrorCode;
pub use sim3align::evidence::observation::Observation;
pub use sim3align::geometry::cloud::{Bounds, Cloud};
pub use sim3align::geometry::image::{DepthMap, Image, Mask};
pub use sim3align::geometry::mesh::Mesh;
pub use sim3align::geometry::pinhole::Pinhole;
pub use sim3align::geometry::random::Random;
pub use sim3align::geometry::rasteriser::Rasteriser;
pub use sim3align::geometry::rotations::exp;
pub use sim3align::geometry::similarity::{Similarity, vec3, vector3};
pub use sim3align::geometry::surface::sample_surface;
pub use sim3align::metrics::symmetry::{Symmetry, SymmetryAxis};
pub use sim3align::options::scale::ScaleOption;
pub use sim3align::precise::drawing::pose::{CropPose, MeshFrame, Step};
pub use sim3align::precise::drawing::prepared_mesh::PreparedMesh;
pub use sim3align::precise::drawing::render::{Canvas, Model};
pub use sim3align::precise::observation::grid::CropGrid;
pub use sim3align::precise::options::{AlignOptions, Quality, SearchScope};
pub use sim3align::precise::scoring::score::{Score, Scoring, Weights};
pub use sim3align::progress::Silent;
pub use sim3align::report::{Alignment, WarningCode};
pub use wasm_bindgen_test::wasm_bindgen_test;

pub use crate::shapes::{cuboid, ellipsoid, joined, mapped, sphere};
pub use crate::support::*;
