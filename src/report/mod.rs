//! The results of the entry points.

mod alignment;
mod diagnostics;
mod pose;
mod preset;
mod warning;

pub use alignment::{Alignment, AnyAlignment, PaperAlignment, Solution};
pub use diagnostics::{
    ColorReport, ColorVerdict, Counts, Diagnostics, PaperDiagnostics, PreciseDiagnostics, ScoreTerms, SearchCounts,
    is_collapsed,
};
pub use pose::{Alternative, Sim3, Uncertainty};
pub use preset::{Effort, Preset};
pub use warning::{Warning, WarningCode};
