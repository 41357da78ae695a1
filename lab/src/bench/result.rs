//! One benchmark result row: a pose of one object, and how right it is.

use std::collections::BTreeMap;

use cpu_time::ThreadTime;
use serde::{Deserialize, Serialize};

use crate::prelude::*;
use sim3align::counts::{self, Counts};
use sim3align::metrics::Metrics;
use sim3align::metrics::pose_error::PoseErrors;
use sim3align::report::{Alignment, Diagnostics, PaperAlignment, Warning};

/// Maximum errors of a right pose: scale within 5 %, rotation within 10°, place within 5 % of the diameter.
const STRICT: Errors = [0.05, 10.0, 0.05];
/// Twice the errors of [`STRICT`].
const LOOSE: Errors = [0.1, 20.0, 0.1];

/// Errors of scale (a share), rotation (degrees, up to symmetry) and place (of the diameter). With depth of a depth model,
/// those of the apparent size, and of the place in the image relative to the apparent diameter. Of clouds, the last one is the
/// root mean squared distance of the common surface, relative to the diagonal.
pub type Errors = [f64; 3];

/// Metrics by their names in the package.
pub type MetricsByName = BTreeMap<String, Option<f64>>;

/// The result of a row of the benchmark for one object in one image.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub struct ResultRow {
    /// The set, or `given` for folders.
    pub set: String,
    /// The object in its image: unique in its row.
    pub name: String,
    /// Difficulty.
    pub tier: String,
    /// The group of the object.
    pub class: String,
    /// Whether the errors are within 5 %, 10° and 5 % of the diameter; `None` if the true pose is unknown, `false` without
    /// a pose.
    pub strict: Option<bool>,
    /// Whether the errors are within 10 %, 20° and 10 % of the diameter; `None` as for `strict`.
    pub loose: Option<bool>,
    /// See [`Errors`].
    pub errors: Option<Errors>,
    /// Probability that the pose is right, as the call reports it.
    pub confidence: Option<f64>,
    /// Probability that the turn of a symmetric shape is right.
    pub turn_confidence: Option<f64>,
    /// Standard deviation of the scale, relative, as the call reports it.
    pub scale_sd: Option<f64>,
    /// CPU time of the call, which a busy machine changes little, milliseconds.
    pub ms: Option<f64>,
    /// Counts of the work of the call.
    pub work: Option<Counts>,
    /// Agreement of the pose with the image.
    pub metrics: Option<MetricsByName>,
    /// Agreement of the true pose with the image.
    pub truth_metrics: Option<MetricsByName>,
    /// Codes of the warnings.
    pub warnings: Vec<String>,
    /// Whether the scale collapsed.
    pub collapsed: bool,
    /// Whether the scale stands at a bound.
    pub clamped: bool,
    /// The evidence from which the confidence follows.
    pub features: Option<Features>,
    /// Why there is no pose.
    pub error: Option<String>,
    /// Names of the simulated errors.
    pub tags: Vec<String>,
}

/// The evidence from which the confidence follows.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Features {
    /// The score of the pose.
    pub score: f64,
    /// Its terms: overlap, depth, outline.
    pub terms: [f64; 3],
    /// The scores of the alternatives.
    pub alternatives: Vec<f64>,
    /// Standard deviations of scale and rotation (degrees), if they are known.
    pub uncertainty: Option<[f64; 2]>,
}

impl ResultRow {
    /// The row with the errors of its pose.
    pub fn with_errors(mut self, errors: Option<Errors>) -> Self {
        let holds = |limits: Errors| errors.is_some_and(|found| found.iter().zip(limits).all(|(e, most)| *e <= most));
        (self.strict, self.loose, self.errors) = (Some(holds(STRICT)), Some(holds(LOOSE)), errors);
        self
    }

    fn with_report(self, metrics: Option<&Metrics>, warnings: &[Warning], common: &Diagnostics) -> Self {
        let Diagnostics { collapsed, clamped, .. } = *common;
        Self { metrics: metrics.map(by_name), warnings: codes(warnings), collapsed, clamped, ..self }
    }

    /// The row with the report of `align` with the preset of the paper.
    pub fn with_paper_alignment(self, found: &PaperAlignment) -> Self {
        self.with_report(found.metrics.as_ref(), &found.warnings, &found.diagnostics.common)
    }

    /// The row with the report of `align`.
    pub fn with_alignment(self, found: &Alignment) -> Self {
        let Alignment { confidence, turn_confidence, alternatives, uncertainty, diagnostics, .. } = found;
        let terms = &diagnostics.terms;
        Self {
            confidence: Some(*confidence),
            turn_confidence: *turn_confidence,
            scale_sd: uncertainty.as_ref().map(|found| found.scale),
            features: Some(Features {
                score: diagnostics.score,
                terms: [terms.overlap, terms.depth, terms.outline],
                alternatives: alternatives.iter().map(|other| other.score).collect(),
                uncertainty: uncertainty.as_ref().map(|found| [found.scale, found.rotation_deg]),
            }),
            ..self.with_report(found.metrics.as_ref(), &found.warnings, &diagnostics.common)
        }
    }

    /// The row of a failure.
    pub fn with_error(self, error: &Error) -> Self {
        Self { error: Some(described(error)), ..self }
    }
}

/// An error in words, after its code.
pub fn described(error: &Error) -> String {
    format!("{}: {error}", error.code.as_str())
}

/// The three errors of a pose.
pub fn three(errors: &PoseErrors) -> Errors {
    [errors.scale_error, errors.rotation_error_deg, errors.translation_error_relative]
}

/// Metrics by name.
pub fn by_name(metrics: &Metrics) -> MetricsByName {
    let value = serde_json::to_value(metrics).ok();
    value.and_then(|value| serde_json::from_value(value).ok()).unwrap_or_default()
}

/// The codes of warnings.
pub fn codes(warnings: &[Warning]) -> Vec<String> {
    let code = |warning: &Warning| serde_json::to_value(warning.code).ok()?.as_str().map(str::to_owned);
    warnings.iter().filter_map(code).collect()
}

/// Measures the cost of a call: the CPU time of its thread, which on a busy machine is much less than the elapsed time, and
/// counts of its work, which are the same on every machine.
pub struct Meter(ThreadTime, Counts);

impl Meter {
    /// A meter at zero.
    pub fn start() -> Self {
        Self(ThreadTime::now(), counts::so_far())
    }

    /// CPU time since the start, milliseconds, and the counts of the work.
    pub fn cost(&self) -> (Option<f64>, Option<Counts>) {
        (Some(1000.0 * self.0.elapsed().as_secs_f64()), Some(counts::so_far().since(&self.1)))
    }
}
