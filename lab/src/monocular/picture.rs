//! An image with objects of known pose, from any source.

use crate::bench::benchmark::BenchCase;
use crate::bench::scene_bench::BenchScene;
use crate::prelude::*;
use sim3align::align::evaluate::Truth;
use sim3align_geometry::image::bounds_of;

/// An image with objects of known pose.
#[derive(Debug, Clone)]
pub struct Picture {
    /// Its name.
    pub name: String,
    /// Depth, metres.
    pub depth: DepthMap,
    /// Its true camera.
    pub camera: Pinhole,
    /// The photo, if there is one.
    pub photo: Option<Photo>,
    /// The objects.
    pub objects: Vec<Thing>,
    /// Whether depth has steps at edges, as only generated depth has: then a model makes ramps of them.
    pub has_steps: bool,
}

/// An object in an image.
#[derive(Debug, Clone)]
pub struct Thing {
    /// Its name.
    pub name: String,
    /// Its mask.
    pub mask: Mask,
    /// Its mesh.
    pub mesh: Mesh,
    /// The colours of the mesh, if it has any.
    pub colors: Option<SurfaceColors>,
    /// Its true pose, if known.
    pub truth: Option<Truth>,
}

impl From<BenchCase> for Picture {
    fn from(case: BenchCase) -> Self {
        let observation = &case.observation;
        let thing = Thing {
            name: case.name.clone(),
            mask: observation.mask().clone(),
            mesh: case.mesh,
            colors: case.colors,
            truth: case.truth,
        };
        Self {
            depth: observation.depth().clone(),
            camera: observation.camera(),
            photo: observation.photo().cloned(),
            objects: vec![thing],
            has_steps: false,
            name: case.name,
        }
    }
}

impl From<BenchScene> for Picture {
    fn from(scene: BenchScene) -> Self {
        let thing = |object: crate::bench::scene_bench::BenchObject| Thing {
            name: object.name,
            mask: object.mask,
            mesh: object.mesh,
            colors: None,
            truth: object.truth,
        };
        Self {
            name: scene.name,
            depth: scene.depth,
            camera: scene.camera,
            photo: None,
            objects: scene.objects.into_iter().map(thing).collect(),
            has_steps: false,
        }
    }
}

impl Thing {
    /// Its width in the image, pixels: the geometric mean of the sides of the mask's box.
    pub fn width_px(&self) -> f64 {
        let sides = bounds_of(self.mask.data(), self.mask.width(), |m| *m != 0);
        let [width, height] = sides.map(|[low, high]| (high + 1 - low) as f64);
        (width * height).sqrt()
    }
}
