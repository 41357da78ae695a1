//! A cascade: poses refined on one grid after the other, of which the best distinct ones are kept.

use super::ranking::{Candidate, Posed, Total, distinct};

/// A stage of a cascade.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stage {
    /// Index of the grid.
    pub grid: usize,
    /// Maximum number of steps of a refinement; without steps, poses are scored as they are.
    pub steps: usize,
    /// Number of poses kept for the next stage.
    pub keep: usize,
    /// Of poses whose rotations are closer than this, in radians, only the best is kept.
    pub apart: f64,
}

impl Stage {
    /// The stage that keeps the best pose.
    pub const fn of_one(grid: usize, steps: usize) -> Self {
        Self { grid, steps, keep: 1, apart: 0.0 }
    }
}

/// The subject of a cascade: poses of an object, on the evidence of one view or of several.
pub trait Cascade {
    /// A pose.
    type Pose: Posed;
    /// Its score.
    type Score: Total;

    /// Refines poses on the grid with this index in at most `steps` steps each, or scores them as they are.
    fn refined(&mut self, grid: usize, steps: usize, poses: &[Self::Pose]) -> Vec<Candidate<Self::Pose, Self::Score>>;

    /// The poses that the last stage keeps, best first, each with its score on the grid of that stage.
    fn cascade(&mut self, stages: &[Stage], poses: Vec<Self::Pose>) -> Vec<Candidate<Self::Pose, Self::Score>> {
        let (mut poses, mut kept) = (poses, Vec::new());
        for stage in stages {
            kept = distinct(self.refined(stage.grid, stage.steps, &poses), stage.keep, stage.apart);
            poses = kept.iter().map(|summit| summit.pose).collect();
        }
        kept
    }
}
