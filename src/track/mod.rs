//! Tracking of one object through a video: each pose starts at the one before, and the size sharpens over the frames.
//!
//! In: a mesh, and a [`Frame`](crate::evidence::frame::Frame) after the other, with or without a mask. Out: a
//! [`TrackedFrame`](report::TrackedFrame) each. A tracker keeps poses, size and motion, never images: its evidence of a frame,
//! it takes at once. A frame that fails must leave it usable.

pub mod detection;
pub mod evidence;
pub mod history;
pub mod local_search;
pub mod motion;
pub mod report;
pub mod size;
pub mod tracker;

use crate::error::Result;
use crate::geometry::similarity::Similarity;
use crate::options::Options;
use crate::precise::options::{AlignOptions, search_options};

search_options! {
    /// Options of `track`. All have defaults.
    pub struct TrackOptions {
        /// The pose in the first frame, camera from mesh, in metres, if it is known. That frame then needs no mask.
        initial: Option<Similarity> = None, Transform;
        /// Whether to compute `metrics` of each frame that has a mask, which takes several times as long as tracking.
        metrics: bool = false, Flag;
    }
    check check_combination;
    fn of_detection;
}

fn check_combination(options: &TrackOptions) -> Result<()> {
    options.of_first_frame().check_combination()
}

impl TrackOptions {
    /// The options of the search in the first frame.
    pub fn of_first_frame(&self) -> AlignOptions {
        AlignOptions { initial: self.initial, ..self.of_detection() }
    }
}
