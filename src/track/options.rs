//! Options of `track`.

use crate::error::Result;
use crate::geometry::similarity::Similarity;
use crate::metrics::symmetry::Symmetry;
use crate::options::scale::ScaleOption;
use crate::options::{Options, options};
use crate::precise::options::{AlignOptions, ExtentAxis, Quality};

options! {
    /// Options of `track`. All have defaults.
    pub struct TrackOptions {
        /// How much work the search in the first frame does, and the one that finds a lost object again.
        quality: Quality = Quality::Auto, Choice;
        /// The scale in metres per mesh unit: `"free"`, a known number (1 for a mesh in metres), or bounds `[min, max]`.
        /// Not together with `knownExtentM`.
        scale: ScaleOption = ScaleOption::Free, Scale;
        /// The object's known length along `knownExtentAxis`, in metres. It fixes the scale.
        known_extent_m: Option<f64> = None, Positive;
        /// The side of the mesh's bounding box that `knownExtentM` measures.
        known_extent_axis: ExtentAxis = ExtentAxis::Longest, Choice;
        /// The pose in the first frame, camera from mesh, in metres, if it is known. That frame then needs no mask.
        initial: Option<Similarity> = None, Transform;
        /// Whether to compute `metrics` of each frame that has a mask, which takes several times as long as tracking.
        metrics: bool = false, Flag;
        /// Seed of all random draws. The same frames and seed give the same bits.
        seed: u32 = 0, Count(0..=u32::MAX);
    }
    check check_combination;
}

fn check_combination(options: &TrackOptions) -> Result<()> {
    options.of_detection().check_combination()
}

impl TrackOptions {
    /// The options of the search in one frame.
    pub fn of_detection(&self) -> AlignOptions {
        let Self { quality, scale, known_extent_m, known_extent_axis, initial, seed, .. } = *self;
        AlignOptions {
            quality,
            scale,
            known_extent_m,
            known_extent_axis,
            initial,
            symmetry: Symmetry::Auto,
            metrics: false,
            seed,
            ..AlignOptions::default()
        }
    }
}
