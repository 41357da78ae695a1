//! Generated cases with a known truth: an object, what a generator makes of it, and what a depth model sees of it.
//!
//! One random stream per part, so that a part that draws more numbers leaves the others as they are.

pub mod benchmark;
pub mod case;
pub mod depth;
pub mod distortion;
pub mod evaluation;
pub mod imported;
pub mod in_order;
pub mod option_text;
pub mod overlay;
pub mod records;
pub mod registration;
pub mod scenes;
pub mod shape;
pub mod table;

use sim3align_geometry::random::Random;

/// Dimensions of the object.
const SHAPE_STREAM: u64 = 0x7368_6170;
/// Where the camera stands.
const VIEW_STREAM: u64 = 0x7669_6577;
/// Faults of the depth map.
const DEPTH_STREAM: u64 = 0x6465_7074;
/// What the generator invents.
const DISTORTION_STREAM: u64 = 0x6469_7374;
/// The frame that the generator delivers in.
const FRAME_STREAM: u64 = 0x6672_616d;

/// A number in [`low`, `high`).
fn between(random: &mut Random, low: f64, high: f64) -> f64 {
    low + (high - low) * random.uniform()
}

/// A seed from several numbers: SplitMix64 over each in turn.
fn mixed<const N: usize>(numbers: [u64; N]) -> u64 {
    numbers.into_iter().fold(0, |state, x| {
        let mut z = (state ^ x).wrapping_add(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    })
}
