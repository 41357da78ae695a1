//! Several frames of one object: generated rigs of cameras, generated videos, and case folders with frames.

pub mod faulty_mask;
pub mod folder;
pub mod rig;
mod stage;
pub mod video;

use crate::prelude::*;
use sim3align::views::View;

/// Frames of one object with the true poses.
#[derive(Debug, Clone)]
pub struct Sequence {
    /// Name of the case.
    pub name: String,
    /// Kind of case, the row group in tables.
    pub kind: String,
    /// The mesh.
    pub mesh: Mesh,
    /// Its colours, if it has some.
    pub colors: Option<SurfaceColors>,
    /// Its symmetry.
    pub symmetry: Symmetry,
    /// The frames.
    pub frames: Vec<SequenceFrame>,
}

/// A frame of a sequence.
#[derive(Debug, Clone)]
pub struct SequenceFrame {
    /// Name of the frame.
    pub name: String,
    /// Depth, mask, camera and the camera's pose.
    pub view: View,
    /// The true pose; `None` if it is unknown.
    pub camera_from_mesh: Option<Similarity>,
    /// Fraction of the object that the frame shows, 0 to 1.
    pub visible: f64,
    /// Whether the view is wrong on purpose.
    pub is_wrong: bool,
}

impl Sequence {
    /// The mesh with its colours.
    pub fn prepared(&self) -> PreparedMesh<'_> {
        PreparedMesh::borrowed(&self.mesh).with_colors(self.colors.clone())
    }
}

/// A rigid transform with normally distributed errors: degrees and metres.
fn jittered(pose: &Similarity, [degrees, metres]: [f64; 2], random: &mut Random) -> Similarity {
    let mut vector = || Vector3::new(normal(random), normal(random), normal(random));
    let turn = UnitQuaternion::from_scaled_axis(vector() * (degrees.to_radians() / 3f64.sqrt()));
    let shift = vector() * (metres / 3f64.sqrt());
    Similarity { rotation: turn.to_rotation_matrix() * pose.rotation, translation: pose.translation + shift, ..*pose }
}
