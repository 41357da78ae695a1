//! The method and the effort of an alignment.

use crate::options::{Choice, choices};

choices! {
    /// The method of an alignment.
    pub enum Preset {
        /// Search by rendering: finds the pose whose rendering best explains mask, free space and depth.
        #[default]
        Precise = "precise",
        /// The paper's method: FPFH, guarded Sim(3) RANSAC, hallucination filtering, scale-locked ICP.
        Paper = "paper",
    }
}

choices! {
    /// The work of one search.
    pub enum Effort {
        /// Few rotations and candidates.
        Fast = "fast",
        /// Between the others.
        #[default]
        Balanced = "balanced",
        /// Many rotations and candidates.
        Best = "best",
    }
}

impl Preset {
    /// The name in JavaScript.
    pub fn as_str(self) -> &'static str {
        self.name()
    }
}
