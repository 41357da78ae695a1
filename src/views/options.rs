//! Options of `alignViews`.

use crate::error::Result;
use crate::options::Options;
use crate::precise::options::{Proportions, search_options};

search_options! {
    /// Options of `alignViews`. All have defaults.
    pub struct ViewsOptions {
        /// Whether to fit the proportions of the mesh to all views together, as in `align`. Only with given camera poses.
        proportions: Proportions = Proportions::Keep, Choice;
        /// Whether to compute the `metrics` of each view. Without them the call takes less time.
        metrics: bool = true, Flag;
        /// Upper bound on the depth readings of each view that are used for metrics.
        max_observed_points: u32 = 20_000, Count(32..=1_000_000);
        /// Number of points sampled on the mesh surface for metrics.
        surface_samples: u32 = 10_000, Count(100..=1_000_000);
    }
    check check_combination;
    fn of_one_view;
}

fn check_combination(options: &ViewsOptions) -> Result<()> {
    options.of_one_view().check_combination()
}
