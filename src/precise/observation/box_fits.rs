//! Anchors: where an occluder or the image border cuts the mask, so that the mesh may extend beyond it.

use super::grid::CropGrid;
use crate::geometry::order::median;

/// Minimum share of the mask's outline that is cut before larger sizes are tried.
const MIN_CUT: f64 = 0.025;
/// Minimum share of the cut on a side for the mesh to extend beyond it.
const MIN_SIDE: f64 = 0.2;
/// A cut closer to the centre than this fraction of half the box belongs to no side.
const SIDE: f64 = 0.45;
/// Relative sizes tried if the mask is cut.
const ZOOMS: [f64; 2] = [1.25, 1.6];

/// A size relative to the box of the mask, and the direction, −1 to 1, in which the mesh extends beyond it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoxFit {
    /// The axis whose side of the box determines the size: 0 for columns, 1 for rows, `None` for both.
    pub along: Option<usize>,
    /// Relative size.
    pub zoom: f64,
    /// Direction, along columns and rows.
    pub towards: [f64; 2],
}

impl BoxFit {
    /// The unchanged box of the mask.
    pub const IDENTITY: Self = Self { along: None, zoom: 1.0, towards: [0.0; 2] };
}

/// Number of hypotheses, the first ones, by which the mask shows all of the object.
pub const UNCUT: usize = 2;

/// The hypotheses for a grid: the unchanged box, a slightly larger one and, if it is cut, boxes extended towards the
/// cut.
pub fn box_fits(grid: &CropGrid) -> Vec<BoxFit> {
    let plain = |zoom| BoxFit { zoom, ..BoxFit::IDENTITY };
    let mut box_fits = vec![plain(1.0), plain(1.12)];
    let sides = cut_sides(grid);
    if sides.is_empty() {
        return box_fits;
    }
    // A cut along one axis leaves both sides along the other axis.
    for axis in [0, 1] {
        if sides.iter().all(|side| side[axis] == 0.0) {
            box_fits.extend(sides.iter().map(|&towards| BoxFit { along: Some(axis), towards, ..BoxFit::IDENTITY }));
        }
    }
    for zoom in ZOOMS {
        box_fits.push(plain(zoom));
        box_fits.extend(sides.iter().map(|&towards| BoxFit { zoom, towards, ..BoxFit::IDENTITY }));
        let (across, along): (Vec<[f64; 2]>, Vec<_>) = sides.iter().partition(|s| s[0] != 0.0);
        for a in &across {
            box_fits.extend(along.iter().map(|b| BoxFit { zoom, towards: [a[0], b[1]], ..BoxFit::IDENTITY }));
        }
    }
    box_fits
}

/// The sides of the mask's box on which it is cut; none if the cut is too small.
fn cut_sides(grid: &CropGrid) -> Vec<[f64; 2]> {
    let depths = grid.depth.iter().copied().filter(|z| *z > 0.0);
    let Some(depth) = median(depths).map(f64::from) else { return Vec::new() };
    let [[left, right], [top, bottom]] = grid.bounds;
    let tolerance = (0.01 * depth + 0.04 * (right - left) * depth / grid.focal) as f32;
    let (mut ring, mut cut) = (0, 0);
    let mut counts = [0; 4];
    for v in 0..grid.height {
        for u in 0..grid.width {
            let i = v * grid.width + u;
            if grid.mask[i] || grid.outline[i] > 2.0 {
                continue;
            }
            ring += 1;
            let object = deepest_around(grid, u, v);
            // Depth maps often have a gap in front of an occluder's edge.
            let scene = if grid.scene[i] > 0.0 { grid.scene[i] } else { nearest_around(grid, u, v) };
            if !(scene > 0.0 && object > 0.0 && scene < object - tolerance) {
                continue;
            }
            cut += 1;
            let x = (u as f64 - 0.5 * (left + right)) / (0.5 * (right - left) + 1.0);
            let y = (v as f64 - 0.5 * (top + bottom)) / (0.5 * (bottom - top) + 1.0);
            for (count, at) in counts.iter_mut().zip([x, -x, y, -y]) {
                *count += usize::from(at > SIDE);
            }
        }
    }
    if (cut as f64) < MIN_CUT * f64::from(ring.max(1)) {
        return Vec::new();
    }
    let directions = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
    let large = |count: usize| count as f64 > MIN_SIDE * cut as f64;
    directions.into_iter().zip(counts).filter(|(_, count)| large(*count)).map(|(direction, _)| direction).collect()
}

/// The largest depth of the object within two cells; 0 if there is none.
fn deepest_around(grid: &CropGrid, u: usize, v: usize) -> f32 {
    cells_around(grid, u, v, 2).map(|i| grid.depth[i]).fold(0.0, f32::max)
}

/// The smallest depth outside the mask within three cells; 0 if there is none.
fn nearest_around(grid: &CropGrid, u: usize, v: usize) -> f32 {
    let outside = cells_around(grid, u, v, 3).filter(|&i| !grid.mask[i] && grid.scene[i] > 0.0);
    outside.map(|i| grid.scene[i]).reduce(f32::min).unwrap_or(0.0)
}

fn cells_around(grid: &CropGrid, u: usize, v: usize, reach: usize) -> impl Iterator<Item = usize> {
    let rows = v.saturating_sub(reach)..=(v + reach).min(grid.height - 1);
    let columns = u.saturating_sub(reach)..=(u + reach).min(grid.width - 1);
    let width = grid.width;
    rows.flat_map(move |y| columns.clone().map(move |x| y * width + x))
}
