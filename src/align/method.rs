//! The method of an alignment and its options.

use crate::paper::options::PaperOptions;
use crate::precise::options::AlignOptions;
use crate::report::Preset;

/// A preset and its options.
#[derive(Debug, Clone, PartialEq)]
pub enum Method {
    /// Search by rendering.
    Precise(AlignOptions),
    /// The method of the paper.
    Paper(PaperOptions),
}

impl Method {
    /// The preset.
    pub fn preset(&self) -> Preset {
        match self {
            Self::Precise(_) => Preset::Precise,
            Self::Paper(_) => Preset::Paper,
        }
    }
}

impl Default for Method {
    fn default() -> Self {
        Self::Precise(AlignOptions::default())
    }
}

impl From<AlignOptions> for Method {
    fn from(options: AlignOptions) -> Self {
        Self::Precise(options)
    }
}

impl From<PaperOptions> for Method {
    fn from(options: PaperOptions) -> Self {
        Self::Paper(options)
    }
}
