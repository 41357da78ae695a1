//! The evaluation set: cases of many objects, with the errors of segmentation models, depth models and generated
//! meshes.
//!
//! Case i depends on the seed of the set and i alone. i % 3 is its tier, and i / 3 cycles through the classes of the
//! tier, so that any range of cases contains all of them evenly. The sets of a seed ([`tier::CaseSet`]) have no case in
//! common. A draw that shows too little of the object is repeated
//! with other random numbers.

mod annotated_mask;
mod atlas;
pub mod case;
mod cluster;
pub(crate) mod distortion;
pub(crate) mod draft;
mod edges;
pub(crate) mod families;
mod figures;
pub(crate) mod generator;
mod holes;
mod kitchen;
pub(crate) mod mask;
mod network_mask;
pub(crate) mod photo;
mod predicted_mask;
pub(crate) mod print;
pub(crate) mod readings;
mod scans;
pub(crate) mod scene;
mod sensor;
mod shadow;
pub(crate) mod solid;
mod split;
pub(crate) mod streams;
pub mod surplus;
pub(crate) mod texture;
pub mod tier;
mod tools;
