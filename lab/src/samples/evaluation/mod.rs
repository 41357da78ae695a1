//! An evaluation set: cases of many objects, as hard as SAM's masks, depth models and generated meshes make them.
//!
//! Case i follows from the set's seed and i alone. i % 3 is its tier, and (i / 3) runs through the tier's classes, so
//! that any run of cases holds all of them evenly. A draw that shows too little is drawn again, from numbers of its own.

pub mod case;
mod cluster;
pub(in crate::samples) mod draft;
mod figures;
pub(in crate::samples) mod generator;
mod kitchen;
pub(in crate::samples) mod mask;
pub(in crate::samples) mod readings;
mod scans;
pub(in crate::samples) mod scene;
pub(in crate::samples) mod solid;
pub mod tier;
mod tools;

use sim3align_geometry::random::Random;

/// Which object, and its dimensions.
pub(in crate::samples) const OBJECT_STREAM: u64 = 1;
/// Camera and scene.
pub(in crate::samples) const SCENE_STREAM: u64 = 2;
/// Faults of the generated mesh.
pub(in crate::samples) const GENERATOR_STREAM: u64 = 3;
/// Faults of the depth map.
pub(in crate::samples) const READINGS_STREAM: u64 = 4;
/// Faults of the mask.
pub(in crate::samples) const MASK_STREAM: u64 = 5;

/// Standard normal (Box and Muller).
pub(super) fn normal(random: &mut Random) -> f64 {
    let (u, v) = (1.0 - random.uniform(), random.uniform());
    (-2.0 * libm::log(u)).sqrt() * libm::cos(core::f64::consts::TAU * v)
}

/// `true` with this probability.
pub(in crate::samples) fn chance(random: &mut Random, probability: f64) -> bool {
    random.uniform() < probability
}

/// −1 or 1.
pub(in crate::samples) fn sign(random: &mut Random) -> f64 {
    if chance(random, 0.5) { -1.0 } else { 1.0 }
}
