//! Score: how well a rendered pose explains mask, free space and depth.

use super::grid::CropGrid;
use super::render::{Canvas, Model};
use crate::report::ScoreTerms;

/// Score difference attributed to noise. In generated cases won by a flip, the true pose scores lower by about this
/// much.
pub const NOISE: f32 = 0.15;

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

/// What the depth map shows outside the mask, where the mesh is rendered.
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
#[derive(Debug, Clone, Copy, Default, PartialEq)]
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
        for (v, row) in canvas.rows(grid) {
            // By rows, so that bounds are checked once per row instead of once per cell.
            let begin = row.start - v * width;
            let (drawn, mask) = (&canvas.inverse_depth[row.clone()], &grid.mask[row.clone()]);
            let (depth, scene) = (&grid.depth[row.clone()], &grid.scene[row]);
            for (u, (((w, mask), observed), scene)) in (begin..).zip(drawn.iter().zip(mask).zip(depth).zip(scene)) {
                let (w, mask, observed, scene) = (*w, *mask, *observed, *scene);
                if w <= 0.0 {
                    continue;
                }
                let i = v * width + u;
                let z = stretch / w;
                let mut visible = 1.0;
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
                } else {
                    match self.background(scene, z) {
                        Background::FreeSpace => extra += 1,
                        Background::Occluder => {
                            hidden += 1;
                            visible = 0.0;
                        }
                        Background::Unknown => {
                            unknown += 1;
                            visible = unknown_weight;
                        }
                    }
                }
                if wants_outline && visible > 0.0 && is_outline(canvas, width, grid.height, u, v) {
                    let d = grid.outline[i];
                    outline_sum += visible / (1.0 + d * d * per_outline);
                    outline_cells += visible;
                }
            }
        }
        let mask_cells = grid.mask_cells as f32;
        let [both, extra, hidden, unknown] = [both, extra, hidden, unknown].map(|cells| cells as f32);
        let drawn = both + extra + hidden + unknown;
        // Silhouette outside the grid must have a cost; otherwise, the scale would grow without limit.
        let lost = canvas.lost / (1.05 - canvas.lost) * drawn;
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
