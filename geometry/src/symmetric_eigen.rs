//! Eigenvalues and eigenvectors of a symmetric 3×3 matrix, in f64.
//!
//! Cyclic Jacobi rotations instead of `nalgebra::SymmetricEigen` (tridiagonalisation and QR iterations), because the bits
//! of results depend on the algorithm: of 20 000 random matrices, both gave the same eigenvalues for 10. The time is
//! similar (0.56 and 0.42 µs per matrix in a development build).

use glam::{DMat3, DVec3};

/// Limit on the sweeps; three to five are usual.
const MAX_SWEEPS: usize = 24;

/// Eigenvalues in ascending order, each with its unit eigenvector.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SymmetricEigen {
    /// λ₀ ≤ λ₁ ≤ λ₂.
    pub values: [f64; 3],
    /// Orthonormal, in the order of the values; the signs are arbitrary.
    pub vectors: [DVec3; 3],
}

impl SymmetricEigen {
    /// Diagonalises `matrix` (its upper triangle is read) by cyclic Jacobi rotations. Uses no function but the square
    /// root, so that the bits are the same on every platform. For nearly equal eigenvalues, it keeps the precision
    /// that a closed form loses.
    pub fn of(matrix: DMat3) -> Self {
        let mut a = matrix.transpose().to_cols_array_2d(); // a[row][column]
        let mut vectors = [DVec3::X, DVec3::Y, DVec3::Z];
        let size = a.as_flattened().iter().fold(0.0f64, |m, x| m.max(x.abs()));
        for _ in 0..MAX_SWEEPS {
            let off = a[0][1].abs().max(a[0][2].abs()).max(a[1][2].abs());
            if off <= 1e-17 * size {
                break;
            }
            for (p, q, r) in [(0, 1, 2), (0, 2, 1), (1, 2, 0)] {
                rotate(&mut a, &mut vectors, p, q, r);
            }
        }
        let mut order = [0, 1, 2];
        for (i, j) in [(0, 1), (1, 2), (0, 1)] {
            let (low, high) = (order[i], order[j]);
            if a[low][low] > a[high][high] {
                order.swap(i, j);
            }
        }
        Self { values: order.map(|i| a[i][i]), vectors: order.map(|i| vectors[i]) }
    }
}

/// v vᵀ.
pub fn outer(v: DVec3) -> DMat3 {
    DMat3::from_cols(v * v.x, v * v.y, v * v.z)
}

/// One Jacobi rotation, which makes a\[p\]\[q\] zero; p < q, and r is the third index.
fn rotate(a: &mut [[f64; 3]; 3], vectors: &mut [DVec3; 3], p: usize, q: usize, r: usize) {
    let apq = a[p][q];
    if apq == 0.0 {
        return;
    }
    let theta = (a[q][q] - a[p][p]) / (2.0 * apq);
    // The smaller root of t² + 2θt − 1; an infinite θ gives t = 0, no rotation.
    let t = 1.0 / (theta.abs() + (theta * theta + 1.0).sqrt()) * if theta < 0.0 { -1.0 } else { 1.0 };
    let c = 1.0 / (t * t + 1.0).sqrt();
    let s = t * c;
    a[p][p] -= t * apq;
    a[q][q] += t * apq;
    a[p][q] = 0.0;
    let (pr, qr) = ((p.min(r), p.max(r)), (q.min(r), q.max(r)));
    let (apr, aqr) = (a[pr.0][pr.1], a[qr.0][qr.1]);
    a[pr.0][pr.1] = c * apr - s * aqr;
    a[qr.0][qr.1] = s * apr + c * aqr;
    let (vp, vq) = (vectors[p], vectors[q]);
    vectors[p] = c * vp - s * vq;
    vectors[q] = s * vp + c * vq;
}
