//! The crop grid: the cleaned observation at any resolution, on cells that are square in ray space.

use glam::Vec3;

use super::clean::CleanObservation;

/// Margin around the box of the mask for silhouettes that are too large, relative to its longer side.
const MARGIN: f64 = 0.35;
/// Maximum number of cells of a grid, relative to the number that the mask should have. A mask that fills its box has a
/// grid of four to six times its cells, a long thin one up to a hundred.
const MAX_CELLS: f64 = 192.0;
/// Maximum number of samples along a side of a cell.
const MAX_SAMPLES: usize = 4;
/// Minimum fraction of the samples of a cell with depth of the object, for the cell to have a depth.
const MIN_READINGS: f32 = 0.34;
/// Minimum number of readings, of nine in the window of a cell, to fit a normal.
const MIN_NORMAL_CELLS: u32 = 5;
/// Fraction of the cells around the mask with a reading, from which on a depth map has a background.
const COMPLETE: f32 = 0.3;
/// Depth of a cell outside the image: nearer than anything, so that it occludes any mesh there.
const OUTSIDE_M: f32 = 1e-6;

/// Evidence on `width` × `height` cells, row-major.
#[derive(Debug, Clone, Default)]
pub struct CropGrid {
    /// Width in cells.
    pub width: usize,
    /// Height in cells.
    pub height: usize,
    /// Focal length, cells.
    pub focal: f64,
    /// Principal point, cells; cell centres have integer coordinates.
    pub center: [f64; 2],
    /// Size of a cell, pixels.
    pub cell: [f64; 2],
    /// Image position of the corner of the grid, pixels.
    pub corner: [f64; 2],
    /// Whether a cell belongs to the object.
    pub mask: Vec<bool>,
    /// Number of cells of the object.
    pub mask_cells: usize,
    /// Depth of the object, metres; 0 if unknown.
    pub depth: Vec<f32>,
    /// Number of cells with a depth of the object.
    pub depth_cells: usize,
    /// Normal of the object by axis, towards the camera; zero if unknown.
    pub normals: [Vec<f32>; 3],
    /// Depth of the scene, metres; 0 without a reading, almost 0 outside the image.
    pub scene: Vec<f32>,
    /// Fraction of the cells around the mask that have a reading, 0 to 1; see [`CropGrid::unknown_weight`].
    pub known: f32,
    /// Signed distance to the outermost cells of the mask, in cells: 0 on average on these, negative inside.
    pub outline: Vec<f32>,
    /// The box of the mask: [[left, right], [top, bottom]], outer edges, in cells.
    pub bounds: [[f64; 2]; 2],
}

impl CropGrid {
    /// A square grid without evidence, seen by a camera whose axis is its centre.
    pub fn blank(side: usize, focal: f64) -> Self {
        let center = [0.5 * (side as f64 - 1.0); 2];
        Self { width: side, height: side, focal, center, mask: vec![false; side * side], ..Self::default() }
    }

    /// The observation at a resolution at which the mask has about `cells` cells.
    pub fn new(observation: &CleanObservation, cells: usize) -> Self {
        let camera = observation.camera;
        let sides = observation.bounds.map(|[low, high]| high - low);
        let pitch = (observation.pixels as f64 / cells as f64).sqrt().max(1.0);
        let margin = MARGIN * sides[0].max(sides[1]) + 3.0;
        let (pitch, margin) = bounded(pitch, margin, sides, camera.fy / camera.fx, MAX_CELLS * cells as f64);
        let cell = [pitch, pitch * camera.fy / camera.fx];
        let corner = observation.bounds.map(|[low, _]| low - margin);
        let count = |axis: usize| ((sides[axis] + 2.0 * margin) / cell[axis]).ceil() as usize + 1;
        let (width, height) = (count(0), count(1));
        let to_cell = |x: f64, axis: usize| (x - corner[axis] + 0.5) / cell[axis] - 0.5;
        let mut grid = Self {
            width,
            height,
            focal: camera.fx / pitch,
            center: [to_cell(camera.cx, 0), to_cell(camera.cy, 1)],
            cell,
            corner,
            mask: Vec::with_capacity(width * height),
            mask_cells: 0,
            depth_cells: 0,
            depth: Vec::with_capacity(width * height),
            normals: Default::default(),
            scene: Vec::with_capacity(width * height),
            known: 0.0,
            outline: Vec::with_capacity(width * height),
            bounds: [[0.0; 2]; 2],
        };
        grid.sample(observation);
        grid.mask_cells = grid.mask.iter().filter(|m| **m).count();
        grid.depth_cells = grid.depth.iter().filter(|z| **z > 0.0).count();
        grid.known = grid.known_share();
        grid.fit_normals();
        grid.measure_bounds();
        grid
    }

    /// The direction of the ray through a cell, with z = 1.
    pub fn ray(&self, u: f32, v: f32) -> Vec3 {
        let focal = self.focal as f32;
        Vec3::new((u - self.center[0] as f32) / focal, (v - self.center[1] as f32) / focal, 1.0)
    }

    /// The normal of the object in a cell, towards the camera; zero if unknown.
    #[inline]
    pub fn normal_at(&self, cell: usize) -> Vec3 {
        Vec3::from(self.normals.each_ref().map(|axis| axis[cell]))
    }

    /// The weight in the union of a silhouette cell without a reading, given that in a complete depth map.
    ///
    /// In a depth map without background, or almost, missing readings are not informative: the mask is the only evidence
    /// of free space, and such cells cost as much as free space.
    pub fn unknown_weight(&self, complete: f32) -> f32 {
        1.0 - (1.0 - complete) * (self.known / COMPLETE).min(1.0)
    }

    /// The fraction of the cells around the mask, but in the image, that have a reading.
    fn known_share(&self) -> f32 {
        let (mut cells, mut known) = (0u32, 0u32);
        for (mask, scene) in self.mask.iter().zip(&self.scene) {
            if !mask && *scene != OUTSIDE_M {
                cells += 1;
                known += u32::from(*scene > 0.0);
            }
        }
        known as f32 / cells.max(1) as f32
    }

    fn sample(&mut self, observation: &CleanObservation) {
        let samples = (self.cell[0].round() as usize).clamp(1, MAX_SAMPLES);
        let offset = |k: usize, axis: usize| ((k as f64 + 0.5) / samples as f64 - 0.5) * self.cell[axis];
        let at = |i: usize, k: usize, axis: usize| {
            let x = self.corner[axis] - 0.5 + (i as f64 + 0.5) * self.cell[axis] + offset(k, axis);
            // Shifted, so that the cast rounds down also for negative values.
            (x + 0.5 + 1_048_576.0) as i64 - 1_048_576
        };
        let [columns, rows] = [0, 1].map(|axis| {
            let count = [self.width, self.height][axis] * samples;
            let pixel = |i: usize| Sample::new(observation, axis, at(i / samples, i % samples, axis));
            (0..count).map(pixel).collect::<Vec<Sample>>()
        });
        let total = (samples * samples) as f32;
        for rows in rows.chunks_exact(samples) {
            let are_inside = rows.iter().all(Sample::is_inside);
            for columns in columns.chunks_exact(samples) {
                let mut sum = Sum::default();
                if are_inside && columns.iter().all(Sample::is_inside) {
                    rows.iter().for_each(|row| sum.add_inside(observation, row, columns));
                } else {
                    for row in rows {
                        columns.iter().for_each(|column| sum.add(observation, row, column));
                    }
                }
                let outline = sum.outline / total;
                let inside = outline < 0.0 && 2.0 * sum.outside <= total;
                self.outline.push(outline / self.cell[0] as f32 + 0.5);
                let known = inside && sum.readings >= MIN_READINGS * total;
                self.mask.push(inside);
                self.depth.push(if known { sum.depth / sum.readings } else { 0.0 });
                let scene = if sum.scene_readings > 0.0 { sum.scene / sum.scene_readings } else { 0.0 };
                self.scene.push(if 2.0 * sum.outside > total { OUTSIDE_M } else { scene });
            }
        }
    }

    /// Normals from planes fitted to 1/z, which is linear over the image of a plane.
    fn fit_normals(&mut self) {
        self.normals = [0, 1, 2].map(|_| vec![0.0; self.depth.len()]);
        for v in 1..self.height.saturating_sub(1) {
            for u in 1..self.width.saturating_sub(1) {
                let i = v * self.width + u;
                if self.depth[i] > 0.0 {
                    let normal = self.normal(u, v).unwrap_or(Vec3::ZERO).to_array();
                    self.normals.iter_mut().zip(normal).for_each(|(axis, x)| axis[i] = x);
                }
            }
        }
    }

    fn normal(&self, u: usize, v: usize) -> Option<Vec3> {
        let [mut n, mut su, mut sv, mut sw, mut suu, mut suv, mut svv, mut suw, mut svw] = [0.0f32; 9];
        let mut count = 0;
        for dv in 0..3 {
            for du in 0..3 {
                let z = self.depth[(v + dv - 1) * self.width + u + du - 1];
                if z > 0.0 {
                    let (x, y, w) = (du as f32 - 1.0, dv as f32 - 1.0, 1.0 / z);
                    count += 1;
                    n += 1.0;
                    su += x;
                    sv += y;
                    sw += w;
                    suu += x * x;
                    suv += x * y;
                    svv += y * y;
                    suw += x * w;
                    svw += y * w;
                }
            }
        }
        if count < MIN_NORMAL_CELLS {
            return None;
        }
        let (mu, mv, mw) = (su / n, sv / n, sw / n);
        let (a, b, c) = (suu - n * mu * mu, suv - n * mu * mv, svv - n * mv * mv);
        let (d, e) = (suw - n * mu * mw, svw - n * mv * mw);
        let determinant = a * c - b * b;
        if determinant < 0.5 {
            return None;
        }
        let (du, dv) = ((c * d - b * e) / determinant, (a * e - b * d) / determinant);
        // n·p = 1 on the plane, so 1/z = n·ray.
        let focal = self.focal as f32;
        let ray = self.ray(u as f32, v as f32);
        let w = mw - du * mu - dv * mv;
        let (x, y) = (du * focal, dv * focal);
        let normal = Vec3::new(x, y, w - x * ray.x - y * ray.y);
        Some(-normal.normalize_or_zero())
    }

    fn measure_bounds(&mut self) {
        let mut bounds = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for (i, _) in self.mask.iter().enumerate().filter(|(_, m)| **m) {
            for (bound, at) in bounds.iter_mut().zip([i % self.width, i / self.width]) {
                *bound = [bound[0].min(at as f64 - 0.5), bound[1].max(at as f64 + 0.5)];
            }
        }
        self.bounds = bounds;
    }
}

/// Pitch and margin at which a grid around a box of these sides has at most `most` cells: the ordinary ones, or else a
/// smaller margin, and coarser cells where that is not enough (a line across the image).
fn bounded(mut pitch: f64, mut margin: f64, sides: [f64; 2], aspect: f64, most: f64) -> (f64, f64) {
    let cells = |pitch: f64, margin: f64| {
        let [width, height] = sides.map(|side| side + 2.0 * margin);
        width * height / (pitch * pitch * aspect)
    };
    let least = (0.05 * margin).max(3.0);
    while cells(pitch, margin) > most && margin > least {
        margin = (0.75 * margin).max(least);
    }
    if cells(pitch, margin) > most {
        pitch *= (cells(pitch, margin) / most).sqrt();
    }
    (pitch, margin)
}

/// The samples of a cell.
#[derive(Default)]
struct Sum {
    outline: f32,
    depth: f32,
    readings: f32,
    scene: f32,
    scene_readings: f32,
    outside: f32,
}

/// A column or row of samples.
struct Sample {
    /// The nearest column or row of the crop.
    nearest: usize,
    /// The distance to it, pixels.
    beyond: f32,
    is_in_image: bool,
}

impl Sample {
    fn new(observation: &CleanObservation, axis: usize, pixel: i64) -> Self {
        let size = [observation.width, observation.height][axis];
        let at = pixel - observation.origin[axis] as i64;
        let nearest = at.max(0).min(size as i64 - 1);
        let is_in_image = pixel >= 0 && (pixel as f64) < observation.image[axis];
        Self { nearest: nearest as usize, beyond: (at - nearest) as f32, is_in_image }
    }

    /// Whether the column or row is in the crop and in the image.
    fn is_inside(&self) -> bool {
        self.beyond == 0.0 && self.is_in_image
    }
}

impl Sum {
    fn add(&mut self, observation: &CleanObservation, row: &Sample, column: &Sample) {
        self.outside += f32::from(u8::from(!(row.is_in_image && column.is_in_image)));
        // Outside the crop: the distance at the nearest pixel of the crop, plus the distance to that pixel.
        let (du, dv) = (column.beyond, row.beyond);
        let i = row.nearest * observation.width + column.nearest;
        self.outline += observation.outline[i] + (du * du + dv * dv).sqrt();
        if du == 0.0 && dv == 0.0 {
            self.read(observation.depth[i], observation.scene[i]);
        }
    }

    /// The samples of a row that are inside the crop.
    #[inline(always)]
    fn add_inside(&mut self, observation: &CleanObservation, row: &Sample, columns: &[Sample]) {
        let start = row.nearest * observation.width;
        let row = start..start + observation.width;
        let [outline, depth, scene] =
            [&observation.outline[row.clone()], &observation.depth[row.clone()], &observation.scene[row]];
        for Sample { nearest, .. } in columns {
            self.outline += outline[*nearest];
            self.read(depth[*nearest], scene[*nearest]);
        }
    }

    #[inline(always)]
    fn read(&mut self, depth: f32, scene: f32) {
        // Adding 0 changes nothing, and takes no branch.
        self.depth += if depth > 0.0 { depth } else { 0.0 };
        self.readings += if depth > 0.0 { 1.0 } else { 0.0 };
        self.scene += if scene > 0.0 { scene } else { 0.0 };
        self.scene_readings += if scene > 0.0 { 1.0 } else { 0.0 };
    }
}
