//! Score: how well a drawn pose explains mask, free space and depth.

use super::grid::CropGrid;
use super::render::{Canvas, Model};
use crate::report::ScoreTerms;

/// What counts how much.
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
    /// A cell of silhouette behind an occluder, in the union: 0 is no cost, 1 that of free space.
    pub occluded: f32,
}

impl Default for Weights {
    fn default() -> Self {
        Self { overlap: 0.2, depth: 1.0, normals: 0.25, outline: 0.6, occluded: 0.15 }
    }
}

impl Weights {
    /// What a score's overlap is multiplied by.
    pub fn agreement(&self, score: &Score) -> f32 {
        self.overlap + self.depth * score.depth + self.normals * score.normals + self.outline * score.outline
    }
}

/// The score's settings at one resolution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scoring {
    /// Weights of the terms.
    pub weights: Weights,
    /// Depth error that halves a cell's credit, metres.
    pub depth_m: f32,
    /// Scene this much nearer than the mesh occludes it, metres.
    pub occluder_m: f32,
    /// Outline distance that halves a cell's credit, cells.
    pub outline_cells: f32,
}

/// A score and what it is made of; all terms from 0 to 1.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Score {
    /// The weighted sum.
    pub total: f32,
    /// Intersection over union, with what is hidden and what is lost accounted for.
    pub overlap: f32,
    /// Share of the mask that the mesh covers.
    pub coverage: f32,
    /// Agreement of depth where both have it.
    pub depth: f32,
    /// Agreement of normals where both have them.
    pub normals: f32,
    /// Agreement of the outlines.
    pub outline: f32,
    /// Share of the silhouette that an occluder hides.
    pub hidden: f32,
    /// Cells of the union.
    pub union: f32,
    /// Cells with depth in both, normals in both, and cells of visible outline.
    pub counts: [u32; 3],
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
    /// Whether a reading of the scene, metres, hides a mesh at `z`; none hides nothing.
    #[inline]
    pub fn hides(&self, scene: f32, z: f32) -> bool {
        scene > 0.0 && scene < z - self.occluder_m
    }

    /// Scores what was drawn last. `stretch` multiplies the drawn depths: the silhouette does not depend on it.
    pub fn score(&self, canvas: &Canvas, model: &Model, grid: &CropGrid, stretch: f32) -> Score {
        let (mut both, mut extra, mut hidden) = (0u32, 0u32, 0u32);
        let (mut depth_cells, mut depth_error) = (0u32, 0.0f32);
        let (mut normal_cells, mut normal_sum) = (0u32, 0.0f32);
        let (mut outline_cells, mut outline_sum) = (0u32, 0.0f32);
        let width = grid.width;
        let per_depth = 1.0 / self.depth_m;
        let per_outline = 1.0 / (self.outline_cells * self.outline_cells);
        let to_mesh = canvas.rotation.transpose();
        let wants_outline = self.weights.outline > 0.0;
        for v in 0..grid.height {
            // Row by row: a row's length is checked once, not each of its cells.
            let row = v * width..(v + 1) * width;
            let (drawn, mask) = (&canvas.inverse_depth[row.clone()], &grid.mask[row.clone()]);
            let (depth, scene) = (&grid.depth[row.clone()], &grid.scene[row]);
            for (u, (((w, mask), observed), scene)) in (0..).zip(drawn.iter().zip(mask).zip(depth).zip(scene)) {
                let (w, mask, observed, scene) = (*w, *mask, *observed, *scene);
                if w <= 0.0 {
                    continue;
                }
                let i = v * width + u;
                let z = stretch / w;
                let mut visible = true;
                if mask {
                    both += 1;
                    if observed > 0.0 {
                        let error = (z - observed).abs() * per_depth;
                        depth_error += error / (1.0 + error);
                        depth_cells += 1;
                        let normal = grid.normals[i];
                        if normal.z != 0.0 {
                            normal_sum += (to_mesh * normal).dot(model.normals[canvas.triangle[i] as usize]).abs();
                            normal_cells += 1;
                        }
                    }
                } else if self.hides(scene, z) {
                    hidden += 1;
                    visible = false;
                } else {
                    extra += 1;
                }
                if wants_outline && visible && is_outline(canvas, width, grid.height, u, v) {
                    let d = grid.outline[i];
                    outline_sum += 1.0 / (1.0 + d * d * per_outline);
                    outline_cells += 1;
                }
            }
        }
        let mask_cells = grid.mask_cells as f32;
        let [both, extra, hidden] = [both, extra, hidden].map(|cells| cells as f32);
        let drawn = both + extra + hidden;
        // Silhouette that leaves the grid has to cost, or the scale runs away.
        let lost = canvas.lost / (1.05 - canvas.lost) * drawn;
        let union = mask_cells + extra + self.weights.occluded * hidden + lost;
        let coverage = both / mask_cells.max(1.0);
        let mean = |sum: f32, cells: u32| if cells > 0 { sum / cells as f32 } else { 0.0 };
        let depth = if depth_cells > 0 { 1.0 - mean(depth_error, depth_cells) } else { 0.0 };
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
        // Agreement counts by the share of the union that it speaks for: multiplied by the coverage alone, which free
        // space does not lower, it would favour a mesh that is too large.
        Score { total: overlap * self.weights.agreement(&score), ..score }
    }
}

/// Whether a drawn cell has a neighbour that is not drawn. The grid's own border is no outline.
#[inline]
pub fn is_outline(canvas: &Canvas, width: usize, height: usize, u: usize, v: usize) -> bool {
    if u == 0 || v == 0 || u + 1 >= width || v + 1 >= height {
        return false;
    }
    let i = v * width + u;
    let w = &canvas.inverse_depth;
    w[i - width] == 0.0 || w[i + width] == 0.0 || w[i - 1] == 0.0 || w[i + 1] == 0.0
}
