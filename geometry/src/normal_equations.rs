//! Normal equations of a weighted least-squares step in up to seven parameters, such as (ω, τ, σ) of a similarity.
//!
//! All problems share one size, so that the decomposition is compiled once.
//!
//! ```
//! use sim3align_geometry::normal_equations::NormalEquations;
//!
//! // Two residuals in the first parameter: r₁ = x − 1, r₂ = x − 3, at x = 0.
//! let mut equations = NormalEquations::new();
//! let jacobian = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
//! equations.add(&jacobian, -1.0, 1.0);
//! equations.add(&jacobian, -3.0, 1.0);
//! let step = equations.solve(1e-9).unwrap();
//! assert!((step[0] - 2.0).abs() < 1e-8 && step[1..] == [0.0; 6]);
//! ```

use nalgebra::{Cholesky, Const, SMatrix, SVector};

/// Number of parameters. Problems with fewer set the other columns of the Jacobian to 0 and get a step of 0 there.
pub const PARAMETERS: usize = 7;

/// JᵀWJ and JᵀWr, accumulated over residuals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormalEquations {
    /// Σ w J Jᵀ; only the upper triangle (`[row][column]` with column ≥ row) is stored.
    matrix: [[f64; PARAMETERS]; PARAMETERS],
    /// Σ w r J.
    gradient: [f64; PARAMETERS],
}

impl Default for NormalEquations {
    fn default() -> Self {
        Self::new()
    }
}

impl NormalEquations {
    /// Without residuals.
    pub fn new() -> Self {
        Self { matrix: [[0.0; PARAMETERS]; PARAMETERS], gradient: [0.0; PARAMETERS] }
    }

    /// Adds a residual r with its Jacobian row J, weighted by w ≥ 0.
    pub fn add(&mut self, jacobian: &[f64; PARAMETERS], residual: f64, weight: f64) {
        let weighted = weight * residual;
        for (i, (row, gradient)) in self.matrix.iter_mut().zip(&mut self.gradient).enumerate() {
            for (entry, column) in row[i..].iter_mut().zip(&jacobian[i..]) {
                *entry += jacobian[i] * column * weight;
            }
            *gradient += jacobian[i] * weighted;
        }
    }

    /// Adds the quadratic ½xᵀBx + gᵀx in the first three parameters; the upper triangle of B is read.
    pub fn add_block(&mut self, block: &[[f64; 3]; 3], gradient: [f64; 3]) {
        for (i, (row, added)) in self.matrix.iter_mut().zip(block).enumerate() {
            for (entry, added) in row[i..].iter_mut().zip(&added[i..]) {
                *entry += added;
            }
        }
        for (entry, added) in self.gradient.iter_mut().zip(gradient) {
            *entry += added;
        }
    }

    /// Adds the equations of other parameters x = A·y, of which these are y: AᵀMA and Aᵀg. `map` holds the rows of A.
    pub fn add_mapped(&mut self, other: &Self, map: &[[f64; PARAMETERS]; PARAMETERS]) {
        // Entry by entry of M, so that no matrix is multiplied out.
        for (i, from) in map.iter().enumerate() {
            for (j, to) in map.iter().enumerate() {
                let weight = other.matrix[i.min(j)][i.max(j)];
                for (k, row) in self.matrix.iter_mut().enumerate() {
                    for (entry, to) in row[k..].iter_mut().zip(&to[k..]) {
                        *entry += from[k] * weight * to;
                    }
                }
            }
            for (entry, from) in self.gradient.iter_mut().zip(from) {
                *entry += from * other.gradient[i];
            }
        }
    }

    /// The step x that minimises Σ w (r + J·x)² + λ‖x‖², with λ = `damping` × the trace of JᵀWJ.
    ///
    /// A small damping (1e-9) gives a step of 0 along unconstrained directions. A large one (1e-3 and above) shortens
    /// the step and turns it towards the gradient, as in the Levenberg–Marquardt method. `None` if the damped matrix is
    /// not positive definite: without residuals, or if some are not finite.
    pub fn solve(&self, damping: f64) -> Option<[f64; PARAMETERS]> {
        Some(self.factored(damping)?.solve(&-SVector::from(self.gradient)).into())
    }

    /// (JᵀWJ + λ·1)⁻¹ with λ = `damping` × the trace of JᵀWJ; `None` as for [`NormalEquations::solve`].
    pub fn inverse(&self, damping: f64) -> Option<[[f64; PARAMETERS]; PARAMETERS]> {
        Some(self.factored(damping)?.inverse().into())
    }

    #[inline(never)]
    fn factored(&self, damping: f64) -> Option<Cholesky<f64, Const<PARAMETERS>>> {
        let trace: f64 = (0..PARAMETERS).map(|i| self.matrix[i][i]).sum();
        // The decomposition reads the lower triangle only.
        let lower = |row: usize, column: usize| if row < column { 0.0 } else { self.matrix[column][row] };
        let mut damped = SMatrix::<f64, PARAMETERS, PARAMETERS>::from_fn(lower);
        damped.set_diagonal(&damped.diagonal().add_scalar(damping * trace));
        Cholesky::new(damped).filter(|factor| factor.l_dirty().diagonal().iter().all(|pivot| pivot.is_finite()))
    }
}
