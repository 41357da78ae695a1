//! Objects in views, with the true pose.

use crate::bench::scene_bench::{BenchObject, BenchScene};
use crate::case_folder::case::{last_name, photo_of, read_case};
use crate::cases::case::EvaluationCase;
use crate::files::listed;
use crate::prelude::*;
use crate::sequences::folder::read_sequence;
use crate::sequences::{Sequence, SequenceFrame};

/// An object in a view, with the true pose.
pub struct OutlineView {
    /// Name of the case or of the scene, and of the object or of the frame.
    pub name: String,
    /// The part of the name before the first dash, or a property of a generated case.
    pub group: String,
    /// Depth.
    pub depth: DepthMap,
    /// Mask.
    pub mask: Mask,
    /// The photo, if there is one.
    pub photo: Option<Photo>,
    /// Intrinsics.
    pub camera: Pinhole,
    /// The object.
    pub mesh: Mesh,
    /// Its true pose.
    pub camera_from_mesh: Similarity,
}

named! {
    /// The property of generated cases by which they are grouped.
    pub enum GroupBy: "--by" {
        /// The class.
        Class = "class",
        /// The tier.
        Tier = "tier",
        /// What made the depth.
        Depth = "depth",
        /// What made the mask.
        Mask = "mask",
    }
}

impl GroupBy {
    fn of(self, case: &EvaluationCase) -> String {
        match self {
            Self::Class => case.class.as_str().to_owned(),
            Self::Tier => case.tier.as_str().to_owned(),
            Self::Depth => case.depth.to_owned(),
            Self::Mask => case.mask.to_owned(),
        }
    }
}

impl OutlineView {
    /// A generated case. The true outline is that of the object, not of the mesh that the case gives.
    pub fn generated(case: EvaluationCase, by: GroupBy) -> Self {
        Self {
            name: case.name(),
            group: by.of(&case),
            depth: case.observation.depth().clone(),
            mask: case.observation.mask().clone(),
            photo: case.observation.photo().cloned(),
            camera: case.observation.camera(),
            mesh: case.object,
            camera_from_mesh: case.camera_from_object,
        }
    }

    /// The views with a true pose in a case folder, a scene folder, a folder with frames, or in the folders below.
    ///
    /// # Errors
    /// Those of [`read_case`].
    pub fn read(folder: &Path) -> Result<Vec<Self>> {
        let mut below = listed(folder)?;
        below.retain(|path| path.is_dir());
        if folder.join("objects").is_dir() {
            return Self::of_scene(folder);
        }
        if below.iter().any(|path| last_name(path).starts_with("frame_")) {
            return Self::of_frames(folder);
        }
        if folder.join("camera.json").is_file() {
            let case = read_case(folder)?;
            let observation = case.observation;
            let view = case.truth.map(|(camera_from_mesh, _)| Self {
                group: group(&case.name),
                name: case.name,
                depth: observation.depth().clone(),
                mask: observation.mask().clone(),
                photo: observation.photo().cloned(),
                camera: observation.camera(),
                mesh: case.mesh,
                camera_from_mesh,
            });
            return Ok(view.into_iter().collect());
        }
        Ok(below.iter().map(|path| Self::read(path)).collect::<Result<Vec<_>>>()?.into_iter().flatten().collect())
    }

    fn of_scene(folder: &Path) -> Result<Vec<Self>> {
        let (BenchScene { name, depth, camera, objects, .. }, photo) = (BenchScene::read(folder)?, photo_of(folder)?);
        let view = |object: BenchObject| {
            let truth = object.truth?;
            Some(Self {
                name: format!("{name}/{}", object.name),
                group: group(&name),
                depth: depth.clone(),
                mask: object.mask,
                photo: photo.clone(),
                camera,
                mesh: object.mesh,
                camera_from_mesh: truth.camera_from_mesh,
            })
        };
        Ok(objects.into_iter().filter_map(view).collect())
    }

    fn of_frames(folder: &Path) -> Result<Vec<Self>> {
        let Sequence { name, mesh, frames, .. } = read_sequence(folder)?;
        let view = |frame: SequenceFrame| {
            let shown = frame.view.frame;
            Some(Self {
                name: format!("{name}/{}", frame.name),
                group: group(&name),
                depth: shown.depth,
                mask: shown.mask?,
                photo: shown.photo.as_deref().cloned(),
                camera: shown.camera,
                mesh: mesh.clone(),
                camera_from_mesh: frame.camera_from_mesh?,
            })
        };
        Ok(frames.into_iter().filter_map(view).collect())
    }
}

fn group(name: &str) -> String {
    name.split('-').next().unwrap_or(name).to_owned()
}
