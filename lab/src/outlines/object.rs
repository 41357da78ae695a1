//! The outlines of one object.

use super::ray::{Depths, Ray, Rays};
use super::silhouette::Silhouette;
use super::view::OutlineView;
use crate::prelude::*;
use sim3align_geometry::order::{median, quantile};

/// Pixels around the object that are looked at, of an image 640 wide.
const MARGIN: f64 = 18.0;
/// Least distance of the interior from the outline.
const INTERIOR: f64 = 4.0;
/// Least rays of a value.
const LEAST_RAYS: usize = 12;
/// Least step from the object to the background, as a share of the object's diagonal, and in standard deviations of the
/// depth.
const STEP: [f64; 2] = [0.08, 10.0];
/// The same for occluders.
const NEARER: [f64; 2] = [0.05, 6.0];
/// Least eigenvalue of the mean of n·nᵀ, with 1 for the offset: whether rays tell a shift from an offset.
const LEAST_SPREAD: f64 = 0.02;

/// Offsets of one kind of outline from the true one, in pixels of an image 640 wide.
#[derive(Debug, Clone, Copy)]
pub struct Offsets {
    /// Number of rays.
    pub rays: usize,
    /// Median; positive outwards.
    pub median: f64,
    /// Median absolute deviation.
    pub spread: f64,
    /// The shift that explains most of the offsets, where the directions of the rays determine it.
    pub shift: Option<[f64; 2]>,
}

/// What the depth shows of an object.
#[derive(Debug, Clone, Copy)]
pub struct DepthQuality {
    /// Median distance, metres.
    pub distance_m: f64,
    /// Robust standard deviation of measured less true depth inside, metres.
    pub noise_m: f64,
    /// The same of neighbouring pixels' differences.
    pub grain_m: f64,
}

/// The outlines of an object.
#[derive(Debug, Clone)]
pub struct ObjectOutlines {
    /// See [`OutlineView`].
    pub name: String,
    /// See [`OutlineView`].
    pub group: String,
    /// Rays whose mask outline is known, as a share of all.
    pub masked: f64,
    /// The mask's outline.
    pub mask: Option<Offsets>,
    /// The last readings of the object.
    pub depth: Option<Offsets>,
    /// The same relative to the mask's outline: free of errors of the true pose.
    pub depth_from_mask: Option<Offsets>,
    /// The photo's edges.
    pub photo: Option<Offsets>,
    /// Widths of the gaps without readings, pixels of an image 640 wide: median and 90th percentile.
    pub gap: Option<[f64; 2]>,
    /// Share of the readings near the edge that are neither object nor background.
    pub mixed: Option<f64>,
    /// What the depth shows inside.
    pub quality: DepthQuality,
}

impl ObjectOutlines {
    /// Measures a view; `None` if too little of the outline can be measured.
    pub fn of(view: &OutlineView) -> Option<Self> {
        let (width, height) = (view.depth.width(), view.depth.height());
        let margin = (MARGIN * width as f64 / 640.0) as usize;
        let silhouette = Silhouette::of(&view.mesh, &view.camera_from_mesh, &view.camera, [width, height], margin)?;
        let (quality, bias) = quality(view, &silhouette)?;
        let diagonal = f64::from(Bounds::of(view.mesh.positions())?.diagonal()) * view.camera_from_mesh.scale;
        let limit = |[share, deviations]: [f64; 2]| (share * diagonal).max(deviations * quality.noise_m);
        let depths = Depths { bias, noise: quality.noise_m, step: limit(STEP), nearer: limit(NEARER) };
        let rays = Rays { view, silhouette: &silhouette, depths };
        let rays: Vec<Ray> = silhouette.points().into_iter().filter_map(|point| rays.ray(point)).collect();
        if rays.len() < LEAST_RAYS {
            return None;
        }
        let edges = || rays.iter().filter_map(|ray| ray.depth);
        let gaps = |share: f64| quantile(edges().map(|edge| edge.gap as f32), share).map(f64::from);
        let (mixed, readings) = edges().fold((0, 0), |(a, b), edge| (a + edge.mixed, b + edge.readings));
        let depth = Offsets::of(&rays, |ray| ray.depth.map(|edge| edge.offset));
        Some(Self {
            name: view.name.clone(),
            group: view.group.clone(),
            masked: rays.iter().filter(|ray| ray.mask.is_some()).count() as f64 / rays.len() as f64,
            mask: Offsets::of(&rays, |ray| ray.mask),
            depth_from_mask: Offsets::of(&rays, |ray| Some(ray.depth?.offset - ray.mask?)),
            photo: Offsets::of(&rays, |ray| ray.photo),
            gap: depth.and_then(|_| Some([gaps(0.5)?, gaps(0.9)?])),
            mixed: depth.map(|_| f64::from(mixed as u32) / f64::from(readings.max(1) as u32)),
            depth,
            quality,
        })
    }
}

impl Offsets {
    fn of(rays: &[Ray], offset: impl Fn(&Ray) -> Option<f64>) -> Option<Self> {
        let values: Vec<(Vector3<f64>, f64)> =
            rays.iter().filter_map(|ray| Some((Vector3::new(ray.normal.x, ray.normal.y, 1.0), offset(ray)?))).collect();
        if values.len() < LEAST_RAYS {
            return None;
        }
        let middle = f64::from(median(values.iter().map(|(_, x)| *x as f32))?);
        let spread = f64::from(median(values.iter().map(|(_, x)| (x - middle).abs() as f32))?);
        Some(Self { rays: values.len(), median: middle, spread, shift: shift(&values) })
    }
}

/// The shift of an outline, by least squares over the better four fifths of the rays, three times.
fn shift(values: &[(Vector3<f64>, f64)]) -> Option<[f64; 2]> {
    let mut found = Vector3::zeros();
    let mut kept: Vec<&(Vector3<f64>, f64)> = values.iter().collect();
    for _ in 0..3 {
        let count = kept.len() as f64;
        let normal: Matrix3<f64> = kept.iter().map(|(n, _)| n * n.transpose()).sum::<Matrix3<f64>>() / count;
        if normal.symmetric_eigenvalues().min() < LEAST_SPREAD {
            return None;
        }
        let right: Vector3<f64> = kept.iter().map(|(n, x)| n * *x).sum::<Vector3<f64>>() / count;
        found = normal.try_inverse()? * right;
        let error = |(n, x): &(Vector3<f64>, f64)| (x - n.dot(&found)).abs();
        let most = f64::from(quantile(values.iter().map(|value| error(value) as f32), 0.8)?);
        kept = values.iter().filter(|value| error(value) <= most + 1e-6).collect();
    }
    Some([found.x, found.y])
}

/// Noise of the depth inside the object, and measured less true depth.
fn quality(view: &OutlineView, silhouette: &Silhouette) -> Option<(DepthQuality, f64)> {
    let inside = INTERIOR * view.depth.width() as f64 / 640.0;
    let residual = |u: usize, v: usize| {
        let z = f64::from(view.depth.get(u, v)?);
        let is_masked = view.mask.get(u, v).is_some_and(|m| m != 0);
        let truth = silhouette.depth(DVec2::new(u as f64, v as f64))?;
        (z > 0.0 && is_masked).then_some([z - truth, truth])
    };
    let all: Vec<[f64; 2]> = silhouette.interior(inside).filter_map(|[u, v]| residual(u, v)).collect();
    let bias = f64::from(median(all.iter().map(|[r, _]| *r as f32))?);
    let noise = 1.4826 * f64::from(median(all.iter().map(|[r, _]| (r - bias).abs() as f32))?);
    let distance = f64::from(median(all.iter().map(|[_, z]| *z as f32))?);
    let mut steps: Vec<f64> = silhouette
        .interior(inside)
        .filter_map(|[u, v]| Some((residual(u, v)?[0] - residual(u + 1, v)?[0]).powi(2)))
        .collect();
    // Without the largest tenth, which edges within the object make; of normal noise, what is left has .615 of the variance.
    steps.sort_unstable_by(f64::total_cmp);
    steps.truncate(steps.len() * 9 / 10);
    let mean = steps.iter().sum::<f64>() / steps.len().max(1) as f64;
    let grain = (mean / 2.0 / 0.615).sqrt();
    Some((DepthQuality { distance_m: distance, noise_m: noise, grain_m: grain }, bias))
}
