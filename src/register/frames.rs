//! The frames in which two clouds are compared: centred, and of one size as far as that is known beforehand.

use crate::error::Result;
use crate::evidence::extents::{Extents, initial_scale};
use crate::geometry::similarity::Similarity;
use crate::options::scale::ScaleOption;
use crate::progress::Stopwatch;
use crate::register::umeyama::ScaleMode;
use crate::report::{Counts, Registration, RegistrationDiagnostics};

/// How far a free scale may be from the ratio of the boxes. Wide: clutter widens a box at will.
const FREE_GUARD: [f64; 2] = [0.2, 5.0];

/// The normalised frames of both clouds, and what is known of the scale between them.
pub(crate) struct Frames {
    pub(crate) source: Extents,
    pub(crate) target: Extents,
    pub(crate) scale_mode: ScaleMode,
    pub(crate) guard: Option<[f64; 2]>,
}

impl Frames {
    /// The frames in which the initial scale is 1: the ratio of the boxes, or what the caller knows.
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

    /// A transform between the clouds' own frames, taken to the normalised ones.
    pub(crate) fn unit(&self, target_from_source: &Similarity) -> Similarity {
        let own_from_unit = self.source.unit_from_own().inverse();
        self.target.unit_from_own().compose(target_from_source).compose(&own_from_unit)
    }

    /// The report of a transform between the clouds' own frames.
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
                counts,
                timings_ms: stages.finish(),
            },
        }
    }
}

/// How well a transform fits the clouds, as a [`Registration`] reports it.
pub(super) struct Fit {
    pub(super) fitness: f64,
    pub(super) residual: f64,
    pub(super) converged: bool,
    pub(super) counts: Counts,
}
