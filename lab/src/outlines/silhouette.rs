//! The true silhouette of an object at a fraction of a pixel.

use crate::cases::photo::resized;
use crate::prelude::*;
use sim3align_geometry::distance_transform::squared_distances;
use sim3align_geometry::image::bounds_of;

/// Samples of the silhouette per pixel and axis.
const SAMPLES: usize = 4;
/// Distance over which the slope of the distance to the outline is taken, pixels.
const BESIDE: f64 = 1.5;
/// Least slope of that distance, which is 1 along a straight outline and less at corners and thin parts.
const LEAST_SLOPE: f64 = 0.85;

/// Depth of an object at its true pose, and the distances to its outline, around the object.
pub struct Silhouette {
    /// First pixel of the image that is covered, and number of pixels.
    corner: [usize; 2],
    size: [usize; 2],
    /// Signed distance to the outline at each sample, pixels, negative inside.
    signed: Vec<f32>,
    /// z-depth at each sample, metres; 0 beside the object.
    depth: Vec<f32>,
}

/// A point of the true outline.
#[derive(Debug, Clone, Copy)]
pub struct OutlinePoint {
    /// Where it is, pixels.
    pub at: DVec2,
    /// Unit vector outwards.
    pub normal: DVec2,
}

impl Silhouette {
    /// The silhouette of a mesh in an image of this size, with `margin` pixels around it; `None` if the image does not
    /// show the mesh.
    pub fn of(
        mesh: &Mesh,
        camera_from_mesh: &Similarity,
        camera: &Pinhole,
        image: [usize; 2],
        margin: usize,
    ) -> Option<Self> {
        let mut rasteriser = Rasteriser::new();
        rasteriser.render_depth(mesh, camera_from_mesh, camera, image[0], image[1]);
        if !rasteriser.depth().iter().any(|z| *z > 0.0) {
            return None;
        }
        let [columns, rows] = bounds_of(rasteriser.depth(), image[0], |z| *z > 0.0);
        // Bounds are the first and the last pixel.
        let corner = [columns[0].saturating_sub(margin), rows[0].saturating_sub(margin)];
        let size =
            [(columns[1] + 1 + margin).min(image[0]) - corner[0], (rows[1] + 1 + margin).min(image[1]) - corner[1]];
        let fine = resized(camera, SAMPLES as f64);
        let [left, top] = corner.map(|first| (first * SAMPLES) as f64);
        let fine = Pinhole { cx: fine.cx - left, cy: fine.cy - top, ..fine };
        let [width, height] = size.map(|n| n * SAMPLES);
        rasteriser.render_depth(mesh, camera_from_mesh, &fine, width, height);
        let inside: Vec<bool> = rasteriser.depth().iter().map(|z| *z > 0.0).collect();
        let outside: Vec<bool> = inside.iter().map(|inside| !inside).collect();
        let [to_inside, to_outside] = [&inside, &outside].map(|set| squared_distances(set, width, height));
        let signed = (0..inside.len()).map(|i| {
            let root = |squared: u32| f64::from(squared).sqrt();
            let samples = if inside[i] { 0.5 - root(to_outside[i]) } else { root(to_inside[i]) - 0.5 };
            (samples / SAMPLES as f64) as f32
        });
        Some(Self { corner, size, signed: signed.collect(), depth: rasteriser.depth().to_vec() })
    }

    /// The sample at a point in pixels; `None` beside the window.
    fn sample(&self, at: DVec2) -> Option<usize> {
        let fine = |x: f64, first: usize| (x + 0.5 - first as f64) * SAMPLES as f64;
        let [x, y] = [fine(at.x, self.corner[0]), fine(at.y, self.corner[1])];
        let [width, height] = self.size.map(|n| n * SAMPLES);
        let is_within = x >= 0.0 && y >= 0.0 && x < width as f64 && y < height as f64;
        is_within.then(|| y as usize * width + x as usize)
    }

    /// Signed distance of a point to the outline, pixels, negative inside; `None` beside the window.
    pub fn signed(&self, at: DVec2) -> Option<f64> {
        self.sample(at).map(|i| f64::from(self.signed[i]))
    }

    /// True z-depth at a point; `None` beside the object.
    pub fn depth(&self, at: DVec2) -> Option<f64> {
        self.sample(at).map(|i| f64::from(self.depth[i])).filter(|z| *z > 0.0)
    }

    /// The pixels that are at least `inside` pixels from the outline.
    pub fn interior(&self, inside: f64) -> impl Iterator<Item = [usize; 2]> {
        let [left, top] = self.corner;
        let pixels = (0..self.size[1]).flat_map(move |v| (0..self.size[0]).map(move |u| [left + u, top + v]));
        pixels.filter(move |[u, v]| {
            self.signed(DVec2::new(*u as f64, *v as f64)).is_some_and(|distance| distance <= -inside)
        })
    }

    /// Points of the outline, about one per pixel of its length, where it has a direction.
    pub fn points(&self) -> Vec<OutlinePoint> {
        let width = self.size[0] * SAMPLES;
        let mut taken = vec![false; self.size[0] * self.size[1]];
        let mut points = Vec::new();
        for (i, &signed) in self.signed.iter().enumerate() {
            // The outermost samples inside.
            if !(-0.5 / SAMPLES as f32 - 1e-6..0.0).contains(&signed) {
                continue;
            }
            let [x, y] = [i % width, i / width];
            let pixel = y / SAMPLES * self.size[0] + x / SAMPLES;
            if core::mem::replace(&mut taken[pixel], true) {
                continue;
            }
            let place = |x: usize, first: usize| (x as f64 + 0.5) / SAMPLES as f64 - 0.5 + first as f64;
            let at = DVec2::new(place(x, self.corner[0]), place(y, self.corner[1]));
            let Some(normal) = self.normal(at) else { continue };
            points.push(OutlinePoint { at: at - normal * f64::from(signed), normal });
        }
        points
    }

    fn normal(&self, at: DVec2) -> Option<DVec2> {
        let slope = |along: DVec2| Some((self.signed(at + along)? - self.signed(at - along)?) / (2.0 * BESIDE));
        let slope = DVec2::new(slope(DVec2::X * BESIDE)?, slope(DVec2::Y * BESIDE)?);
        (slope.length() >= LEAST_SLOPE).then(|| slope.normalize())
    }
}
