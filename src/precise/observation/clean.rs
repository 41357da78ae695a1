//! Clean: selects the pixels of the observation, and the depths, that reliably belong to the object.
//!
//! Masks have pinholes and stray islands, depth maps have flying pixels at discontinuities, and masks include
//! background by mistake. Doubtful pixels are excluded from the evidence.

use super::mask_boundary::{BoundaryImages, boundary_offset};
use super::ramp::ramp_width;
use super::thinning::Thinning;
use crate::evidence::observation::Observation;
use crate::geometry::components::{Component, components};
use crate::geometry::distance_transform::squared_distances;
use crate::geometry::image::{Mask, bounds_of};
use crate::geometry::order::{self, quantile};
use crate::geometry::pinhole::Pinhole;

/// Margin around the mask, relative to its longer side.
const MARGIN: f64 = 0.45;
/// Holes smaller than this fraction of the mask are errors of the mask and are filled.
const PIN_HOLE: f64 = 0.01;
/// Components of at least this size relative to the largest belong to the object, split by an occluder; smaller ones,
/// down to the second value, only if they are near.
const COMPONENT: f64 = 0.2;
const ISLAND: f64 = 0.04;
/// Maximum distance of a small component: relative to the longer side of the mask, and pixels more.
const ISLAND_REACH: [f64; 2] = [0.25, 4.0];
/// Maximum difference in depth between a component and the largest one, relative to the width of that: of a small
/// component, and of a large one, which a hand or a pole may have split from a long object.
const ISLAND_DEPTH: [f64; 2] = [1.0, 2.5];
/// Depth margin of an occluder: relative to the diagonal of the object, which generated meshes miss by some percent, and to
/// its distance, for the noise of the sensor.
const OCCLUDER: [f64; 2] = [0.02, 0.005];
/// Margin by which what other objects show is put nearer, relative to that of an occluder.
const OTHER_MARGIN: f64 = 1.5;
/// Widths of a rim without readings that count, pixels: relative to the square root of the mask's area, for the blur of depth
/// networks, whose inputs are about 400 pixels wide, and the least and the most of it; then one pixel.
const RIM_WIDTH: f64 = 0.011;
const RIM_WIDTHS: [f64; 2] = [2.0, 4.0];
/// Width of a rim without ramps, relative to theirs: half of a ramp is inside the outline, and those of a blur have no end.
const RAMP_SHARE: f64 = 0.6;
/// Share of the mask that must remain without each of these rims, and the number of readings.
const INNER_SHARES: [f64; 2] = [0.3, 0.2];
const INNER_READINGS: usize = 32;
/// Depth of the window with the most readings, relative to the width of the object, and its least relative depth.
const WINDOW_DEPTH: f64 = 1.2;
const LEAST_WINDOW: f64 = 0.1;
/// Deviation from the median depth beyond which a reading is not of the object: relative to its width, or in robust standard
/// deviations of its depths, whichever is more.
const FAR: [f64; 2] = [WINDOW_DEPTH, 5.0];
/// Range of the depths around a reading from which on it lies on an edge, where sensors mix near and far: relative to the
/// width of the object, and to its distance. If less than this share of the readings is left without them, they stay.
const EDGE: [f64; 2] = [0.06, 0.006];
const SMOOTH_SHARE: [usize; 2] = [3, 10];
/// Standard deviations in a median absolute deviation of a normal distribution.
const MAD: f64 = 1.4826;
/// Share of the points excluded at either end of each axis.
const TAIL: f64 = 0.005;
/// Minimum depth step behind the object for the depth map to show the outline: relative to the width of the object,
/// which excludes the slope of rounded edges, and relative to its depth.
const RIM_JUMP: [f64; 2] = [0.15, 0.01];
/// Number of depths used to find the densest window.
const WINDOW_SAMPLES: usize = 4096;

/// The observation around its mask, without doubtful pixels, and thinned out where it has more of them than any grid uses.
/// Pixels are those that remain.
#[derive(Debug, Clone)]
pub struct CleanObservation {
    /// The camera of the whole image.
    pub camera: Pinhole,
    /// Position of the first pixel of the crop in the image.
    pub origin: [usize; 2],
    /// Width of the crop in pixels.
    pub width: usize,
    /// Height of the crop in pixels.
    pub height: usize,
    /// Size of the whole image in pixels, a fraction where that is not a multiple of the thinning.
    pub image: [f64; 2],
    /// Signed distance to the outline of the object, pixels, negative inside.
    pub outline: Vec<f32>,
    /// Outward shift of the outline of the mask, pixels (see [`boundary_offset`]).
    pub boundary_offset: f64,
    /// Depth of the object, metres; 0 elsewhere.
    pub depth: Vec<f32>,
    /// All readings, metres; 0 without a reading.
    pub scene: Vec<f32>,
    /// Box of the mask in the image: first and last column, first and last row.
    pub bounds: [[f64; 2]; 2],
    /// Number of mask pixels.
    pub pixels: usize,
    /// Median depth of the object, metres.
    pub median_m: f64,
    /// Diagonal of the bounding box of the object's points without outliers, metres.
    pub diagonal_m: f64,
}

impl CleanObservation {
    /// Cleans the mask and the depth map.
    pub fn new(observation: &Observation) -> Self {
        let mut crop = Crop::new(observation);
        let others = observation.others().map(|others| crop.cut(others));
        crop.close_pin_holes(others.as_deref());
        crop.drop_islands(others.as_deref());
        let mut clean = crop.into_clean();
        let extent_m = (0..2).map(|axis| clean.bounds[axis][1] - clean.bounds[axis][0]).fold(0.0, f64::max)
            / clean.camera.fx
            * clean.median_m;
        let CleanObservation { width, height, outline, scene, .. } = &clean;
        let images = BoundaryImages { width: *width, height: *height, outline, scene };
        let offset = boundary_offset(images, RIM_JUMP[0] * extent_m + RIM_JUMP[1] * clean.median_m);
        clean.move_boundary(offset);
        if let Some(others) = others {
            clean.put_behind(&others);
        }
        clean
    }

    /// Depth margin at which the scene hides the mesh, metres.
    pub fn occluder_m(&self) -> f64 {
        OCCLUDER[0] * self.diagonal_m + OCCLUDER[1] * self.median_m
    }

    /// Lets what other objects show hide the mesh without the margin that free space needs: there, a surface at the
    /// same depth is theirs, and the mesh is free space only if it is clearly nearer.
    fn put_behind(&mut self, others: &[bool]) {
        let nearer = (OTHER_MARGIN * self.occluder_m()) as f32;
        for ((scene, other), outline) in self.scene.iter_mut().zip(others).zip(&self.outline) {
            if *other && *outline > 0.0 && *scene > 0.0 {
                *scene = (*scene - nearer).max(1e-3 * *scene);
            }
        }
    }

    /// Moves the outline outwards.
    fn move_boundary(&mut self, offset: f64) {
        self.boundary_offset = offset;
        self.outline.iter_mut().for_each(|d| *d -= offset as f32);
        let inside = |d: &&f32| **d < 0.0;
        self.pixels = self.outline.iter().filter(inside).count().max(1);
        for bounds in &mut self.bounds {
            bounds[0] -= offset;
            bounds[1] += offset;
        }
    }
}

/// The raw images around the mask.
struct Crop {
    camera: Pinhole,
    thinning: Thinning,
    image: [f64; 2],
    origin: [usize; 2],
    width: usize,
    height: usize,
    mask: Vec<bool>,
    scene: Vec<f32>,
}

impl Crop {
    fn new(observation: &Observation) -> Self {
        let (mask, depth) = (observation.mask(), observation.depth());
        let size = [mask.width(), mask.height()];
        let bounds = observation.bounds();
        let margin = (MARGIN * longer_side(&bounds)) as usize + 4;
        let origin = bounds.map(|[low, _]| low.saturating_sub(margin));
        let end = [0, 1].map(|axis| (bounds[axis][1] + margin + 1).min(size[axis]));
        let thinning = Thinning::of(observation, (end[0] - origin[0]) * (end[1] - origin[1]));
        let end = [0, 1].map(|axis| end[axis].div_ceil(thinning.step).min(thinning.count(size[axis])));
        let origin = origin.map(|first| first / thinning.step);
        let [width, height] = [0, 1].map(|axis| end[axis].saturating_sub(origin[axis]));
        let (mut inside, mut scene) = (Vec::with_capacity(width * height), Vec::with_capacity(width * height));
        for v in origin[1]..end[1] {
            let row = thinning.at(v) * size[0];
            let part = row + thinning.at(origin[0])..row + size[0];
            inside.extend(mask.data()[part.clone()].iter().step_by(thinning.step).take(width).map(|m| *m != 0));
            scene.extend(depth.data()[part].iter().step_by(thinning.step).take(width));
        }
        Self {
            camera: thinning.camera(&observation.camera()),
            thinning,
            image: size.map(|side| side as f64 / thinning.step as f64),
            origin,
            width,
            height,
            mask: inside,
            scene,
        }
    }

    fn count(&self) -> usize {
        self.mask.iter().filter(|set| **set).count()
    }

    /// Another mask of the image, without the pixels of this one.
    fn cut(&self, others: &Mask) -> Vec<bool> {
        let pixel = |i: usize| {
            let (u, v) = (i % self.width + self.origin[0], i / self.width + self.origin[1]);
            !self.mask[i] && others.get(self.thinning.at(u), self.thinning.at(v)).is_some_and(|other| other != 0)
        };
        (0..self.mask.len()).map(pixel).collect()
    }

    /// Fills small holes, other than those that show `others`.
    fn close_pin_holes(&mut self, others: Option<&[bool]>) {
        let limit = (PIN_HOLE * self.count() as f64) as usize;
        let outside: Vec<bool> = self.mask.iter().map(|set| !set).collect();
        for component in components(&outside, self.width, self.height) {
            let shows_other = || others.is_some_and(|others| component.pixels().any(|i| others[i]));
            if component.count() <= limit.max(4) && !component.touches_border && !shows_other() {
                component.set(&mut self.mask);
            }
        }
    }

    /// Keeps the components that may belong to one object. Those that only `others` separate are near each other.
    fn drop_islands(&mut self, others: Option<&[bool]>) {
        let components = components(&self.mask, self.width, self.height);
        if components.len() < 2 {
            return;
        }
        let median_depth = |c: &Component| {
            let depths = c.pixels().map(|i| self.scene[i]).filter(|z| *z > 0.0);
            quantile(depths, 0.5).map(f64::from)
        };
        let area = |c: &Component| c.count() as f64;
        let Some(largest) = components.iter().max_by_key(|c| c.count()) else { return };
        let is_large = |c: &Component| area(c) >= COMPONENT * area(largest);
        let main = self.mask_of(components.iter().filter(|c| is_large(c)));
        let extent_px = longer_side(&bounds_of(&main, self.width, |set| *set));
        let largest_m = median_depth(largest);
        let extent_m = largest_m.map_or(f64::INFINITY, |z| extent_px * z / self.camera.fx);
        let reach = ISLAND_REACH[0] * extent_px + ISLAND_REACH[1];
        let distances = squared_distances(&main, self.width, self.height);
        let bridged = others.map(|others| self.bridged(&main, others));
        let kept = components.iter().filter(|c| {
            let large = is_large(c);
            let bridged = || bridged.as_ref().is_some_and(|b| c.pixels().any(|i| b[i]));
            let near = || bridged() || c.pixels().any(|i| f64::from(distances[i]) <= reach * reach);
            let apart_m = median_depth(c).zip(largest_m).map_or(0.0, |(a, b)| (a - b).abs());
            let at_depth = apart_m <= ISLAND_DEPTH[usize::from(large)] * extent_m;
            at_depth && (large || (area(c) >= ISLAND * area(largest) && near()))
        });
        self.mask = self.mask_of(kept);
    }

    /// The pixels that are connected with `main` through the mask and `others`.
    fn bridged(&self, main: &[bool], others: &[bool]) -> Vec<bool> {
        let joined: Vec<bool> = self.mask.iter().zip(others).map(|(mask, other)| *mask || *other).collect();
        let components = components(&joined, self.width, self.height);
        self.mask_of(components.iter().filter(|c| c.pixels().any(|i| main[i])))
    }

    /// The mask of only these components.
    fn mask_of<'a>(&self, components: impl Iterator<Item = &'a Component>) -> Vec<bool> {
        let mut mask = vec![false; self.mask.len()];
        components.for_each(|component| component.set(&mut mask));
        mask
    }

    fn into_clean(self) -> CleanObservation {
        let pixels: Vec<usize> = (0..self.mask.len()).filter(|i| self.mask[*i]).collect();
        let bounds = bounds_of(&self.mask, self.width, |set| *set);
        let extent_px = longer_side(&bounds);
        let outline = signed_distance(&self.mask, self.width, self.height);
        let mut inner = self.inner_readings(&pixels, &outline, 0.0);
        let (median, spread) = self.densest_window(&inner, extent_px);
        let extent_m = extent_px / self.camera.fx * median;
        let images = BoundaryImages { width: self.width, height: self.height, outline: &outline, scene: &self.scene };
        let ramp = ramp_width(images, pixels.len(), [extent_m, median]);
        if ramp > 0.0 {
            inner = self.inner_readings(&pixels, &outline, RAMP_SHARE * ramp);
        }
        let reach = (FAR[0] * extent_m).max(FAR[1] * spread);
        let is_near = |i: &usize| (f64::from(self.scene[*i]) - median).abs() < reach;
        let near: Vec<usize> = inner.into_iter().filter(is_near).collect();
        let jump = (EDGE[0] * extent_m + EDGE[1] * median) as f32;
        let smooth: Vec<usize> = near.iter().copied().filter(|i| self.range_around(*i) <= jump).collect();
        let trusted = if SMOOTH_SHARE[1] * smooth.len() > SMOOTH_SHARE[0] * near.len() { smooth } else { near };
        let mut depth = vec![0.0; self.scene.len()];
        trusted.iter().for_each(|&i| depth[i] = self.scene[i]);
        let median_m = quantile(trusted.iter().map(|&i| self.scene[i]), 0.5).map_or(median, f64::from);
        let diagonal_m = self.diagonal(&trusted).max(1e-3 * median_m);
        CleanObservation {
            camera: self.camera,
            origin: self.origin,
            width: self.width,
            height: self.height,
            image: self.image,
            bounds: [0, 1].map(|axis| bounds[axis].map(|x| (x + self.origin[axis]) as f64)),
            outline,
            boundary_offset: 0.0,
            depth,
            scene: self.scene,
            pixels: pixels.len(),
            median_m,
            diagonal_m,
        }
    }

    /// Those of the mask's pixels that have a reading, excluding its rim, which is at least this wide, if enough remain.
    fn inner_readings(&self, pixels: &[usize], outline: &[f32], least: f64) -> Vec<usize> {
        let count = pixels.len() as f64;
        let wide = (RIM_WIDTH * count.sqrt()).clamp(RIM_WIDTHS[0], RIM_WIDTHS[1]);
        let [widest, wide] = [wide.max(least), wide].map(|rim| (rim, INNER_SHARES[0]));
        for (rim, share) in [widest, wide, (1.0, INNER_SHARES[1]), (0.0, 0.0)] {
            let inner = || pixels.iter().copied().filter(|i| 0.5 - f64::from(outline[*i]) > rim);
            let readings: Vec<usize> = inner().filter(|i| self.scene[*i] > 0.0).collect();
            let enough = inner().count() as f64 >= share * count;
            if (enough && readings.len() >= INNER_READINGS) || rim == 0.0 {
                return readings;
            }
        }
        Vec::new()
    }

    /// Median depth and median absolute deviation within the depth window with the most readings, which is as deep as
    /// the object is wide. A plain median would be biased by background inside the mask.
    fn densest_window(&self, inner: &[usize], extent_px: f64) -> (f64, f64) {
        let step = inner.len().div_ceil(WINDOW_SAMPLES).max(1);
        let mut keys: Vec<u64> = inner.iter().step_by(step).map(|&i| order::pack(self.scene[i], 0)).collect();
        order::sort(&mut keys);
        let depths: Vec<f32> = keys.into_iter().map(order::value_of).collect();
        let deep = 1.0 + (WINDOW_DEPTH * extent_px / self.camera.fx).max(LEAST_WINDOW) as f32;
        let (mut best, mut end) = (0..0, 0);
        for (start, &z) in depths.iter().enumerate() {
            while end < depths.len() && depths[end] <= z * deep {
                end += 1;
            }
            if end - start > best.len() {
                best = start..end;
            }
        }
        let window = &depths[best];
        let median = window.get(window.len() / 2).copied().unwrap_or(1.0);
        let spread = quantile(window.iter().map(|z| (z - median).abs()), 0.5).unwrap_or(0.0);
        (f64::from(median), MAD * f64::from(spread))
    }

    /// Range of the depths of a pixel and its eight neighbours.
    fn range_around(&self, i: usize) -> f32 {
        let (u, v) = (i % self.width, i / self.width);
        let (mut low, mut high) = (f32::INFINITY, 0.0f32);
        let columns = u.saturating_sub(1)..(u + 2).min(self.width);
        for y in v.saturating_sub(1)..(v + 2).min(self.height) {
            for &z in &self.scene[y * self.width..][columns.clone()] {
                low = if z > 0.0 && z < low { z } else { low };
                high = if z > high { z } else { high };
            }
        }
        high - low
    }

    /// Diagonal of the box that excludes half a percent of the points at either end of each axis.
    fn diagonal(&self, readings: &[usize]) -> f64 {
        let step = readings.len().div_ceil(WINDOW_SAMPLES).max(1);
        let points: Vec<glam::Vec3> = (readings.iter().step_by(step))
            .map(|&i| {
                let (u, v) = (i % self.width + self.origin[0], i / self.width + self.origin[1]);
                self.camera.back_project(u as f64, v as f64, f64::from(self.scene[i]))
            })
            .collect();
        let side = |axis: usize| {
            let at = |q| quantile(points.iter().map(|p| p[axis]), q).map_or(0.0, f64::from);
            at(1.0 - TAIL) - at(TAIL)
        };
        (0..3).map(|axis| side(axis) * side(axis)).sum::<f64>().sqrt()
    }
}

/// Signed distance of each pixel centre to the outline of the mask, pixels, negative inside.
fn signed_distance(mask: &[bool], width: usize, height: usize) -> Vec<f32> {
    let outside: Vec<bool> = mask.iter().map(|set| !set).collect();
    let to_mask = squared_distances(mask, width, height);
    let to_outside = squared_distances(&outside, width, height);
    let distance = |(set, (to_mask, to_outside)): (&bool, (&u32, &u32))| {
        if *set { 0.5 - (*to_outside as f32).sqrt() } else { (*to_mask as f32).sqrt() - 0.5 }
    };
    mask.iter().zip(to_mask.iter().zip(&to_outside)).map(distance).collect()
}

fn longer_side(bounds: &[[usize; 2]; 2]) -> f64 {
    bounds.iter().map(|[low, high]| high - low).max().unwrap_or(0) as f64
}
