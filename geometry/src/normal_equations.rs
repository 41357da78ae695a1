//! Normal equations of a weighted least-squares step, mostly in up to seven parameters, such as (ω, τ, σ) of a similarity.
//!
//! The decomposition is that of the largest problem for all, so that it is compiled once.

use nalgebra::{Cholesky, Const, SMatrix, SVector};
use wide::f64x2;

/// Number of parameters. Problems with fewer set the other columns of the Jacobian to 0 and get a step of 0 there.
pub const PARAMETERS: usize = 7;

/// Pairs of columns of the largest problem, which has twelve parameters: the size of an array cannot depend on `N`.
const MOST_PAIRS: usize = 6;

/// Those of most problems.
pub type NormalEquations = NormalEquationsOf<PARAMETERS>;

/// JᵀWJ and JᵀWr, accumulated over residuals in `N` parameters, at most twelve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormalEquationsOf<const N: usize> {
    /// Σ w J Jᵀ, in pairs of columns; only the upper triangle (column ≥ row) counts.
    matrix: [[f64x2; MOST_PAIRS]; N],
    /// Σ w r J, in pairs.
    gradient: [f64x2; MOST_PAIRS],
}

impl<const N: usize> Default for NormalEquationsOf<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> NormalEquationsOf<N> {
    /// Pairs of columns.
    const PAIRS: usize = {
        assert!(N <= 2 * MOST_PAIRS);
        N.div_ceil(2)
    };

    /// Without residuals.
    pub fn new() -> Self {
        Self { matrix: [[f64x2::ZERO; MOST_PAIRS]; N], gradient: [f64x2::ZERO; MOST_PAIRS] }
    }

    /// The entry of the upper triangle.
    fn entry(&self, row: usize, column: usize) -> f64 {
        self.matrix[row][column / 2].to_array()[column % 2]
    }

    fn gradient(&self) -> [f64; N] {
        core::array::from_fn(|i| self.gradient[i / 2].to_array()[i % 2])
    }

    /// Adds a residual r with its Jacobian row J, weighted by w ≥ 0.
    pub fn add(&mut self, jacobian: &[f64; N], residual: f64, weight: f64) {
        let pairs = pairs_of(jacobian);
        let (weighted, weight) = (f64x2::splat(weight * residual), f64x2::splat(weight));
        for (i, row) in self.matrix.iter_mut().enumerate() {
            let factor = f64x2::splat(jacobian[i]);
            for (entries, columns) in row[i / 2..Self::PAIRS].iter_mut().zip(&pairs[i / 2..Self::PAIRS]) {
                *entries += factor * *columns * weight;
            }
        }
        for (entries, columns) in self.gradient[..Self::PAIRS].iter_mut().zip(pairs) {
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

    /// Adds equations in the first parameters only.
    pub fn add_first<const M: usize>(&mut self, other: &NormalEquationsOf<M>) {
        for (row, added) in self.matrix.iter_mut().zip(&other.matrix) {
            row.iter_mut().zip(added).for_each(|(entries, added)| *entries += *added);
        }
        self.gradient.iter_mut().zip(other.gradient).for_each(|(entries, added)| *entries += added);
    }

    /// Adds the equations of other parameters x = A·y, of which these are y: AᵀMA and Aᵀg. `map` holds the rows of A.
    pub fn add_mapped(&mut self, other: &Self, map: &[[f64; N]; N]) {
        // Entry by entry of M, so that no matrix is multiplied out.
        for (i, from) in map.iter().enumerate() {
            for (j, to) in map.iter().enumerate() {
                let (weight, to) = (other.entry(i.min(j), i.max(j)), pairs_of(to));
                for (k, row) in self.matrix.iter_mut().enumerate() {
                    let factor = f64x2::splat(from[k] * weight);
                    for (entries, to) in row[k / 2..Self::PAIRS].iter_mut().zip(&to[k / 2..Self::PAIRS]) {
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
    pub fn solve(&self, damping: f64) -> Option<[f64; N]> {
        let gradient = self.gradient();
        let step = self.factored(damping)?.solve(&SVector::from_fn(|i, _| if i < N { -gradient[i] } else { 0.0 }));
        Some(core::array::from_fn(|i| step[i]))
    }

    /// (JᵀWJ + λ·1)⁻¹ with λ = `damping` × the trace of JᵀWJ; `None` as for [`NormalEquations::solve`].
    pub fn inverse(&self, damping: f64) -> Option<[[f64; N]; N]> {
        let inverse = self.factored(damping)?.inverse();
        Some(core::array::from_fn(|column| core::array::from_fn(|row| inverse[(row, column)])))
    }

    /// The decomposition, as one of the largest problem, whose other parameters are independent: it is compiled once.
    fn factored(&self, damping: f64) -> Option<Factors> {
        let trace: f64 = (0..N).map(|i| self.entry(i, i)).sum();
        let mut damped = SMatrix::identity();
        for column in 0..N {
            (column..N).for_each(|row| damped[(row, column)] = self.entry(column, row));
            damped[(column, column)] += damping * trace;
        }
        factors(damped)
    }
}

/// A decomposition.
type Factors = Cholesky<f64, Const<{ 2 * MOST_PAIRS }>>;

/// Decomposes a matrix, of which only the lower triangle is read.
#[inline(never)]
fn factors(damped: SMatrix<f64, { 2 * MOST_PAIRS }, { 2 * MOST_PAIRS }>) -> Option<Factors> {
    Cholesky::new(damped).filter(|factors| factors.l_dirty().diagonal().iter().all(|pivot| pivot.is_finite()))
}

#[inline(always)]
fn pairs_of<const N: usize>(numbers: &[f64; N]) -> [f64x2; MOST_PAIRS] {
    let mut pairs = [f64x2::ZERO; MOST_PAIRS];
    for (k, pair) in pairs.iter_mut().enumerate().take(N / 2) {
        *pair = f64x2::new([numbers[2 * k], numbers[2 * k + 1]]);
    }
    if N % 2 == 1 {
        pairs[N / 2] = f64x2::new([numbers[N - 1], 0.0]);
    }
    pairs
}
