//! A Gaussian of a splat.

use glam::{Mat3, Quat, Vec3};

use crate::guard::{MAX_VERTICES, corrupt, too_large};
use sim3align_geometry::surface_colors::Rgb;
use sim3align_runtime::error::{Error, ErrorCode, Result};

/// A Gaussian in the frame of its file.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gaussian {
    pub center: Vec3,
    /// Standard deviations along its axes.
    pub scales: Vec3,
    /// Of its axes.
    pub rotation: Quat,
    /// From 0 to 1.
    pub opacity: f32,
    pub color: Rgb,
}

impl Gaussian {
    /// Checks the numbers of the `index`th Gaussian of a file. `wxyz` is a quaternion of any length.
    ///
    /// # Errors
    /// [`ErrorCode::NonFinite`] for the centre, [`ErrorCode::CorruptFile`] for the rest.
    pub fn new(index: usize, center: Vec3, scales: Vec3, wxyz: [f32; 4], opacity: f32, color: Rgb) -> Result<Self> {
        if !center.is_finite() {
            return Err(Error::new(
                ErrorCode::NonFinite,
                "mesh.positions",
                format!("a centre that is not finite, of Gaussian {index}"),
                "finite numbers",
                "Remove the Gaussian before passing the splat.",
            ));
        }
        let [w, x, y, z] = wxyz;
        let rotation = Quat::from_xyzw(x, y, z, w);
        if !(scales.is_finite() && rotation.is_finite() && !opacity.is_nan()) {
            let found = format!("a scale, rotation or opacity that is not a number, of Gaussian {index}");
            return Err(corrupt("mesh", found, "numbers"));
        }
        let length = rotation.length();
        let rotation = if length > 1e-6 && length.is_finite() { rotation * (1.0 / length) } else { Quat::IDENTITY };
        Ok(Self { center, scales, rotation, opacity, color })
    }

    /// The covariance as its upper triangle, xx, xy, xz, yy, yz, zz, of the Gaussian scaled by `factor` and with standard
    /// deviations of `most` at most.
    pub fn covariance(&self, factor: f32, most: f32) -> [f32; 6] {
        let scales = (self.scales * factor).min(Vec3::splat(most));
        let axes = Mat3::from_quat(self.rotation);
        let axes = [axes.x_axis * scales.x, axes.y_axis * scales.y, axes.z_axis * scales.z];
        let sum = |i: usize, j: usize| axes.iter().map(|axis| axis[i] * axis[j]).sum();
        [sum(0, 0), sum(0, 1), sum(0, 2), sum(1, 1), sum(1, 2), sum(2, 2)]
    }
}

/// Checks the number of Gaussians of a file.
///
/// # Errors
/// [`ErrorCode::FileTooLarge`].
pub(super) fn check_count(count: usize) -> Result<()> {
    if count <= MAX_VERTICES {
        return Ok(());
    }
    Err(too_large("mesh", format!("{count} Gaussians"), format!("at most {MAX_VERTICES}")))
}
