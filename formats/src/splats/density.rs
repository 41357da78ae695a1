//! The density of Gaussians on a lattice, and the solid that it surrounds.

use core::ops::Range;

use glam::{Mat3, Vec3};

use super::lattice::{Lattice, clear_light_regions, take_region};
use super::region::{Blob, FLOATER, LEVEL, REACH, WIDENING};

/// Density of a surface as a share of the mean in the centres of the Gaussians, and at most: a Gaussian that noise has moved
/// away from a dense surface is then no part of it, but a sparse surface is one.
const LEVEL_SHARE: f32 = 0.25;
const MAX_LEVEL: f32 = 1.5;

/// The quadratic form dᵀ·C⁻¹·d of a covariance that is widened by a standard deviation.
pub(super) fn widened_inverse(covariance: &[f32; 6], widening: f32) -> Mat3 {
    let [xx, xy, xz, yy, yz, zz] = *covariance;
    let more = widening * widening;
    let rows = [[xx + more, xy, xz], [xy, yy + more, yz], [xz, yz, zz + more]];
    Mat3::from_cols_array_2d(&rows).inverse()
}

/// The weight at a squared distance in standard deviations: 1 in the centre, 0 from `reach` on.
#[inline(always)]
pub(super) fn kernel(squared: f32, reach: f32) -> f32 {
    let left = 1.0 - squared / (reach * reach);
    if left > 0.0 { left * left } else { 0.0 }
}

/// The integers from `first` to `last` that are below `count`.
#[inline(always)]
fn nodes(first: f32, last: f32, count: usize) -> Range<usize> {
    first.ceil().max(0.0) as usize..((last.floor() + 1.0).max(0.0) as usize).min(count)
}

/// Calls `visit` for the nodes with dᵀ·`form`·d up to the square of `reach`, d being the vector from the centre, with the
/// value.
#[inline(always)]
pub(super) fn each_node(lattice: &Lattice, center: Vec3, form: &Mat3, reach: f32, mut visit: impl FnMut(usize, f32)) {
    let [across, down, deep] = lattice.size;
    let [a, b, c] = [form.x_axis.x, form.x_axis.y, form.x_axis.z];
    let (yy, yz, zz) = (form.y_axis.y, form.y_axis.z, form.z_axis.z);
    // The largest z, and y, of the ellipsoid.
    let planes = form.inverse();
    let range = |center: f32, variance: f32, count: usize| {
        let half = reach * variance.max(0.0).sqrt();
        nodes(center - half, center + half, count)
    };
    for k in range(center.z, planes.z_axis.z, deep) {
        let z = k as f32 - center.z;
        for j in range(center.y, planes.y_axis.y, down) {
            let y = j as f32 - center.y;
            // a·x² + 2·half·x + rest = reach².
            let half = b * y + c * z;
            let rest = yy * y * y + 2.0 * yz * y * z + zz * z * z;
            let root = half * half - a * (rest - reach * reach);
            if root < 0.0 {
                continue;
            }
            let root = root.sqrt();
            let (first, last) = (center.x + (-half - root) / a, center.x + (-half + root) / a);
            let row = (k * down + j) * across;
            for i in nodes(first, last, across) {
                let x = i as f32 - center.x;
                visit(row + i, (a * x + 2.0 * half) * x + rest);
            }
        }
    }
}

/// The nodes inside a closed surface.
#[derive(Debug)]
pub(super) struct Solid {
    /// Whether each node is inside.
    pub is_inside: Vec<bool>,
    /// Density above that of the surface: above 0 inside, at most 0 outside.
    pub excess: Vec<f32>,
}

impl Solid {
    /// The Gaussians and all that they hide from outside. Holes of two nodes or less are closed, floaters dropped.
    pub fn of(lattice: &Lattice, blobs: &[Blob]) -> Self {
        let mut density = vec![0.0; lattice.len()];
        for blob in blobs {
            let form = widened_inverse(&blob.covariance, WIDENING);
            each_node(lattice, blob.center, &form, REACH, |node, squared| {
                density[node] += blob.opacity * kernel(squared, REACH);
            });
        }
        let in_centers: f64 = blobs.iter().map(|blob| f64::from(density[lattice.nearest(blob.center)])).sum();
        let level = (LEVEL_SHARE * (in_centers / blobs.len() as f64) as f32).clamp(LEVEL, MAX_LEVEL);
        let occupied: Vec<bool> = density.iter().map(|density| *density >= level).collect();
        let mut is_inside = outside(lattice, &occupied);
        is_inside.iter_mut().for_each(|inside| *inside = !*inside);
        clear_light_regions(&mut is_inside, &density, &lattice.corners(), FLOATER);
        // Between nodes of the surface, the density places it. At the seams of closed holes and of dropped floaters, it
        // is next to the node outside.
        let excess = |(density, inside): (f32, &bool)| {
            let excess = density - level;
            if *inside { excess.max(0.01 * level) } else { excess.min(-0.01 * level) }
        };
        let excess = density.into_iter().zip(&is_inside).map(excess).collect();
        Self { is_inside, excess }
    }
}

/// The nodes that are reached from the border of the lattice by a cube of three nodes that passes no occupied one.
fn outside(lattice: &Lattice, occupied: &[bool]) -> Vec<bool> {
    let mut free: Vec<bool> = lattice.dilated(occupied).into_iter().map(|blocked| !blocked).collect();
    // The outermost layer ends the search: beyond it, indices are those of other rows.
    let [across, down, deep] = lattice.size;
    for (node, free) in free.iter_mut().enumerate() {
        let [i, j, k] = [node % across, node / across % down, node / across / down];
        if [i, j, k].contains(&0) || i == across - 1 || j == down - 1 || k == deep - 1 {
            *free = false;
        }
    }
    let corner = lattice.steps().iter().sum();
    let mut reached = vec![false; occupied.len()];
    take_region(&mut free, corner, &lattice.faces()).into_iter().for_each(|node| reached[node as usize] = true);
    let mut reached = lattice.dilated(&reached);
    reached.iter_mut().zip(occupied).for_each(|(reached, occupied)| *reached &= !occupied);
    reached
}
