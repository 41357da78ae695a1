//! The normalised frames in which two clouds are compared: centred, and of about the same size.

use super::report::{Registration, RegistrationDiagnostics};
use crate::error::Result;
use crate::evidence::extents::{Extents, initial_scale, target_from_source};
use crate::geometry::similarity::Similarity;
use crate::options::scale::ScaleOption;
use crate::progress::Stopwatch;
use crate::register::umeyama::ScaleMode;
use crate::report::Counts;

/// Bounds of a free scale relative to the ratio of the bounding boxes. Wide, because clutter can enlarge a box
/// arbitrarily.
const FREE_GUARD: [f64; 2] = [0.2, 5.0];

/// The normalised frames of both clouds, and the constraint on the scale between them.
pub(crate) struct NormalizedPair {
    pub(crate) source: Extents,
    pub(crate) target: Extents,
    pub(crate) scale_mode: ScaleMode,
    pub(crate) guard: Option<[f64; 2]>,
}

impl NormalizedPair {
    /// The frames in which the initial scale is 1; it is the ratio of the boxes, within the bounds of `scale`.
    pub(crate) fn of(source_xyz: &[f64], target_xyz: &[f64], scale: ScaleOption) -> Result<Self> {
        let (source, target) = (Extents::of_flat("source", source_xyz)?, Extents::of_flat("target", target_xyz)?);
        let ratio = initial_scale(&target, &source);
        Ok(match scale {
            ScaleOption::Free => Self { source, target, scale_mode: ScaleMode::Free, guard: Some(FREE_GUARD) },
            ScaleOption::Fixed(fixed) => Self {
                source: source.with_diagonal(target.diagonal() / fixed),
                target,
                scale_mode: ScaleMode::Fixed(1.0),
                guard: None,
            },
            ScaleOption::Between([min, max]) => {
                let initial = ratio.max(min).min(max);
                Self {
                    source: source.with_diagonal(target.diagonal() / initial),
                    target,
                    scale_mode: ScaleMode::Free,
                    guard: Some([min / initial, max / initial]),
                }
            }
        })
    }

    /// Converts a transform between normalised frames to the frames of the clouds.
    pub(crate) fn denormalized(&self, unit: &Similarity) -> Similarity {
        target_from_source(&self.target, unit, &self.source)
    }

    /// Converts a transform between the frames of the clouds to the normalised ones.
    pub(crate) fn normalized(&self, target_from_source: &Similarity) -> Similarity {
        let own_from_unit = self.source.unit_from_own().inverse();
        self.target.unit_from_own().compose(target_from_source).compose(&own_from_unit)
    }

    /// The result for a transform between the frames of the clouds.
    pub(crate) fn registration(
        &self,
        transform: &Similarity,
        fit: Fit,
        seed: u32,
        stages: Stopwatch<'_>,
    ) -> Registration {
        let Fit { fitness, residual, converged, counts } = fit;
        let initial_scale = initial_scale(&self.target, &self.source);
        Registration {
            target_from_source: transform.into(),
            fitness,
            residual,
            diagnostics: RegistrationDiagnostics {
                seed,
                initial_scale,
                scale_ratio: transform.scale / initial_scale,
                converged,
                skipped_source_points: 0,
                skipped_target_points: 0,
                counts,
                timings_ms: stages.finish(),
            },
        }
    }
}

/// The quality of a transform, as reported in a [`Registration`].
pub(super) struct Fit {
    pub(super) fitness: f64,
    pub(super) residual: f64,
    pub(super) converged: bool,
    pub(super) counts: Counts,
}
