//! Options of `alignViews`.

use crate::error::Result;
use crate::metrics::symmetry::Symmetry;
use crate::options::scale::ScaleOption;
use crate::options::{Options, options};
use crate::precise::options::{AlignOptions, ExtentAxis, Proportions, Quality};

options! {
    /// Options of `alignViews`. All have defaults.
    pub struct ViewsOptions {
        /// How much work the searches do.
        quality: Quality = Quality::Auto, Choice;
        /// The scale in metres per mesh unit: `"free"`, a known number (1 for a mesh in metres), or bounds `[min, max]`.
        /// Not together with `knownExtentM`.
        scale: ScaleOption = ScaleOption::Free, Scale;
        /// The object's known length along `knownExtentAxis`, in metres. It fixes the scale.
        known_extent_m: Option<f64> = None, Positive;
        /// The side of the mesh's bounding box that `knownExtentM` measures.
        known_extent_axis: ExtentAxis = ExtentAxis::Longest, Choice;
        /// The object's symmetry, so that `alternatives` does not list equivalent poses; as in `align`.
        symmetry: Symmetry = Symmetry::Auto, Symmetry;
        /// Whether to fit the proportions of the mesh to all views together, as in `align`. Only with given camera poses.
        proportions: Proportions = Proportions::Keep, Choice;
        /// Whether to compute the `metrics` of each view. Without them the call takes less time.
        metrics: bool = true, Flag;
        /// Seed of all random draws. The same input and seed give the same bits.
        seed: u32 = 0, Count(0..=u32::MAX);
        /// Upper bound on the depth readings of each view that are used for metrics.
        max_observed_points: u32 = 20_000, Count(32..=1_000_000);
        /// Number of points sampled on the mesh surface for metrics.
        surface_samples: u32 = 10_000, Count(100..=1_000_000);
    }
    check check_combination;
}

fn check_combination(options: &ViewsOptions) -> Result<()> {
    options.of_one_view().check_combination()
}

impl ViewsOptions {
    /// The options of the search in one view.
    pub fn of_one_view(&self) -> AlignOptions {
        let Self {
            quality, scale, known_extent_m, known_extent_axis, seed, max_observed_points, surface_samples, ..
        } = *self;
        AlignOptions {
            quality,
            scale,
            known_extent_m,
            known_extent_axis,
            symmetry: self.symmetry.clone(),
            metrics: self.metrics,
            seed,
            max_observed_points,
            surface_samples,
            ..AlignOptions::default()
        }
    }
}
