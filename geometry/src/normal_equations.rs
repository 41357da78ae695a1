//! Normal equations of a weighted least-squares step in up to seven parameters, such as (ω, τ, σ) of a similarity.
//!
//! One size for every use, over plain arrays: nalgebra's decompositions would be compiled once for each size, at
//! several kilobytes of WebAssembly apiece. The operations follow its order, and give its bits.
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

/// Parameters of a step. A use with fewer leaves the other columns of its Jacobians 0, and gets 0 for them.
pub const PARAMETERS: usize = 7;

/// JᵀWJ and JᵀWr of the residuals added so far.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormalEquations {
    /// Σ w J Jᵀ; only `[row][column]` with column ≥ row is kept.
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
    /// No residual yet.
    pub fn new() -> Self {
        Self { matrix: [[0.0; PARAMETERS]; PARAMETERS], gradient: [0.0; PARAMETERS] }
    }

    /// Adds a residual r with its derivatives J by the parameters, weighted by w ≥ 0.
    pub fn add(&mut self, jacobian: &[f64; PARAMETERS], residual: f64, weight: f64) {
        let weighted = weight * residual;
        for (i, (row, gradient)) in self.matrix.iter_mut().zip(&mut self.gradient).enumerate() {
            for (entry, column) in row[i..].iter_mut().zip(&jacobian[i..]) {
                *entry += jacobian[i] * column * weight;
            }
            *gradient += jacobian[i] * weighted;
        }
    }

    /// Adds a quadratic ½xᵀBx + gᵀx in the first three parameters, of which B's upper triangle is read.
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

    /// Adds all that `other` holds, as if its residuals had been added here.
    pub fn merge(&mut self, other: &Self) {
        let (mine, theirs) = (self.matrix.as_flattened_mut(), other.matrix.as_flattened());
        let (matrix, gradient) = (mine.iter_mut().zip(theirs), self.gradient.iter_mut().zip(&other.gradient));
        matrix.chain(gradient).for_each(|(sum, term)| *sum += term);
    }

    /// The step x that minimises Σ w (r + J·x)² + λ‖x‖², with λ = `damping` × the trace of JᵀWJ.
    ///
    /// Directions that the residuals leave free do not move under a small damping (1e-9); a large one (1e-3 and up)
    /// shortens the step towards the gradient's direction, as Levenberg's method does. `None` where the matrix is
    /// not positive definite all the same: without residuals, or with some that are not finite.
    pub fn solve(&self, damping: f64) -> Option<[f64; PARAMETERS]> {
        Some(self.factored(damping)?.solve(self.gradient.map(|g| -g)))
    }

    /// (JᵀWJ + λ·1)⁻¹ with λ = `damping` × the trace; where [`NormalEquations::solve`] has no step, none.
    pub fn inverse(&self, damping: f64) -> Option<[[f64; PARAMETERS]; PARAMETERS]> {
        let factor = self.factored(damping)?;
        let mut columns = [[0.0; PARAMETERS]; PARAMETERS];
        for (i, column) in columns.iter_mut().enumerate() {
            let mut unit = [0.0; PARAMETERS];
            unit[i] = 1.0;
            *column = factor.solve(unit);
        }
        Some(columns)
    }

    #[inline(never)]
    fn factored(&self, damping: f64) -> Option<Factor> {
        let trace: f64 = (0..PARAMETERS).map(|i| self.matrix[i][i]).sum();
        let mut l = self.matrix;
        for j in 0..PARAMETERS {
            l[j][j] += damping * trace;
            for k in 0..j {
                for i in j..PARAMETERS {
                    l[j][i] -= l[k][j] * l[k][i];
                }
            }
            // Written so that NaN fails.
            if !(l[j][j] > 0.0 && l[j][j].is_finite()) {
                return None;
            }
            let pivot = l[j][j].sqrt();
            l[j][j] = pivot;
            for entry in &mut l[j][j + 1..] {
                *entry /= pivot;
            }
        }
        Some(Factor(l))
    }
}

/// Cholesky's factor L, column by column: `[j][i]` is its row i, column j.
struct Factor([[f64; PARAMETERS]; PARAMETERS]);

impl Factor {
    /// x with L Lᵀ x = `x`: L y = `x`, then Lᵀ x = y.
    fn solve(&self, mut x: [f64; PARAMETERS]) -> [f64; PARAMETERS] {
        let l = &self.0;
        for j in 0..PARAMETERS {
            x[j] /= l[j][j];
            for i in j + 1..PARAMETERS {
                x[i] -= x[j] * l[j][i];
            }
        }
        for j in (0..PARAMETERS).rev() {
            let known: f64 = (j + 1..PARAMETERS).map(|i| l[j][i] * x[i]).sum();
            x[j] = (x[j] - known) / l[j][j];
        }
        x
    }
}
