//! The pinhole camera in OpenCV's convention.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::angle::sin_cos;
use sim3align_runtime::error::{Error, ErrorCode, Result};
use sim3align_runtime::number::number;

/// Largest ratio of the two focal lengths: pixels of cameras are nearly square, also after a resize that is not uniform.
const MAX_FOCAL_RATIO: f64 = 20.0;

/// Tangents of half the narrowest field of view, 0.01°, and of half the widest, 179°.
const HALF_VIEW: [f64; 2] = [8.7e-5, 114.6];

/// A pinhole camera: x right, y down, z forward; pixel centres at integer indices,
/// so that u = fx·x/z + cx is the centre of column u for whole u.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Pinhole {
    /// Focal length along u, in pixels.
    pub fx: f64,
    /// Focal length along v, in pixels.
    pub fy: f64,
    /// Principal point, column, in pixels.
    pub cx: f64,
    /// Principal point, row, in pixels.
    pub cy: f64,
}

impl Pinhole {
    /// A camera from its intrinsics, in pixels.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidCamera`] for focal lengths that are not finite and positive or that differ by more than a
    /// factor of 20, or a principal point that is not finite.
    pub fn new(fx: f64, fy: f64, cx: f64, cy: f64) -> Result<Self> {
        let bad = |name: &str, value: f64, expected: &str| {
            Error::new(
                ErrorCode::InvalidCamera,
                format!("camera.{name}"),
                number(value),
                expected.to_owned(),
                "Intrinsics are in pixels of the depth image: scale them together with the image.",
            )
        };
        for (name, value) in [("fx", fx), ("fy", fy)] {
            if !(value.is_finite() && value > 0.0) {
                return Err(bad(name, value, "a finite number above 0"));
            }
        }
        for (name, value) in [("cx", cx), ("cy", cy)] {
            if !value.is_finite() {
                return Err(bad(name, value, "a finite number"));
            }
        }
        if fx.max(fy) > MAX_FOCAL_RATIO * fx.min(fy) {
            return Err(Error::new(
                ErrorCode::InvalidCamera,
                "camera",
                format!("fx {} and fy {}", number(fx), number(fy)),
                "focal lengths within a factor of 20 of each other",
                "Both are in pixels of the depth image, and about equal for square pixels.",
            ));
        }
        Ok(Self { fx, fy, cx, cy })
    }

    /// Checks that an image of this size and camera is one that a pinhole camera can take.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidCamera`] for a field of view below 0.01° or above 179°, and for a principal point so far
    /// outside the image that all its rays are perpendicular to the optical axis.
    pub fn check_field_of_view(&self, width: usize, height: usize) -> Result<()> {
        let invalid = |found: String, expected: &str| {
            let remedy = "Intrinsics are in pixels of the depth image: scale them together with the image.";
            Err(Error::new(ErrorCode::InvalidCamera, "camera", found, expected.to_owned(), remedy))
        };
        let size = [width as f64, height as f64];
        let (focal, center) = ([self.fx, self.fy], [self.cx, self.cy]);
        let half = (0.5 * size[0] / focal[0]).max(0.5 * size[1] / focal[1]);
        if !(HALF_VIEW[0]..=HALF_VIEW[1]).contains(&half) {
            let degrees = number(2.0 * libm::atan2(half, 1.0).to_degrees());
            let found = format!(
                "fx {} and fy {} for {width} × {height} pixels, a field of view of {degrees}°",
                number(focal[0]),
                number(focal[1])
            );
            return invalid(found, "a field of view from 0.01 to 179°");
        }
        let beyond = |axis: usize| (-0.5 - center[axis]).max(center[axis] - (size[axis] - 0.5)) / focal[axis];
        if beyond(0).max(beyond(1)) > HALF_VIEW[1] {
            let found = format!("cx {} and cy {} for {width} × {height} pixels", number(center[0]), number(center[1]));
            return invalid(found, "a principal point in the image or, for a crop, near it");
        }
        Ok(())
    }

    /// A camera from its vertical field of view in degrees: square pixels, principal point at the image centre.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidCamera`] for an angle outside (0, 180).
    pub fn from_vertical_fov(fov_y_deg: f64, width: usize, height: usize) -> Result<Self> {
        if !(fov_y_deg > 0.0 && fov_y_deg < 180.0) {
            return Err(Error::new(
                ErrorCode::InvalidCamera,
                "camera.fovYDeg",
                number(fov_y_deg),
                "an angle above 0 and below 180 degrees",
                "Pass the vertical field of view in degrees, as three.js' PerspectiveCamera.fov.",
            ));
        }
        let (sin, cos) = sin_cos(0.5 * fov_y_deg.to_radians());
        let f = 0.5 * height as f64 * cos / sin;
        Self::new(f, f, 0.5 * (width as f64 - 1.0), 0.5 * (height as f64 - 1.0))
    }

    /// The camera of an image that begins with the pixel `first` and has every `step`-th row and column.
    pub fn thinned(&self, first: [usize; 2], step: usize) -> Self {
        let scale = 1.0 / step as f64;
        let [left, top] = first.map(|first| first as f64);
        let [cx, cy] = [(self.cx - left) * scale, (self.cy - top) * scale];
        Self { fx: self.fx * scale, fy: self.fy * scale, cx, cy }
    }

    /// Back-projects pixel (u, v) at z-depth `z` into the camera frame: z·K⁻¹\[u,v,1\]ᵀ (paper §3.1).
    pub fn back_project(&self, u: f64, v: f64, z: f64) -> Vec3 {
        Vec3::new(((u - self.cx) * z / self.fx) as f32, ((v - self.cy) * z / self.fy) as f32, z as f32)
    }

    /// Projects a point of the camera frame with z > 0 to pixel coordinates (u, v).
    pub fn project(&self, point: Vec3) -> [f64; 2] {
        let [x, y, z] = point.to_array().map(f64::from);
        [self.fx * x / z + self.cx, self.fy * y / z + self.cy]
    }
}
