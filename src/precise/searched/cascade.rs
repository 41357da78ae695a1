//! A cascade: poses refined on one grid after the other, of which the best distinct ones are kept.

use glam::DQuat;

use super::ascent::Summit;
use super::ranking::{Scored, distinct};

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

/// What a cascade refines: poses of an object, on the evidence of one view or of several.
pub trait Subject {
    /// A pose.
    type Pose: Copy;
    /// Its score.
    type Score: Clone;

    /// The rotation of a pose.
    fn rotation(pose: &Self::Pose) -> DQuat;

    /// The number to maximise.
    fn total(score: &Self::Score) -> f32;

    /// Refines poses on the grid with this index in at most `steps` steps each, or scores them as they are.
    fn refined(&mut self, grid: usize, steps: usize, poses: &[Self::Pose]) -> Vec<Summit<Self::Pose, Self::Score>>;

    /// The poses that the last stage keeps, best first, each with its score on the grid of that stage.
    fn cascade(&mut self, stages: &[Stage], poses: Vec<Self::Pose>) -> Vec<Summit<Self::Pose, Self::Score>> {
        let (mut poses, mut kept) = (poses, Vec::new());
        for stage in stages {
            let refined = self.refined(stage.grid, stage.steps, &poses);
            let places = refined.iter().enumerate().map(|(index, summit)| Place {
                index,
                rotation: Self::rotation(&summit.pose),
                total: Self::total(&summit.score),
            });
            let places = distinct(places.collect(), stage.keep, stage.apart);
            kept = places.into_iter().map(|place| refined[place.index].clone()).collect();
            poses = kept.iter().map(|summit| summit.pose).collect();
        }
        kept
    }
}

/// A refined pose by its index.
#[derive(Clone, Copy)]
struct Place {
    index: usize,
    rotation: DQuat,
    total: f32,
}

impl Scored for Place {
    fn rotation(&self) -> DQuat {
        self.rotation
    }

    fn total(&self) -> f32 {
        self.total
    }
}
