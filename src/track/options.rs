//! Options of `track`.

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
