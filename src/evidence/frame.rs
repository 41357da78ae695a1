//! A frame: depth and camera, and the mask of the object where it is known.

use std::sync::Arc;

use super::observation::{Observation, check_mask_size, check_pixels};
use super::photo::{Photo, check_photo};
use crate::error::Result;
use crate::geometry::image::{DepthMap, Image, Mask};
use crate::geometry::pinhole::Pinhole;

/// One image of several views or of a video.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Depth in metres; 0 is "no reading".
    pub depth: DepthMap,
    /// The intrinsics.
    pub camera: Pinhole,
    /// The mask of the object, of the size of the depth map, if it is known.
    pub mask: Option<Mask>,
    /// The photo, with the field of view of the depth map, if there is one.
    pub photo: Option<Arc<Photo>>,
    /// See [`Observation::relief_deviation`].
    pub relief_deviation: f64,
}

impl Frame {
    /// Checks what holds for every frame, also for one without a mask.
    ///
    /// # Errors
    /// [`ErrorCode::SizeMismatch`](crate::error::ErrorCode::SizeMismatch),
    /// [`ErrorCode::FileTooLarge`](crate::error::ErrorCode::FileTooLarge),
    /// [`ErrorCode::InvalidCamera`](crate::error::ErrorCode::InvalidCamera).
    pub fn check(&self) -> Result<()> {
        self.mask.as_ref().map_or(Ok(()), |mask| check_mask_size([self.depth.width(), self.depth.height()], mask))?;
        check_pixels(&self.depth)?;
        let (width, height) = (self.depth.width(), self.depth.height());
        self.camera.check_field_of_view(width, height)?;
        self.photo.as_ref().map_or(Ok(()), |photo| check_photo(photo, [width, height]))
    }

    /// The observation of the frame; `None` without a mask.
    ///
    /// # Errors
    /// As [`Observation::new`] and [`Observation::with_photo`].
    pub fn observation(&self) -> Result<Option<Observation>> {
        let Some(mask) = self.mask.clone() else { return Ok(None) };
        let observation = Observation::new(self.depth.clone(), mask, self.camera)?;
        let observation = observation.with_relief_deviation(self.relief_deviation);
        Ok(Some(match &self.photo {
            Some(photo) => observation.with_photo(photo.clone())?,
            None => observation,
        }))
    }

    /// The part of the frame in a box of pixels, [first, end) along columns and rows, at every `step`-th pixel, without the
    /// photo. The camera frame stays the same.
    pub fn window(&self, bounds: [[usize; 2]; 2], step: usize) -> Self {
        let step = step.max(1);
        Self {
            depth: thinned(&self.depth, bounds, step, 0.0),
            camera: self.camera.thinned(bounds.map(|[first, _]| first), step),
            mask: self.mask.as_ref().map(|mask| thinned(mask, bounds, step, 0)),
            photo: None,
            relief_deviation: self.relief_deviation,
        }
    }
}

/// Every `step`-th pixel of an image in a box.
fn thinned<T: Copy>(image: &Image<T>, [columns, rows]: [[usize; 2]; 2], step: usize, empty: T) -> Image<T> {
    let [width, height] = [columns, rows].map(|[first, end]| (end - first).div_ceil(step));
    let mut part = Image::filled(width, height, empty);
    let from = image.data().chunks_exact(image.width().max(1)).take(rows[1]).skip(rows[0]).step_by(step);
    for (to, from) in part.data_mut().chunks_exact_mut(width.max(1)).zip(from) {
        to.iter_mut().zip(from[columns[0]..columns[1]].iter().step_by(step)).for_each(|(to, from)| *to = *from);
    }
    part
}
