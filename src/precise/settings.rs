//! Settings: how much work a search puts in, and what it looks for.

use super::clean::CleanObservation;
use super::score::{Scoring, Weights};

/// The grids, coarse to fine: the sieve, on which every rotation is drawn; the coarse grid; the middle and the fine one,
/// on which candidates are refined; and the finest, for the last digits of the best.
pub const LEVELS: usize = 5;
/// See [`LEVELS`].
pub const SIEVE: usize = 0;
/// See [`LEVELS`].
pub const COARSE: usize = 1;
/// See [`LEVELS`].
pub const MIDDLE: usize = 2;
/// See [`LEVELS`].
pub const FINE: usize = 3;
/// See [`LEVELS`].
pub const FINEST: usize = 4;

/// What a rotation of the grid, a step on the middle grid and one on the fine grid cost: milliseconds, as WebAssembly,
/// on a machine of 2020.
const COST_MS: [f64; 3] = [0.06, 0.12, 0.4];

/// Work and objective of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SearchSettings {
    /// Rotations of the grid.
    pub rotations: usize,
    /// Poses that the sieve lets through; distinct candidates that are refined on the middle grid, that go on there,
    /// that are refined on the fine grid, and on the finest.
    pub keep: [usize; 5],
    /// Mask cells of the grids.
    pub cells: [usize; LEVELS],
    /// Triangles of the mesh on the grids.
    pub triangles: [usize; LEVELS],
    /// Steps of the four refinements.
    pub iterations: [usize; 4],
    /// Depth error that halves a cell's credit on the grids, as a share of the observed diagonal.
    pub depth_error: [f64; LEVELS],
    /// The objective.
    pub weights: Weights,
    /// Whether occluders hide the mesh, and cut-off masks let it stick out.
    pub occlusion: bool,
    /// Whether sizes other than the box's are tried.
    pub anchors: bool,
    /// Whether the scale stays as the grid found it.
    pub lock_scale: bool,
}

impl Default for SearchSettings {
    fn default() -> Self {
        Self {
            rotations: 1500,
            keep: [500, 64, 20, 6, 1],
            cells: [150, 500, 900, 3000, 7000],
            triangles: [200, 700, 1500, 5000, 10_000],
            iterations: [4, 8, 12, 6],
            depth_error: [0.12, 0.12, 0.06, 0.03, 0.03],
            weights: Weights::default(),
            occlusion: true,
            anchors: true,
            lock_scale: false,
        }
    }
}

impl SearchSettings {
    /// Less of everything.
    pub fn fast() -> Self {
        Self {
            rotations: 600,
            keep: [120, 20, 6, 3, 1],
            cells: [120, 400, 700, 2000, 4000],
            triangles: [150, 500, 1000, 3000, 5000],
            iterations: [4, 5, 8, 4],
            ..Self::default()
        }
    }

    /// More of everything.
    pub fn best() -> Self {
        Self { rotations: 4000, keep: [1600, 160, 40, 10, 2], iterations: [5, 15, 20, 12], ..Self::default() }
    }

    /// The search held to a bound of work, counted in milliseconds of a machine of 2020: the rotations and the
    /// candidates shrink, or grow, in proportion.
    pub fn within(self, budget_ms: f64) -> Self {
        let cost = COST_MS[0] * self.rotations as f64
            + COST_MS[1] * (self.keep[1] * self.iterations[0] + self.keep[2] * self.iterations[1]) as f64
            + COST_MS[2] * (self.keep[3] * self.iterations[2]) as f64;
        let share = (budget_ms / cost).clamp(0.02, 20.0);
        let scaled = |count: usize, least: usize| ((count as f64 * share) as usize).max(least);
        Self {
            rotations: scaled(self.rotations, 60),
            keep: [
                scaled(self.keep[0], 30),
                scaled(self.keep[1], 6),
                scaled(self.keep[2], 3),
                scaled(self.keep[3], 2),
                self.keep[4],
            ],
            ..self
        }
    }

    /// The objective on one of the grids.
    pub fn scoring(&self, clean: &CleanObservation, level: usize) -> Scoring {
        let mut weights = self.weights;
        // Outlines mean little on cells that are as wide as the errors of the rotation grid.
        weights.outline *= [0.0, 0.0, 0.5, 1.0, 1.0][level];
        let occluder_m = 0.02 * clean.diagonal_m + 0.005 * clean.median_m;
        Scoring {
            weights,
            depth_m: (self.depth_error[level] * clean.diagonal_m) as f32,
            occluder_m: if self.occlusion { occluder_m as f32 } else { f32::INFINITY },
            outline_cells: 2.0,
        }
    }
}
