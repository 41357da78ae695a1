//! What came of one case, in the form that every command can write: `npm run record` keeps it.

use serde::Serialize;

use super::benchmark::{LOOSE, STRICT};
use sim3align::metrics::pose_error::PoseErrors;

/// A pose and how right it is.
#[derive(Debug, Clone, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct CaseLine {
    /// The row of the table.
    pub row: String,
    /// The case, unique in its row.
    pub case: String,
    /// Whether the errors are within [`STRICT`].
    pub strict: bool,
    /// Whether the errors are within [`LOOSE`].
    pub loose: bool,
    /// Errors of scale (a share), rotation (degrees) and place (of the diameter); `None` where there is no pose.
    pub errors: Option<[f64; 3]>,
    /// The confidence, where the row has one.
    pub confidence: Option<f64>,
    /// What it took, milliseconds; `None` where it was not measured.
    pub ms: Option<f64>,
}

impl CaseLine {
    /// The line of a pose with these errors; without, of a failure.
    pub fn new(row: &str, case: String, errors: Option<&PoseErrors>, confidence: Option<f64>, ms: Option<f64>) -> Self {
        let three = |e: &PoseErrors| [e.scale_error, e.rotation_error_deg, e.translation_error_relative];
        Self {
            row: row.to_owned(),
            case,
            strict: errors.is_some_and(|errors| STRICT.holds(errors)),
            loose: errors.is_some_and(|errors| LOOSE.holds(errors)),
            errors: errors.map(three),
            confidence,
            ms,
        }
    }
}
