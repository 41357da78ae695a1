//! The poses of the newest frames of a video, and the changes by a correction of one of them.

use std::collections::VecDeque;

use super::report::CorrectedFrame;
use crate::precise::drawing::pose::MeshFrame;
use crate::views::world_pose::WorldPose;

/// Number of frames that can be corrected, the newest ones: almost an hour at 30 frames per second.
pub const MAX_FRAMES: usize = 100_000;

/// The poses of the newest frames, in stretches of frames: a new one begins where the object was found anew.
#[derive(Debug, Clone, Default)]
pub struct History {
    /// The poses, each with the number of its stretch.
    poses: VecDeque<(WorldPose, usize)>,
    stretch: usize,
    /// Number of frames so far.
    frames: usize,
}

impl History {
    /// Number of frames so far.
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// Adds the pose of the next frame. `is_anew`: the object was found without the frame before.
    pub fn add(&mut self, pose: WorldPose, is_anew: bool) {
        self.stretch += usize::from(is_anew);
        self.frames += 1;
        if self.poses.len() == MAX_FRAMES {
            self.poses.pop_front();
        }
        self.poses.push_back((pose, self.stretch));
    }

    /// The pose of the last frame.
    pub fn last(&self) -> Option<WorldPose> {
        self.poses.back().map(|(pose, _)| *pose)
    }

    /// Sets the pose of a frame, and moves all frames of its stretch with it: in the frame of the mesh, so that the tracked
    /// motion stays. Returns the frames that change, and whether the present stretch does; `None` for a frame that has not
    /// been added, or that is not among the newest.
    pub fn correct(
        &mut self,
        index: usize,
        fixed: WorldPose,
        frame: &MeshFrame,
    ) -> Option<(Vec<CorrectedFrame>, bool)> {
        let oldest = self.frames - self.poses.len();
        let &(wrong, stretch) = self.poses.get(index.checked_sub(oldest)?)?;
        let turn = (wrong.rotation.conjugate() * fixed.rotation).normalize();
        let shift = wrong.rotation.conjugate() * (fixed.center - wrong.center);
        let stretch_ratio = fixed.log_scale - wrong.log_scale;
        let mut changed = Vec::new();
        for (k, (pose, _)) in (oldest..).zip(&mut self.poses).filter(|(_, (_, of))| *of == stretch) {
            *pose = if k == index {
                fixed
            } else {
                WorldPose {
                    rotation: (pose.rotation * turn).normalize(),
                    log_scale: pose.log_scale + stretch_ratio,
                    center: pose.center + pose.rotation * shift,
                }
            };
            changed.push(CorrectedFrame { camera_from_mesh: (&pose.similarity(frame)).into(), frame: k });
        }
        Some((changed, stretch == self.stretch))
    }
}
