//! Comparison of two masks of the same size: overlap, boundary, centroid.

use crate::geometry::distance_transform::within;
use crate::geometry::image::Mask;

/// Maximum distance of matching boundary pixels, relative to the image diagonal (DAVIS).
pub const BOUNDARY_TOLERANCE: f64 = 0.008;

/// Intersection over union, 0 to 1; 0 if both are empty.
pub fn iou(a: &Mask, b: &Mask) -> f64 {
    let (mut both, mut either) = (0u64, 0u64);
    for (a, b) in a.data().iter().zip(b.data()) {
        both += u64::from(*a != 0 && *b != 0);
        either += u64::from(*a != 0 || *b != 0);
    }
    if either == 0 { 0.0 } else { both as f64 / either as f64 }
}

/// Distance of the two masks' centroids in pixels; `None` if either is empty.
pub fn center_drift_px(a: &Mask, b: &Mask) -> Option<f64> {
    let ([ua, va], [ub, vb]) = (centroid(a)?, centroid(b)?);
    Some(((ua - ub) * (ua - ub) + (va - vb) * (va - vb)).sqrt())
}

/// The distance of matching boundary pixels in an image of this size, pixels: ⌈0.008 · image diagonal⌉.
pub fn boundary_tolerance_px(width: usize, height: usize) -> u32 {
    // In u64: the square of a long side overflows a 32-bit usize.
    let [w, h] = [width, height].map(|side| side as u64);
    (BOUNDARY_TOLERANCE * ((w * w + h * h) as f64).sqrt()).ceil() as u32
}

/// Boundary F-measure of DAVIS (Perazzi et al. 2016, §4.1, as the 2017 evaluation code computes it), 0 to 1.
///
/// Boundaries are one pixel wide (see [`boundary`]). Precision is the fraction of the boundary of b within `tolerance_px`
/// (see [`boundary_tolerance_px`]) of that of a, recall the fraction of the boundary of a within the same distance of
/// that of b, and F = 2PR/(P + R). The result is 0 if a mask is empty, 1 if both masks fill the image, and 0 if only
/// one does. Rows and columns that are empty in both masks may be left out, but for one beside each mask.
pub fn boundary_f(a: &Mask, b: &Mask, tolerance_px: u32) -> f64 {
    let empty = |mask: &Mask| mask.data().iter().all(|&m| m == 0);
    if empty(a) || empty(b) {
        return 0.0;
    }
    let outlines = [boundary(a), boundary(b)];
    let [counts_a, counts_b] = outlines.each_ref().map(|o| o.iter().filter(|set| **set).count());
    if counts_a == 0 || counts_b == 0 {
        return if counts_a == counts_b { 1.0 } else { 0.0 };
    }
    let matched = |outline: &[bool], other: &[bool]| {
        let near = within(tolerance_px, other, a.width(), a.height());
        outline.iter().zip(&near).filter(|(set, near)| **set && **near).count()
    };
    let precision = matched(&outlines[1], &outlines[0]) as f64 / counts_b as f64;
    let recall = matched(&outlines[0], &outlines[1]) as f64 / counts_a as f64;
    if precision + recall == 0.0 { 0.0 } else { 2.0 * precision * recall / (precision + recall) }
}

/// The boundary of a mask, one pixel wide: pixels that differ from their right, lower or lower right neighbour. The
/// image border is not part of the boundary.
pub fn boundary(mask: &Mask) -> Vec<bool> {
    let (width, height, data) = (mask.width(), mask.height(), mask.data());
    let mut outline = Vec::with_capacity(data.len());
    for v in 0..height {
        for u in 0..width {
            let set = |du: usize, dv: usize| data[(v + dv) * width + u + du] != 0;
            let (right, below) = (u + 1 < width, v + 1 < height);
            let differs = |du, dv| set(du, dv) != set(0, 0);
            outline.push((right && differs(1, 0)) || (below && differs(0, 1)) || (right && below && differs(1, 1)));
        }
    }
    outline
}

fn centroid(mask: &Mask) -> Option<[f64; 2]> {
    let (mut count, mut u_sum, mut v_sum) = (0u64, 0u64, 0u64);
    for (v, row) in mask.data().chunks_exact(mask.width()).enumerate() {
        for (u, _) in row.iter().enumerate().filter(|(_, m)| **m != 0) {
            count += 1;
            u_sum += u as u64;
            v_sum += v as u64;
        }
    }
    (count > 0).then(|| [u_sum as f64 / count as f64, v_sum as f64 / count as f64])
}
