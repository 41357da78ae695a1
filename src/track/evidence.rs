//! The part of a frame around the object, prepared for rendering and for comparison with the photo.

use std::rc::Rc;

use crate::error::Result;
use crate::evidence::frame::Frame;
use crate::evidence::observation::Observation;
use crate::evidence::photo::PhotoRegion;
use crate::geometry::image::{Mask, bounds_of};
use crate::precise::drawing::equivalence::Equivalence;
use crate::precise::drawing::mesh_pyramid::MeshPyramid;
use crate::precise::drawing::pose::{CropPose, MeshFrame};
use crate::precise::observation::clean::CleanObservation;
use crate::precise::scoring::appearance::PhotoCells;
use crate::precise::search::problem::Search;
use crate::precise::search::recipe::{FINE, SearchSettings};
use crate::views::predicted_mask::with_predicted_mask;

/// Margin of the window around the mask or the mesh, relative to its longer side, and in pixels.
const MARGIN: f64 = 0.46;
const MARGIN_PX: f64 = 8.0;
/// Pixels of the box of the object beyond which the window is thinned out: the finest grid that is used has some thousand
/// cells.
const MAX_BOX_PX: f64 = 16_000.0;

/// The mesh of a tracked object, prepared for the searches in its frames.
pub struct TrackedMesh {
    /// The mesh.
    pub pyramid: Rc<MeshPyramid>,
    /// Grids and weights.
    pub settings: SearchSettings,
    /// Its equivalent poses.
    pub equivalence: Rc<Equivalence>,
}

impl TrackedMesh {
    /// A search in an image.
    pub fn search(&self, observation: Rc<CleanObservation>) -> Search {
        let mut search = Search::new(observation, Rc::clone(&self.pyramid), self.settings);
        search.equivalence = Rc::clone(&self.equivalence);
        search
    }
}

/// The evidence around an object in a frame.
pub struct Evidence {
    /// The search.
    pub search: Search,
    /// The part of the photo that it is in.
    pub region: PhotoRegion,
}

impl Evidence {
    /// The same evidence for another search.
    pub fn shared(&self) -> Self {
        Self { search: self.search.for_rivals(), region: self.region }
    }

    /// The photo of the frame on the fine grid, if there is one.
    pub fn photo(&self, frame: &Frame) -> Option<PhotoCells> {
        let photo = frame.photo.as_ref()?;
        Some(PhotoCells::new(photo, &self.region, self.search.observation.image, self.search.grid(FINE)))
    }
}

/// The evidence around the mask of a frame; `None` if the mask shows nothing.
///
/// # Errors
/// As [`Observation::new`].
pub fn of_mask(frame: &Frame, mesh: &TrackedMesh) -> Result<Option<Evidence>> {
    let Some(mask) = frame.mask.as_ref().filter(|mask| is_set(mask)) else { return Ok(None) };
    let bounds = bounds_of(mask.data(), mask.width(), |m| *m != 0).map(|[low, high]| [low as f64, high as f64]);
    let Some(window) = Window::around(frame, bounds) else { return Ok(None) };
    evidence(window.frame, window.region, mesh)
}

/// Whether a mask has a pixel that is set.
pub fn is_set(mask: &Mask) -> bool {
    mask.data().iter().fold(0, |any, pixel| any | pixel) != 0
}

/// The evidence around the object where a pose predicts it, for a frame without a mask; `None` if the frame does not show it
/// there.
///
/// # Errors
/// As [`Observation::new`].
pub fn of_pose(frame: &Frame, pose: &CropPose, mesh: &TrackedMesh) -> Result<Option<Evidence>> {
    let (scale, center) = pose.scale_translation();
    let camera = frame.camera;
    // The sphere around the mesh, whose diameter is the diagonal of its box: the scale.
    let radius = 0.5 * scale / center.z;
    let at = [camera.fx * pose.place.x + camera.cx, camera.fy * pose.place.y + camera.cy];
    let half = [camera.fx * radius, camera.fy * radius];
    let bounds = [0, 1].map(|axis| [at[axis] - half[axis], at[axis] + half[axis]]);
    let Some(window) = Window::around(frame, bounds) else { return Ok(None) };
    let masked = with_predicted_mask(window.frame, &mesh.pyramid.fine, &pose.similarity(&MeshFrame::NORMALIZED));
    evidence(masked, window.region, mesh)
}

fn evidence(window: Frame, region: PhotoRegion, mesh: &TrackedMesh) -> Result<Option<Evidence>> {
    let Some(mask) = window.mask else { return Ok(None) };
    let observation = Observation::new(window.depth, mask, window.camera)?;
    Ok(Some(Evidence { search: mesh.search(Rc::new(CleanObservation::new(&observation))), region }))
}

/// A part of a frame, and where it lies in the photo.
struct Window {
    frame: Frame,
    region: PhotoRegion,
}

impl Window {
    /// The frame around a box, in pixels; `None` if that is outside the image.
    fn around(frame: &Frame, bounds: [[f64; 2]; 2]) -> Option<Self> {
        let size = [frame.depth.width(), frame.depth.height()];
        let sides = bounds.map(|[low, high]| high - low);
        if !sides.iter().all(|side| side.is_finite()) {
            return None;
        }
        let margin = MARGIN * sides[0].max(sides[1]) + MARGIN_PX;
        let mut pixels = [[0; 2]; 2];
        for axis in 0..2 {
            let most = size[axis] as f64;
            let inside = |x: f64| x.max(0.0).min(most) as usize;
            pixels[axis] = [inside(bounds[axis][0] - margin), inside(bounds[axis][1] + margin + 1.0)];
            if pixels[axis][0] >= pixels[axis][1] {
                return None;
            }
        }
        let step = (sides[0] * sides[1] / MAX_BOX_PX).max(1.0).sqrt().ceil() as usize;
        let part = frame.window(pixels, step);
        // Of every cell of `step` pixels, the first is taken.
        let per_px = step as f64;
        let first = |axis: usize| pixels[axis][0] as f64 - 0.5 * (per_px - 1.0);
        let sides = [part.depth.width(), part.depth.height()];
        let region = PhotoRegion {
            corner: [0, 1].map(|axis| first(axis) / size[axis] as f64),
            size: [0, 1].map(|axis| sides[axis] as f64 * per_px / size[axis] as f64),
        };
        Some(Self { frame: part, region })
    }
}
