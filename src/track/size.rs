//! The size of a tracked object: evidence of frames from different sides, weighted by its certainty, until it settles.

use glam::DQuat;

use crate::geometry::rotations::angle_between;
use crate::views::common_size::{DEPTH_ERROR, SizeEvidence, pooled, shape_error};

/// Angle between the directions from which frames count as different evidence, radians.
const MIN_VIEW_ANGLE_RAD: f64 = 0.12;
/// Number of frames, and standard deviation, relative, at which the size settles.
const SETTLED_FRAMES: usize = 16;
const SETTLED_SD: f64 = 0.0028;
/// Largest change of the size from frame to frame, relative.
const MAX_STEP: f64 = 0.008;

/// The size so far.
#[derive(Debug, Clone)]
pub struct Size {
    frames: Vec<(DQuat, SizeEvidence)>,
    known: Option<f64>,
    settled: Option<(f64, f64)>,
    /// The logarithm of the scale of the last frame, which follows the evidence in small steps.
    reached: Option<f64>,
}

impl Size {
    /// An unknown size, or a fixed one, as the logarithm of the scale.
    pub fn new(known: Option<f64>) -> Self {
        Self { frames: Vec::new(), known, settled: None, reached: None }
    }

    /// The logarithm of the scale and its standard deviation; `None` before the first evidence.
    pub fn value(&self) -> Option<(f64, f64)> {
        if let Some(known) = self.known {
            return Some((known, 0.0));
        }
        let (log_scale, sd) = self.evidence()?;
        let reached = self.reached.unwrap_or(log_scale);
        Some((reached, together(sd, log_scale - reached)))
    }

    /// The standard deviation with the errors that all frames share: those of the mesh and of the sensor; 0 before the first
    /// evidence, or of a fixed size.
    pub fn deviation(&self) -> f64 {
        let shared =
            together(DEPTH_ERROR, shape_error(self.frames.iter().map(|(_, evidence)| evidence.depth_agreement)));
        self.value().map_or(0.0, |(_, sd)| if self.known.is_some() { sd } else { together(sd, shared) })
    }

    fn evidence(&self) -> Option<(f64, f64)> {
        self.settled.or_else(|| pooled(self.frames.iter().map(|(_, evidence)| *evidence)))
    }

    /// Whether later frames keep the size.
    pub fn is_settled(&self) -> bool {
        self.known.is_some() || self.settled.is_some()
    }

    /// Whether a frame with this rotation would add evidence: frames from the same side share their errors.
    pub fn wants(&self, rotation: DQuat) -> bool {
        !self.is_settled() && self.frames.iter().all(|(known, _)| angle_between(*known, rotation) > MIN_VIEW_ANGLE_RAD)
    }

    /// Follows the evidence in the next frame.
    pub fn advance(&mut self) {
        if let Some((log_scale, _)) = self.evidence() {
            let reached = self.reached.unwrap_or(log_scale);
            self.reached = Some(reached + (log_scale - reached).clamp(-MAX_STEP, MAX_STEP));
        }
    }

    /// Adds the evidence of a frame.
    pub fn add(&mut self, rotation: DQuat, evidence: SizeEvidence) {
        self.frames.push((rotation, evidence));
        let all = self.evidence();
        if self.frames.len() >= SETTLED_FRAMES || all.is_some_and(|(_, sd)| sd < SETTLED_SD) {
            self.settled = all;
        }
    }

    /// Begins again with the size of a correction.
    pub fn correct(&mut self, rotation: DQuat, evidence: SizeEvidence) {
        if self.known.is_none() {
            (self.frames, self.settled, self.reached) = (vec![(rotation, evidence)], None, None);
        }
    }
}

/// The standard deviation of two independent errors together.
fn together(a: f64, b: f64) -> f64 {
    (a * a + b * b).sqrt()
}
