//! The results of the entry points, as they reach JavaScript: every field is serialised under its name in camelCase, and the
//! TypeScript declarations are generated from these types. Their documentation is the users'.

mod alignment;
mod diagnostics;
mod pose;
mod preset;
mod warning;

pub use alignment::{Alignment, PaperAlignment, Solution};
pub use diagnostics::{
    ColorReport, ColorVerdict, Counts, Diagnostics, PaperDiagnostics, PreciseDiagnostics, ScoreTerms, SearchCounts,
    is_collapsed,
};
pub use pose::{Alternative, FoundSymmetry, Sim3, Stretch, Uncertainty};
pub use preset::{Effort, Preset};
pub use warning::{Warning, WarningCode};
