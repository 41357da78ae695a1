//! Observation (paper §3.1): the partial cloud of an object from depth, mask and camera.

use std::sync::Arc;

use glam::Vec3;

use super::photo::{Photo, check_photo};
use crate::error::{Error, ErrorCode, Result};
use crate::geometry::cloud::Cloud;
use crate::geometry::image::{DepthMap, Image, Mask, bounds_of};
use crate::geometry::pinhole::Pinhole;
use crate::geometry::random::Random;
use crate::number::number;

/// Random stream of the subsampling in [`Observation::cloud`].
const STREAM: u64 = 1;

/// Minimum number of readings inside the mask.
pub const MIN_POINTS: usize = 32;

/// Minimum width and height of the mask, in pixels.
const MIN_SIDE: usize = 3;

/// The smallest depth that counts as a reading, metres: the squares of smaller ones leave the range of f32.
const NEAREST_M: f32 = 1e-12;

/// Depth that at least one reading of the mask must not exceed, metres: the squares of larger ones leave the range of f32.
const FARTHEST_M: f32 = 1e12;

/// Maximum number of pixels: those of 4096 × 4096, twice those of a 4K image. No answer needs as many.
pub const MAX_PIXELS: usize = 1 << 24;

/// An observation: depth in metres, the mask of the object (same size), and intrinsics.
#[derive(Debug, Clone, PartialEq)]
pub struct Observation {
    depth: DepthMap,
    mask: Mask,
    bounds: [[usize; 2]; 2],
    camera: Pinhole,
    photo: Option<Arc<Photo>>,
    others: Option<Arc<Mask>>,
    relief_deviation: f64,
}

impl Observation {
    /// A validated observation. Depths below 1e-12 m are no readings.
    ///
    /// # Errors
    /// [`ErrorCode::SizeMismatch`], [`ErrorCode::FileTooLarge`], [`ErrorCode::InvalidCamera`], [`ErrorCode::EmptyMask`],
    /// [`ErrorCode::NoDepthInMask`], [`ErrorCode::TooFewPoints`], [`ErrorCode::DegenerateMask`],
    /// [`ErrorCode::FlatDepth`].
    pub fn new(mut depth: DepthMap, mask: Mask, camera: Pinhole) -> Result<Self> {
        check_mask_size([depth.width(), depth.height()], &mask)?;
        check_pixels(&depth)?;
        camera.check_field_of_view(depth.width(), depth.height())?;
        depth.data_mut().iter_mut().filter(|z| **z < NEAREST_M).for_each(|z| *z = 0.0);
        let bounds = bounds_of(mask.data(), mask.width(), |m| *m != 0);
        let observation = Self { depth, mask, bounds, camera, photo: None, others: None, relief_deviation: 0.0 };
        observation.check_readings()?;
        Ok(observation)
    }

    /// The observation with its photo.
    ///
    /// # Errors
    /// [`ErrorCode::SizeMismatch`] if the photo cannot have the field of view of the depth map.
    pub fn with_photo(self, photo: impl Into<Arc<Photo>>) -> Result<Self> {
        let photo = photo.into();
        check_photo(&photo, [self.depth.width(), self.depth.height()])?;
        Ok(Self { photo: Some(photo), ..self })
    }

    /// The observation with the pixels that are known to show other objects. Pixels of its own mask are ignored.
    ///
    /// # Errors
    /// [`ErrorCode::SizeMismatch`] if the mask of the others has another size.
    pub fn with_others(self, others: Mask) -> Result<Self> {
        let size = |mask: &Mask| [mask.width(), mask.height()];
        if size(&others) != size(&self.mask) {
            let [width, height] = size(&others);
            let found = format!("{width} × {height} pixels");
            let remedy = "Pass masks of the size of the depth map.";
            return Err(Error::new(ErrorCode::SizeMismatch, "occluders", found, "masks of one size", remedy));
        }
        Ok(Self { others: Some(Arc::new(others)), ..self })
    }

    /// The observation in depth whose relief, beside the width of the object, is an estimate with this relative standard
    /// deviation.
    pub fn with_relief_deviation(self, relief_deviation: f64) -> Self {
        Self { relief_deviation, ..self }
    }

    /// That standard deviation; 0 for measured depth.
    pub fn relief_deviation(&self) -> f64 {
        self.relief_deviation
    }

    /// The pixels of other objects, if they are known.
    pub fn others(&self) -> Option<&Mask> {
        self.others.as_deref()
    }

    /// The photo, if there is one.
    pub fn photo(&self) -> Option<&Photo> {
        self.photo.as_deref()
    }

    /// The depth map in metres; 0 is "no reading".
    pub fn depth(&self) -> &DepthMap {
        &self.depth
    }

    /// The mask; non-zero pixels are the object.
    pub fn mask(&self) -> &Mask {
        &self.mask
    }

    /// The box of the mask: first and last column, first and last row.
    pub fn bounds(&self) -> [[usize; 2]; 2] {
        self.bounds
    }

    /// The intrinsics.
    pub fn camera(&self) -> Pinhole {
        self.camera
    }

    /// P_obs: x = D(u,v)·K⁻¹\[u,v,1\]ᵀ for every reading in the mask, row-major, in the camera frame (metres).
    /// More than `max_points` are subsampled: one random reading from each of `max_points` equal intervals.
    pub fn cloud(&self, max_points: usize, seed: u64) -> Cloud {
        let readings: Vec<usize> = self.readings().map(|(i, _)| i).collect();
        let width = self.depth.width();
        let back_project = |i: usize| -> Vec3 {
            self.camera.back_project((i % width) as f64, (i / width) as f64, f64::from(self.depth.data()[i]))
        };
        let n = readings.len();
        if n <= max_points {
            return Cloud::from_points(readings.into_iter().map(back_project).collect());
        }
        let mut random = Random::new(seed, STREAM);
        Cloud::from_points(random.one_of_each_run(n, max_points).map(|k| back_project(readings[k])).collect())
    }

    /// The indices of the pixels of the mask, row-major.
    pub fn pixels(&self) -> impl Iterator<Item = usize> {
        let (mask, width, [[left, right], [top, bottom]]) = (self.mask.data(), self.mask.width(), self.bounds);
        (top..=bottom)
            .flat_map(move |v| v * width + left..=v * width + right)
            .filter(|i| mask.get(*i).is_some_and(|m| *m != 0))
    }

    /// Index and depth of each reading inside the mask, row-major.
    fn readings(&self) -> impl Iterator<Item = (usize, f32)> {
        self.pixels().map(|i| (i, self.depth.data()[i])).filter(|(_, z)| *z > 0.0)
    }

    fn check_readings(&self) -> Result<()> {
        let mask_pixels = self.pixels().count();
        if mask_pixels == 0 {
            return Err(Error::new(
                ErrorCode::EmptyMask,
                "mask",
                "no non-zero pixel",
                "non-zero pixels for the object",
                "Check the instance or class value of the mask, and that it was not inverted or lost in resizing.",
            ));
        }
        let (mut count, mut range) = (0, [f32::MAX, 0.0f32]);
        for (_, z) in self.readings() {
            (count, range) = (count + 1, [range[0].min(z), range[1].max(z)]);
        }
        let [nearest, farthest] = range;
        if count == 0 {
            return Err(Error::new(
                ErrorCode::NoDepthInMask,
                "depth",
                format!("no reading in the {mask_pixels} pixels of the mask"),
                "finite depths above 0 inside the mask",
                "Check that depth and mask belong to the same view; glass and black objects may return nothing.",
            ));
        }
        if count < MIN_POINTS {
            return Err(Error::new(
                ErrorCode::TooFewPoints,
                "depth",
                format!("{count} readings in the {mask_pixels} pixels of the mask"),
                format!("at least {MIN_POINTS}"),
                "Use a larger image of the object, or a depth source with fewer holes.",
            ));
        }
        if nearest > FARTHEST_M {
            return Err(Error::new(
                ErrorCode::NoDepthInMask,
                "depth",
                format!("readings of {} m and more in the mask", number(nearest.into())),
                format!("depths in metres, up to {}", number(FARTHEST_M.into())),
                "Check the unit of the depth, and that it was read with the right byte order.",
            ));
        }
        let sides = self.bounds.map(|[low, high]| high + 1 - low);
        if sides[0].min(sides[1]) < MIN_SIDE {
            return Err(degenerate_mask(format!("a line of {} × {} pixels", sides[0], sides[1])));
        }
        if nearest == farthest {
            return Err(Error::new(
                ErrorCode::FlatDepth,
                "depth",
                format!("{} m in all {count} readings of the mask", number(f64::from(nearest))),
                "depths that vary over the object",
                "A constant is a placeholder, not a measurement: pass the depth map itself.",
            ));
        }
        Ok(())
    }
}

/// The error for a mask that shows no shape.
pub fn degenerate_mask(found: impl Into<crate::error::Text>) -> Error {
    Error::new(
        ErrorCode::DegenerateMask,
        "mask",
        found,
        "the area that the object covers in the image",
        "Pass the object's whole mask. An object that is this thin in the image needs a larger image.",
    )
}

/// Checks that a mask has the size of its depth map.
///
/// # Errors
/// [`ErrorCode::SizeMismatch`].
pub fn check_mask_size(size: [usize; 2], mask: &Mask) -> Result<()> {
    if [mask.width(), mask.height()] == size {
        return Ok(());
    }
    Err(Error::new(
        ErrorCode::SizeMismatch,
        "mask",
        format!("{} × {} pixels for a depth map of {} × {}", mask.width(), mask.height(), size[0], size[1]),
        "depth and mask of the same size",
        "Resize the mask to the depth map, or set resizeMask: \"nearest\".",
    ))
}

pub(super) fn check_pixels(depth: &DepthMap) -> Result<()> {
    let (width, height) = (depth.width(), depth.height());
    if depth.data().len() <= MAX_PIXELS {
        return Ok(());
    }
    Err(Error::new(
        ErrorCode::FileTooLarge,
        "depth",
        format!("{width} × {height} pixels"),
        format!("at most {MAX_PIXELS} pixels, those of 4096 × 4096"),
        "Downscale depth, mask and camera, or crop them to the object.",
    ))
}

/// Depth and camera from a point map (H×W×3, camera frame, metres), for example of MoGe. Points with z ≤ 0 or a
/// non-finite coordinate are no readings.
///
/// The intrinsics are the least-squares fit of u = fx·x/z + cx and v = fy·y/z + cy over the readings.
///
/// # Errors
/// [`ErrorCode::WrongLength`], [`ErrorCode::EmptyImage`], [`ErrorCode::NoDepthInMask`] without readings,
/// and [`ErrorCode::InvalidCamera`] if the points do not fit a pinhole camera that looks along z.
pub fn from_point_map(width: usize, height: usize, points: &[f32]) -> Result<(DepthMap, Pinhole)> {
    if !points.len().is_multiple_of(3) {
        return Err(Error::new(
            ErrorCode::WrongLength,
            "pointMap",
            format!("{} numbers", points.len()),
            "width × height × 3",
            "Pass x, y, z per pixel, pixel by pixel.",
        ));
    }
    crate::geometry::image::check_size("pointMap", width, height, points.len() / 3)?;
    let reading = |p: &[f32]| p.iter().all(|c| c.is_finite()) && p[2] > 0.0;
    let depth = points.chunks_exact(3).map(|p| if reading(p) { p[2] } else { 0.0 }).collect();
    let rays = || points.chunks_exact(3).enumerate().filter(|(_, p)| reading(p));
    if rays().next().is_none() {
        return Err(Error::new(
            ErrorCode::NoDepthInMask,
            "pointMap",
            format!("no reading in {width} × {height} points"),
            "finite points with z above 0",
            "Pass points in the OpenCV camera frame (z forward); a map in OpenGL's has z below 0.",
        ));
    }
    let fit = |axis: usize, pixel: &dyn Fn(usize) -> f64| {
        let [mut n, mut sx, mut sy, mut sxx, mut sxy] = [0.0; 5];
        for (i, p) in rays() {
            let (x, y) = (f64::from(p[axis]) / f64::from(p[2]), pixel(i));
            n += 1.0;
            sx += x;
            sy += y;
            sxx += x * x;
            sxy += x * y;
        }
        let f = (n * sxy - sx * sy) / (n * sxx - sx * sx);
        (f, (sy - f * sx) / n)
    };
    let (fx, cx) = fit(0, &|i| (i % width) as f64);
    let (fy, cy) = fit(1, &|i| (i / width) as f64);
    let camera = Pinhole::new(fx, fy, cx, cy).map_err(|_| {
        Error::new(
            ErrorCode::InvalidCamera,
            "pointMap",
            format!("points whose best pinhole camera has fx {}, fy {}", number(fx), number(fy)),
            "points in the OpenCV camera frame: x right, y down, z forward",
            "Convert the point map from its own frame (OpenGL: negate y and z; PyTorch3D: negate x and y).",
        )
    })?;
    Ok((Image::new("pointMap", width, height, depth)?, camera))
}
