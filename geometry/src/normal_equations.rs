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
use wide::f64x2;

/// Number of parameters. Problems with fewer set the other columns of the Jacobian to 0 and get a step of 0 there.
pub const PARAMETERS: usize = 7;

/// Pairs of columns.
const PAIRS: usize = PARAMETERS.div_ceil(2);

/// JᵀWJ and JᵀWr, accumulated over residuals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormalEquations {
    /// Σ w J Jᵀ, in pairs of columns; only the upper triangle (column ≥ row) counts.
    matrix: [[f64x2; PAIRS]; PARAMETERS],
    /// Σ w r J, in pairs.
    gradient: [f64x2; PAIRS],
}

impl Default for NormalEquations {
    fn default() -> Self {
        Self::new()
    }
}

impl NormalEquations {
    /// Without residuals.
    pub fn new() -> Self {
        Self { matrix: [[f64x2::ZERO; PAIRS]; PARAMETERS], gradient: [f64x2::ZERO; PAIRS] }
    }

    /// The entry of the upper triangle.
    fn entry(&self, row: usize, column: usize) -> f64 {
        self.matrix[row][column / 2].to_array()[column % 2]
    }

    fn gradient(&self) -> [f64; PARAMETERS] {
        core::array::from_fn(|i| self.gradient[i / 2].to_array()[i % 2])
    }

    /// Adds a residual r with its Jacobian row J, weighted by w ≥ 0.
    pub fn add(&mut self, jacobian: &[f64; PARAMETERS], residual: f64, weight: f64) {
        let pairs = pairs_of(jacobian);
        let (weighted, weight) = (f64x2::splat(weight * residual), f64x2::splat(weight));
        for (i, row) in self.matrix.iter_mut().enumerate() {
            let factor = f64x2::splat(jacobian[i]);
            for (entries, columns) in row[i / 2..].iter_mut().zip(&pairs[i / 2..]) {
                *entries += factor * *columns * weight;
            }
        }
        for (entries, columns) in self.gradient.iter_mut().zip(pairs) {
            *entries += columns * weighted;
        }
    }

    /// Adds the quadratic ½xᵀBx + gᵀx in the first three parameters; the upper triangle of B is read.
    pub fn add_block(&mut self, block: &[[f64; 3]; 3], [x, y, z]: [f64; 3]) {
        let [[a, b, c], [_, d, e], [_, _, f]] = *block;
        for (i, [from, to, last]) in [[a, b, c], [0.0, d, e], [0.0, 0.0, f]].into_iter().enumerate() {
            self.matrix[i][0] += f64x2::new([from, to]);
            self.matrix[i][1] += f64x2::new([last, 0.0]);
        }
        self.gradient[0] += f64x2::new([x, y]);
        self.gradient[1] += f64x2::new([z, 0.0]);
    }

    /// Adds the equations of other parameters x = A·y, of which these are y: AᵀMA and Aᵀg. `map` holds the rows of A.
    pub fn add_mapped(&mut self, other: &Self, map: &[[f64; PARAMETERS]; PARAMETERS]) {
        // Entry by entry of M, so that no matrix is multiplied out.
        for (i, from) in map.iter().enumerate() {
            for (j, to) in map.iter().enumerate() {
                let (weight, to) = (other.entry(i.min(j), i.max(j)), pairs_of(to));
                for (k, row) in self.matrix.iter_mut().enumerate() {
                    let factor = f64x2::splat(from[k] * weight);
                    for (entries, to) in row[k / 2..].iter_mut().zip(&to[k / 2..]) {
                        *entries += factor * *to;
                    }
                }
            }
            let gradient = f64x2::splat(other.gradient()[i]);
            for (entry, from) in self.gradient.iter_mut().zip(pairs_of(from)) {
                *entry += from * gradient;
            }
        }
    }

    /// The step x that minimises Σ w (r + J·x)² + λ‖x‖², with λ = `damping` × the trace of JᵀWJ.
    ///
    /// A small damping (1e-9) gives a step of 0 along unconstrained directions. A large one (1e-3 and above) shortens
    /// the step and turns it towards the gradient, as in the Levenberg–Marquardt method. `None` if the damped matrix is
    /// not positive definite: without residuals, or if some are not finite.
    pub fn solve(&self, damping: f64) -> Option<[f64; PARAMETERS]> {
        Some(self.factored(damping)?.solve(&-SVector::from(self.gradient())).into())
    }

    /// (JᵀWJ + λ·1)⁻¹ with λ = `damping` × the trace of JᵀWJ; `None` as for [`NormalEquations::solve`].
    pub fn inverse(&self, damping: f64) -> Option<[[f64; PARAMETERS]; PARAMETERS]> {
        Some(self.factored(damping)?.inverse().into())
    }

    #[inline(never)]
    fn factored(&self, damping: f64) -> Option<Cholesky<f64, Const<PARAMETERS>>> {
        let trace: f64 = (0..PARAMETERS).map(|i| self.entry(i, i)).sum();
        // The decomposition reads the lower triangle only.
        let lower = |row: usize, column: usize| if row < column { 0.0 } else { self.entry(column, row) };
        let mut damped = SMatrix::<f64, PARAMETERS, PARAMETERS>::from_fn(lower);
        damped.set_diagonal(&damped.diagonal().add_scalar(damping * trace));
        Cholesky::new(damped).filter(|factor| factor.l_dirty().diagonal().iter().all(|pivot| pivot.is_finite()))
    }
}

#[inline(always)]
fn pairs_of(numbers: &[f64; PARAMETERS]) -> [f64x2; PAIRS] {
    let [a, b, c, d, e, f, g] = *numbers;
    [f64x2::new([a, b]), f64x2::new([c, d]), f64x2::new([e, f]), f64x2::new([g, 0.0])]
}
