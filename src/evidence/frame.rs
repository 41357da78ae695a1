//! A frame: depth and camera, and the mask of the object where it is known.

use std::sync::Arc;

use super::observation::{Observation, check_mask_size, check_pixels};
use super::photo::{Photo, check_photo};
use crate::error::Result;
use crate::geometry::image::{DepthMap, Mask};
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
        Ok(Some(match &self.photo {
            Some(photo) => observation.with_photo(photo.clone())?,
            None => observation,
        }))
    }

    /// The part of the frame in a box of pixels, [first, end) along columns and rows, at every `step`-th pixel, without the
    /// photo. The camera frame stays the same.
    pub fn window(&self, bounds: [[usize; 2]; 2], step: usize) -> Self {
        let width = self.depth.width();
        let step = step.max(1);
        let [columns, rows] = bounds.map(|[first, end]| (first..end).step_by(step));
        let size = [columns.len(), rows.len()];
        let pixels = || rows.clone().flat_map(|v| columns.clone().map(move |u| v * width + u));
        let mut depth = DepthMap::filled(size[0], size[1], 0.0);
        depth.data_mut().iter_mut().zip(pixels()).for_each(|(z, i)| *z = self.depth.data()[i]);
        let mask = self.mask.as_ref().map(|mask| {
            let mut part = Mask::filled(size[0], size[1], 0);
            part.data_mut().iter_mut().zip(pixels()).for_each(|(m, i)| *m = mask.data()[i]);
            part
        });
        let camera = self.camera.thinned(bounds.map(|[first, _]| first), step);
        Self { depth, camera, mask, photo: None }
    }
}
