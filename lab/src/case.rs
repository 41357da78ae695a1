//! One case, from a generator or a folder: images of objects with known poses.

use std::sync::Arc;

use crate::prelude::*;
use sim3align::views::View;

/// Images of objects. A single object, a scene, several views and a video differ in the numbers of both.
#[derive(Debug, Clone)]
pub struct Case {
    /// Its name.
    pub name: String,
    /// Difficulty.
    pub tier: String,
    /// Names of the simulated errors.
    pub tags: Vec<String>,
    /// The objects.
    pub objects: Vec<CaseObject>,
    /// The images.
    pub frames: Vec<CaseFrame>,
}

/// An object of a case.
#[derive(Debug, Clone)]
pub struct CaseObject {
    /// Its name.
    pub name: String,
    /// The group in tables.
    pub class: String,
    /// The mesh.
    pub mesh: Mesh,
    /// The mesh with parts that are not of the object, which aligners get instead.
    pub surplus: Option<Mesh>,
    /// The colours of the mesh, if it has any.
    pub colors: Option<SurfaceColors>,
    /// The symmetry of the mesh.
    pub symmetry: Symmetry,
    /// The placement of the mesh by its generator, in the first image.
    pub initial: Option<Similarity>,
}

/// An image of a case.
#[derive(Debug, Clone)]
pub struct CaseFrame {
    /// Its name.
    pub name: String,
    /// Depth.
    pub depth: DepthMap,
    /// Depth without errors, of a generated case with one object.
    pub exact: Option<DepthMap>,
    /// Intrinsics.
    pub camera: Pinhole,
    /// The photo, if there is one.
    pub photo: Option<Arc<Photo>>,
    /// The pose of the camera, if it is known.
    pub world_from_camera: Option<Similarity>,
    /// The mask of each object, if there is one.
    pub masks: Vec<Option<Mask>>,
    /// The true pose of each object, `camera_from_mesh`, if it is known.
    pub truths: Vec<Option<Similarity>>,
    /// Fraction of the object that the image shows, 0 to 1; of several objects, the smallest.
    pub visible: f64,
}

impl Case {
    /// Name of an object, where there are several.
    pub fn name_of(&self, k: usize) -> String {
        format!("{}-{}", self.name, self.objects[k].name)
    }
}

impl CaseObject {
    /// The mesh as aligners get it.
    pub fn prepared(&self, with_color: bool) -> PreparedMesh<'_> {
        let mesh = PreparedMesh::borrowed(self.surplus.as_ref().unwrap_or(&self.mesh));
        mesh.with_colors(self.colors.clone().filter(|_| with_color))
    }
}

impl CaseFrame {
    /// The observation of an object.
    ///
    /// # Errors
    /// [`ErrorCode::EmptyMask`] without a mask, and those of [`Observation::new`].
    pub fn observation(&self, object: usize, with_color: bool) -> Result<Observation> {
        let mask = self.masks[object].clone();
        let mask = mask.unwrap_or_else(|| Mask::filled(self.depth.width(), self.depth.height(), 0));
        let observation = Observation::new(self.depth.clone(), mask, self.camera)?;
        match &self.photo {
            Some(photo) if with_color => observation.with_photo(photo.clone()),
            _ => Ok(observation),
        }
    }

    /// The image as one of several views of the first object.
    pub fn view(&self, with_color: bool) -> View {
        let frame = Frame {
            depth: self.depth.clone(),
            camera: self.camera,
            mask: self.masks[0].clone(),
            photo: self.photo.clone().filter(|_| with_color),
            relief_deviation: 0.0,
        };
        View { frame, world_from_camera: self.world_from_camera }
    }

    /// The pixels of all objects but one; `None` if there are no others.
    pub fn others(&self, object: usize) -> Option<Mask> {
        let others = self.masks.iter().enumerate().filter(|(k, _)| *k != object);
        let masks: Vec<&Mask> = others.filter_map(|(_, mask)| mask.as_ref()).collect();
        let mut all = (*masks.first()?).clone();
        for mask in &masks[1..] {
            all.data_mut().iter_mut().zip(mask.data()).filter(|(_, m)| **m != 0).for_each(|(all, _)| *all = 1);
        }
        Some(all)
    }
}
