//! The poses of all frames of a video, and what a correction of one of them changes.

use super::report::CorrectedFrame;
use crate::precise::drawing::pose::MeshFrame;
use crate::views::world_pose::WorldPose;

/// Maximum number of frames that a correction carries back.
const MOST: usize = 100_000;

/// The poses of all frames, in stretches of frames: a new one begins where the object was found anew.
#[derive(Debug, Clone, Default)]
pub struct History {
    /// The poses, each with the number of its stretch.
    poses: Vec<(WorldPose, usize)>,
    stretch: usize,
    /// Number of frames so far.
    frames: usize,
}

impl History {
    /// Number of frames so far.
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// Number of frames whose poses are known.
    pub fn known(&self) -> usize {
        self.poses.len()
    }

    /// Adds the pose of the next frame. `is_anew`: the object was found without the frame before.
    pub fn add(&mut self, pose: WorldPose, is_anew: bool) {
        self.stretch += usize::from(is_anew);
        self.frames += 1;
        if self.poses.len() < MOST {
            self.poses.push((pose, self.stretch));
        }
    }

    /// The last pose that is known.
    pub fn last(&self) -> Option<WorldPose> {
        self.poses.last().map(|(pose, _)| *pose)
    }

    /// Sets the pose of a frame, and moves all frames of its stretch with it: in the frame of the mesh, so that what was
    /// tracked of its motion stays. Returns the frames that change, and whether the present stretch does; `None` for a
    /// frame that is not known.
    pub fn correct(
        &mut self,
        index: usize,
        fixed: WorldPose,
        frame: &MeshFrame,
    ) -> Option<(Vec<CorrectedFrame>, bool)> {
        let &(wrong, stretch) = self.poses.get(index)?;
        let turn = (wrong.rotation.conjugate() * fixed.rotation).normalize();
        let shift = wrong.rotation.conjugate() * (fixed.center - wrong.center);
        let stretch_ratio = fixed.log_scale - wrong.log_scale;
        let mut changed = Vec::new();
        for (k, (pose, _)) in self.poses.iter_mut().enumerate().filter(|(_, (_, of))| *of == stretch) {
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
