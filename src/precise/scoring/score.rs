//! Score: how well a rendered pose explains mask, free space and depth.

use serde::{Deserialize, Serialize};
use wide::bytemuck::cast;
use wide::{f32x4, i32x4};

use crate::precise::drawing::lanes::{LANES, count, first, four, four_set, plus};
use crate::precise::drawing::render::{Canvas, Model};
use crate::precise::observation::grid::CropGrid;
use crate::report::ScoreTerms;

/// Score difference attributed to noise. In generated cases won by a flip, the true pose scores lower by about this
/// much.
pub const NOISE: f32 = 0.15;

/// Share of a silhouette outside the grid at which its cost would be infinite: a little above 1, so that it stays finite.
const LOST: f32 = 1.05;

/// Weights of the terms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weights {
    /// Overlap of mask and silhouette.
    pub overlap: f32,
    /// Depth inside the mask.
    pub depth: f32,
    /// Normals inside the mask.
    pub normals: f32,
    /// Outlines.
    pub outline: f32,
    /// Weight in the union of a silhouette cell behind an occluder: 0 is no cost, 1 the cost of free space.
    pub occluded: f32,
    /// Weight in the union of a silhouette cell where the depth map has no reading; see [`CropGrid::known`].
    pub unknown: f32,
    /// Share of the overlap in the factor of the score: 1 by default. The rest is the share of the depth readings that the
    /// mesh covers, which does not depend on the outline of the mask.
    pub silhouette: f32,
}

impl Default for Weights {
    fn default() -> Self {
        Self { overlap: 0.2, depth: 1.0, normals: 0.25, outline: 0.6, occluded: 0.15, unknown: 0.07, silhouette: 1.0 }
    }
}

impl Weights {
    /// The weights with which the depth counts alone.
    pub fn of_depth_alone(self) -> Self {
        Self { overlap: 0.0, outline: 0.0, silhouette: 0.0, ..self }
    }

    /// The factor of the agreement in a score.
    pub fn factor(&self, score: &Score, grid: &CropGrid) -> f32 {
        let covered = score.counts[0] / (grid.depth_cells as f32).max(1.0);
        self.silhouette * score.overlap + (1.0 - self.silhouette) * covered
    }

    /// The factor of the overlap in a score.
    pub fn agreement(&self, score: &Score) -> f32 {
        self.overlap + self.depth * score.depth + self.normals * score.normals + self.outline * score.outline
    }
}

/// Settings of the score at one resolution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scoring {
    /// Weights of the terms.
    pub weights: Weights,
    /// Depth error that halves the credit of a cell, metres.
    pub depth_m: f32,
    /// Depth margin at which the scene occludes the mesh, metres.
    pub occluder_m: f32,
    /// Outline distance that halves the credit of a cell, cells.
    pub outline_cells: f32,
}

/// The depth map outside the mask, where the mesh is rendered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Background {
    /// The camera sees through the mesh: evidence against the pose.
    FreeSpace,
    /// A nearer surface, which hides the mesh.
    Occluder,
    /// No reading: a shadow of the sensor, a dark or shiny surface, or the object itself.
    Unknown,
}

/// A score and its terms, each from 0 to 1.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Score {
    /// The weighted sum.
    pub total: f32,
    /// Intersection over union, adjusted for occlusion and for parts outside the grid.
    pub overlap: f32,
    /// Fraction of the mask that the mesh covers.
    pub coverage: f32,
    /// Agreement of the depths, where both are known.
    pub depth: f32,
    /// Agreement of the normals, where both are known.
    pub normals: f32,
    /// Agreement of the outlines.
    pub outline: f32,
    /// Fraction of the silhouette that is occluded.
    pub hidden: f32,
    /// Number of cells of the union.
    pub union: f32,
    /// Numbers of cells with depth in both, with normals in both, and of visible outline, where cells without a reading
    /// count less than one.
    pub counts: [f32; 3],
}

impl From<&Score> for ScoreTerms {
    fn from(score: &Score) -> Self {
        Self {
            overlap: score.overlap.into(),
            coverage: score.coverage.into(),
            depth: score.depth.into(),
            normals: score.normals.into(),
            outline: score.outline.into(),
            hidden: score.hidden.into(),
        }
    }
}

impl Scoring {
    /// Evidence of a cell outside the mask, with the depth `scene`, against a mesh at the depth `z`, metres.
    #[inline]
    pub fn background(&self, scene: f32, z: f32) -> Background {
        if scene <= 0.0 {
            Background::Unknown
        } else if scene < z - self.occluder_m {
            Background::Occluder
        } else {
            Background::FreeSpace
        }
    }

    /// Scores the last render. `stretch` multiplies the rendered depths; the silhouette does not depend on it.
    pub fn score(&self, canvas: &Canvas, model: &Model, grid: &CropGrid, stretch: f32) -> Score {
        let (mut both, mut extra, mut hidden, mut unknown) = (0u32, 0u32, 0u32, 0u32);
        let (mut depth_cells, mut depth_error) = (0u32, 0.0f32);
        let (mut normal_cells, mut normal_sum) = (0u32, 0.0f32);
        let (mut outline_cells, mut outline_sum) = (0.0f32, 0.0f32);
        let width = grid.width;
        let per_depth = 1.0 / self.depth_m;
        let per_outline = 1.0 / (self.outline_cells * self.outline_cells);
        let to_mesh = canvas.rotation.transpose();
        let wants_outline = self.weights.outline > 0.0;
        let unknown_weight = grid.unknown_weight(self.weights.unknown);
        let [per_depth, per_outline, stretch] = [per_depth, per_outline, stretch].map(f32x4::splat);
        // Four cells at a time; sums in the order of the cells.
        for (v, row) in canvas.rows(grid) {
            for i in row.clone().step_by(LANES) {
                let w = four(&canvas.inverse_depth, i);
                let u = i - v * width;
                let mut is_drawn = w.simd_gt(f32x4::ZERO);
                if u + LANES > width {
                    is_drawn &= first(width - u);
                }
                if !is_drawn.any() {
                    continue;
                }
                let z = stretch / w;
                let is_mask = four_set(&grid.mask, i);
                let is_both = is_drawn & is_mask;
                let is_extra = is_drawn & !is_mask;
                both += count(is_both);
                let observed = four(&grid.depth, i);
                let has_depth = is_both & observed.simd_gt(f32x4::ZERO);
                if has_depth.any() {
                    let error = (z - observed).abs() * per_depth;
                    depth_error = plus(depth_error, (error / (f32x4::ONE + error)) & has_depth);
                    depth_cells += count(has_depth);
                    let seen = grid.normals.each_ref().map(|axis| four(axis, i));
                    let has_normal = has_depth & seen[2].simd_ne(f32x4::ZERO);
                    let drawn = drawn_normals(canvas, model, i, has_normal);
                    let along = |axis: usize| {
                        f32x4::splat(to_mesh.x_axis[axis]) * seen[0]
                            + f32x4::splat(to_mesh.y_axis[axis]) * seen[1]
                            + f32x4::splat(to_mesh.z_axis[axis]) * seen[2]
                    };
                    let cosine = along(0) * drawn[0] + along(1) * drawn[1] + along(2) * drawn[2];
                    normal_sum = plus(normal_sum, cosine.abs() & has_normal);
                    normal_cells += count(has_normal);
                }
                let mut visible = f32x4::ONE & is_both;
                if is_extra.any() {
                    // As `background`.
                    let scene = four(&grid.scene, i);
                    let is_unknown = is_extra & scene.simd_le(f32x4::ZERO);
                    let is_hidden = is_extra & !is_unknown & scene.simd_lt(z - f32x4::splat(self.occluder_m));
                    let is_free = is_extra & !is_unknown & !is_hidden;
                    extra += count(is_free);
                    hidden += count(is_hidden);
                    unknown += count(is_unknown);
                    visible = visible | (f32x4::ONE & is_free) | (f32x4::splat(unknown_weight) & is_unknown);
                }
                if wants_outline {
                    let visible = visible & are_outline(canvas, width, grid.height, u, v);
                    if visible.simd_gt(f32x4::ZERO).any() {
                        let d = four(&grid.outline, i);
                        outline_sum = plus(outline_sum, visible / (f32x4::ONE + d * d * per_outline));
                        outline_cells = plus(outline_cells, visible);
                    }
                }
            }
        }
        let mask_cells = grid.mask_cells as f32;
        let [both, extra, hidden, unknown] = [both, extra, hidden, unknown].map(|cells| cells as f32);
        let drawn = both + extra + hidden + unknown;
        // Silhouette outside the grid must have a cost; otherwise, the scale would grow without limit.
        let lost = canvas.lost / (LOST - canvas.lost) * drawn;
        let unseen = self.weights.occluded * hidden + unknown_weight * unknown;
        let union = mask_cells + extra + unseen + lost;
        let coverage = both / mask_cells.max(1.0);
        let [depth_cells, normal_cells] = [depth_cells, normal_cells].map(|cells| cells as f32);
        let mean = |sum: f32, cells: f32| if cells > 0.0 { sum / cells } else { 0.0 };
        let depth = if depth_cells > 0.0 { 1.0 - mean(depth_error, depth_cells) } else { 0.0 };
        let (normals, outline) = (mean(normal_sum, normal_cells), mean(outline_sum, outline_cells));
        let overlap = both / union.max(1.0);
        let score = Score {
            total: 0.0,
            overlap,
            coverage,
            depth,
            normals,
            outline,
            hidden: hidden / drawn.max(1.0),
            union,
            counts: [depth_cells, normal_cells, outline_cells],
        };
        // Agreement is weighted by the fraction of the union that it covers. Weighted by the coverage alone, which free
        // space does not reduce, it would favour a mesh that is too large.
        Score { total: self.weights.factor(&score, grid) * self.weights.agreement(&score), ..score }
    }
}

/// The normals of the triangles that are drawn in four cells, by axis, in the mesh frame, where they are wanted.
#[inline(always)]
fn drawn_normals(canvas: &Canvas, model: &Model, i: usize, is_wanted: f32x4) -> [f32x4; 3] {
    let drawn = match canvas.triangle.get(i..).and_then(|drawn| drawn.first_chunk::<LANES>()) {
        Some(four) => *four,
        None => core::array::from_fn(|lane| canvas.triangle.get(i + lane).copied().unwrap_or_default()),
    };
    // Cells that are empty hold triangles of earlier renders, of other models.
    let [a, b, c, d] = (i32x4::new(drawn.map(u32::cast_signed)) & cast::<f32x4, i32x4>(is_wanted)).to_array();
    let normal = |triangle: i32| model.facets[triangle as usize];
    let [x, y, z, _] = f32x4::transpose([normal(a), normal(b), normal(c), normal(d)]);
    [x, y, z]
}

/// As [`is_outline`], for four cells from column `u` on.
#[inline(always)]
fn are_outline(canvas: &Canvas, width: usize, height: usize, u: usize, v: usize) -> f32x4 {
    if v == 0 || v + 1 >= height {
        return f32x4::ZERO;
    }
    let (i, w) = (v * width + u, &canvas.inverse_depth);
    let is_empty = |at: usize| four(w, at).simd_eq(f32x4::ZERO);
    let mut are = is_empty(i - width) | is_empty(i + width) | is_empty(i - 1) | is_empty(i + 1);
    if u == 0 {
        are &= !first(1);
    }
    if u + LANES >= width {
        are &= first(width - 1 - u);
    }
    are
}

/// Whether a rendered cell has an empty neighbour. The border of the grid is not an outline.
#[inline]
pub fn is_outline(canvas: &Canvas, width: usize, height: usize, u: usize, v: usize) -> bool {
    if u == 0 || v == 0 || u + 1 >= width || v + 1 >= height {
        return false;
    }
    let i = v * width + u;
    let w = &canvas.inverse_depth;
    w[i - width] == 0.0 || w[i + width] == 0.0 || w[i - 1] == 0.0 || w[i + 1] == 0.0
}
