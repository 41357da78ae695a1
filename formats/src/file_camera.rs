//! The camera that a depth model writes beside its depth.

use sim3align_geometry::angle::sin_cos;
use sim3align_geometry::pinhole::Pinhole;
use sim3align_runtime::error::{Error, Result};

/// Largest principal point and focal length of intrinsics in image sizes. Those in pixels are larger in any image that
/// shows something.
const MAX_NORMALISED: [f64; 2] = [2.0, 20.0];

/// The camera in a file.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct FileCamera {
    /// Intrinsics, row-major: in pixels, with pixel centres at integers, or in image widths and heights.
    pub intrinsics: Option<[f64; 9]>,
    /// Horizontal and vertical, in pixels.
    pub focal_lengths: Option<[f64; 2]>,
    /// In pixels; by default, that of the image's centre.
    pub principal_point: Option<[f64; 2]>,
    /// Horizontal and vertical, degrees.
    pub fields_of_view: [Option<f64>; 2],
}

impl FileCamera {
    /// The camera of an image of this size; `None` if the file has none.
    pub fn pinhole(&self, width: usize, height: usize) -> Result<Option<Pinhole>> {
        let size = [width as f64, height as f64];
        let centre = self.principal_point.unwrap_or(size.map(|side| 0.5 * (side - 1.0)));
        let (focal, centre) = if let Some([fx, _, cx, _, fy, cy, ..]) = self.intrinsics {
            let [max_centre, max_focal] = MAX_NORMALISED;
            let is_normalised = cx.max(cy) < max_centre && fx.max(fy) < max_focal;
            // MoGe measures in image sizes from the outer edge of the first pixel, whose centre is half a pixel inside.
            if is_normalised {
                ([fx * size[0], fy * size[1]], [cx * size[0] - 0.5, cy * size[1] - 0.5])
            } else {
                ([fx, fy], [cx, cy])
            }
        } else if let Some(focal) = self.focal_lengths {
            (focal, centre)
        } else {
            let focal = |axis: usize| {
                self.fields_of_view[axis].map(|degrees| {
                    let (sin, cos) = sin_cos(0.5 * degrees.to_radians());
                    0.5 * size[axis] * cos / sin
                })
            };
            match [focal(0), focal(1)] {
                [None, None] => return Ok(None),
                [fx, fy] => ([fx.or(fy), fy.or(fx)].map(Option::unwrap_or_default), centre),
            }
        };
        let pinhole = Pinhole::new(focal[0], focal[1], centre[0], centre[1]);
        pinhole.map(Some).map_err(|error: Error| {
            let argument = error.argument.replacen("camera", "depth.camera", 1);
            error.about(argument)
        })
    }
}
