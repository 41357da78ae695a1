//! Visualisation of a pose: outlines over the depth map.

use super::benchmark::BenchCase;
use crate::case_folder::write::rgb_png;
use crate::prelude::*;
use sim3align::metrics::silhouette::boundary;
use sim3align_geometry::image::bounds_of;
use sim3align_geometry::order::quantile;

/// Colour of the outline of the mask: white.
pub const MASK_COLOUR: [u8; 3] = [255, 255, 255];
/// Colour of the outline of the true pose: green.
pub const TRUTH_COLOUR: [u8; 3] = [40, 230, 90];
/// Colour of the outline of the estimated pose: orange; drawn last.
pub const POSE_COLOUR: [u8; 3] = [255, 120, 0];
/// Colour of pixels without reading.
const NO_READING: [u8; 3] = [36, 36, 36];

/// Maximum size of the image in pixels; it fills width or height.
const WIDTH_PX: f64 = 320.0;
const HEIGHT_PX: f64 = 400.0;
/// Margin around the mask: fraction of the longer side of its box, and minimum in pixels of the depth map.
const MARGIN: f64 = 0.3;
const MARGIN_PX: f64 = 8.0;
/// Quantiles of the readings that map to the nearest and farthest colours.
const NEAREST: f64 = 0.02;
const FARTHEST: f64 = 0.98;

/// The visible part of a depth map, and its magnification.
struct Crop {
    left: usize,
    top: usize,
    width: usize,
    height: usize,
    zoom: f64,
}

/// Renders a pose of a case as PNG: depth around the mask (near is bright), with the outlines of the mask, the true
/// pose (if known) and the estimated pose.
///
/// # Errors
/// [`sim3align_geometry::error::ErrorCode::Internal`] if the encoder fails.
pub fn picture(case: &BenchCase, pose: &Similarity) -> Result<Vec<u8>> {
    let (depth, mask) = (case.observation.depth(), case.observation.mask());
    let crop = Crop::about(mask);
    let (width, height) = crop.size();
    let depth = crop.resized(depth);
    let readings = || depth.data().iter().copied().filter(|z| *z > 0.0);
    let [near, far] = [NEAREST, FARTHEST].map(|share| f64::from(quantile(readings(), share).unwrap_or(1.0)));
    let shade = |z: f32| (far - f64::from(z)) / (far - near).max(1e-9);
    let mut pixels: Vec<[u8; 3]> =
        depth.data().iter().map(|&z| if z > 0.0 { cubehelix(0.06 + 0.6 * shade(z)) } else { NO_READING }).collect();

    let silhouette = |pose: &Similarity| {
        let mut rasteriser = Rasteriser::new();
        rasteriser.render_depth(&case.mesh, pose, &crop.camera(&case.observation.camera()), width, height);
        let inside = rasteriser.depth().iter().map(|z| u8::from(*z > 0.0)).collect();
        Image::new("silhouette", width, height, inside)
    };
    draw(&mut pixels, &crop.resized(mask), MASK_COLOUR);
    if let Some(truth) = &case.truth {
        draw(&mut pixels, &silhouette(&truth.camera_from_mesh)?, TRUTH_COLOUR);
    }
    draw(&mut pixels, &silhouette(pose)?, POSE_COLOUR);
    rgb_png(&pixels, width, height)
}

impl Crop {
    fn about(mask: &Mask) -> Self {
        let size = [mask.width(), mask.height()];
        let bounds = bounds_of(mask.data(), mask.width(), |m| *m != 0);
        let is_empty = mask.data().iter().all(|m| *m == 0);
        // Bounds are the first and the last pixel.
        let low = bounds.map(|[first, _]| first);
        let high = if is_empty { size } else { bounds.map(|[_, last]| last + 1) };
        let longest = (high[0] - low[0]).max(high[1] - low[1]);
        let margin = (MARGIN * longest as f64).max(MARGIN_PX) as usize;
        let low = low.map(|x| x.saturating_sub(margin));
        let [width, height] = [0, 1].map(|axis| (high[axis] + margin).min(size[axis]) - low[axis]);
        let zoom = (WIDTH_PX / width as f64).min(HEIGHT_PX / height as f64);
        Self { left: low[0], top: low[1], width, height, zoom }
    }

    /// Width and height of the image.
    fn size(&self) -> (usize, usize) {
        let scaled = |n: usize| ((n as f64 * self.zoom).round() as usize).max(1);
        (scaled(self.width), scaled(self.height))
    }

    /// The camera of the image; pixel centres are preserved.
    fn camera(&self, camera: &Pinhole) -> Pinhole {
        let (width, height) = self.size();
        let zoom = [width as f64 / self.width as f64, height as f64 / self.height as f64];
        Pinhole {
            fx: camera.fx * zoom[0],
            fy: camera.fy * zoom[1],
            cx: (camera.cx - self.left as f64 + 0.5) * zoom[0] - 0.5,
            cy: (camera.cy - self.top as f64 + 0.5) * zoom[1] - 0.5,
        }
    }

    fn resized<T: Copy + Default>(&self, image: &Image<T>) -> Image<T> {
        let mut part = Image::filled(self.width, self.height, T::default());
        for (v, row) in part.data_mut().chunks_exact_mut(self.width).enumerate() {
            let start = (self.top + v) * image.width() + self.left;
            row.copy_from_slice(&image.data()[start..start + self.width]);
        }
        let (width, height) = self.size();
        part.resize_nearest(width, height)
    }
}

/// Draws the outline of a region, two pixels wide.
fn draw(pixels: &mut [[u8; 3]], inside: &Mask, colour: [u8; 3]) {
    let width = inside.width();
    for (i, _) in boundary(inside).into_iter().enumerate().filter(|(_, outline)| *outline) {
        for k in [i, i + 1, i + width, i + width + 1] {
            let same_row = k % width >= i % width;
            if let Some(pixel) = pixels.get_mut(k).filter(|_| same_row) {
                *pixel = colour;
            }
        }
    }
}

/// A colour as bright as `share` says, 0 to 1: Green, "A colour scheme for the display of astronomical intensity
/// images", 2011, from blue by green to red, with three quarters of the saturation.
fn cubehelix(share: f64) -> [u8; 3] {
    let share = share.clamp(0.0, 1.0);
    let (sine, cosine) = libm::sincos(TAU * (0.5 / 3.0 + 1.0 - 0.8 * share));
    let amplitude = 0.75 * share * (1.0 - share) / 2.0;
    let rows = [[-0.14861, 1.78277], [-0.29227, -0.90649], [1.97294, 0.0]];
    rows.map(|[c, s]| (255.0 * (share + amplitude * (c * cosine + s * sine)).clamp(0.0, 1.0)).round() as u8)
}
