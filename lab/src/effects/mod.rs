//! Errors of measurement and of models in images and meshes: those of sensors, depth models, segmentation, photos and
//! mesh generators.

pub mod depth;
pub mod edges;
pub mod generator;
pub mod mask;
pub mod monocular;
pub mod noise;
pub mod painter;
pub mod photo;
