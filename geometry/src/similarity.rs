//! Similarity transforms: Sim(3) in f64 (nalgebra), and an f32 form for hot loops (glam).

use glam::{Mat3, Vec3};
use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};

use sim3align_runtime::error::{Error, ErrorCode, Result};
use sim3align_runtime::number::{number, numbers};

/// The similarity y = s·R·x + t. Values are named by their frames: `camera_from_mesh`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Similarity {
    /// s > 0.
    pub scale: f64,
    /// R ∈ SO(3).
    pub rotation: Rotation3<f64>,
    /// t, in the unit of the target frame.
    pub translation: Vector3<f64>,
}

impl Similarity {
    /// The identity x ↦ x.
    pub fn identity() -> Self {
        Self { scale: 1.0, rotation: Rotation3::identity(), translation: Vector3::zeros() }
    }

    /// A similarity from its parts; `rotation` is projected to the nearest rotation.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidTransform`] if the scale is not finite and positive, a number is not finite, or an entry of
    /// RᵀR − 1 exceeds 1e-3 or det R ≤ 0 (a shear, a reflection).
    pub fn from_parts(scale: f64, rotation: Matrix3<f64>, translation: Vector3<f64>) -> Result<Self> {
        let bad = |found: String, expected: &str| {
            Error::new(
                ErrorCode::InvalidTransform,
                "transform",
                found,
                expected.to_owned(),
                "Pass { scale, rotation, translation } or a column-major 4×4 matrix of a similarity.",
            )
        };
        if !(scale.is_finite() && scale > 0.0) {
            return Err(bad(format!("scale {}", number(scale)), "a finite scale above 0"));
        }
        if !translation.iter().chain(rotation.iter()).all(|x| x.is_finite()) {
            return Err(bad("a number that is not finite".into(), "finite numbers"));
        }
        let off = rotation.transpose() * rotation - Matrix3::identity();
        let determinant = rotation.determinant();
        // The comparison is negated so that NaN, from numbers whose squares overflow, fails.
        if !(off.iter().all(|x| x.abs() <= 1e-3) && determinant > 0.0) {
            let found =
                format!("a matrix with |RᵀR − 1| up to {} and determinant {}", number(off.amax()), number(determinant));
            return Err(bad(found, "a rotation: orthonormal with determinant +1"));
        }
        // Matrices from JSON files are often rounded; the polar decomposition projects them back to SO(3).
        Ok(Self { scale, rotation: nearest_rotation(rotation), translation })
    }

    /// A similarity from a column-major 4×4 matrix (three.js `Matrix4.elements`, glTF `node.matrix`).
    ///
    /// # Errors
    /// [`ErrorCode::InvalidTransform`] if the last row is not [0, 0, 0, 1], and as [`Similarity::from_parts`].
    pub fn from_column_major(m: &[f64; 16]) -> Result<Self> {
        let linear = Matrix3::new(m[0], m[4], m[8], m[1], m[5], m[9], m[2], m[6], m[10]);
        let volume = linear.determinant();
        if ![m[3], m[7], m[11], m[15] - 1.0].iter().all(|x| x.abs() <= 1e-9) {
            return Err(Error::new(
                ErrorCode::InvalidTransform,
                "transform.matrix",
                format!("last row {}", numbers(&[m[3], m[7], m[11], m[15]])),
                "last row [0, 0, 0, 1]",
                "The 16 numbers are column-major: elements 12 to 14 are the translation. Transpose a row-major matrix.",
            ));
        }
        let scale = cube_root(volume.abs());
        // Divides by zero if the scale is 0; `from_parts` checks the scale first.
        Self::from_parts(scale, linear / scale, Vector3::new(m[12], m[13], m[14]))
    }

    /// The column-major 4×4 matrix.
    #[inline(never)]
    pub fn to_column_major(&self) -> [f64; 16] {
        let [[a, b, c], [d, e, f], [g, h, i]] = (self.rotation.matrix() * self.scale).into();
        let [x, y, z] = self.translation.into();
        [a, b, c, 0.0, d, e, f, 0.0, g, h, i, 0.0, x, y, z, 1.0]
    }

    /// The rotation as a unit quaternion x, y, z, w with w ≥ 0.
    #[inline(never)]
    pub fn quaternion_xyzw(&self) -> [f64; 4] {
        let q = UnitQuaternion::from_rotation_matrix(&self.rotation);
        let sign = if q.w < 0.0 { -1.0 } else { 1.0 };
        [q.i * sign, q.j * sign, q.k * sign, q.w * sign]
    }

    /// A rotation from a quaternion x, y, z, w of any length above 0.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidTransform`] for a zero quaternion or one that is not finite.
    pub fn rotation_from_xyzw(q: &[f64; 4]) -> Result<Matrix3<f64>> {
        let q = Quaternion::new(q[3], q[0], q[1], q[2]);
        if !(q.norm().is_finite() && q.norm() > 1e-12) {
            return Err(Error::new(
                ErrorCode::InvalidTransform,
                "transform.rotation",
                numbers(&[q.i, q.j, q.k, q.w]),
                "a quaternion x, y, z, w other than 0",
                "The identity is [0, 0, 0, 1].",
            ));
        }
        Ok(*UnitQuaternion::from_quaternion(q).to_rotation_matrix().matrix())
    }

    /// Applies the transform to a point: s·R·x + t.
    pub fn apply(&self, x: Vector3<f64>) -> Vector3<f64> {
        self.rotation * x * self.scale + self.translation
    }

    /// Composition, `inner` first: x ↦ self(inner(x)).
    #[inline(never)]
    pub fn compose(&self, inner: &Self) -> Self {
        Self {
            scale: self.scale * inner.scale,
            rotation: self.rotation * inner.rotation,
            translation: self.apply(inner.translation),
        }
    }

    /// The inverse transform.
    #[inline(never)]
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.inverse();
        let scale = 1.0 / self.scale;
        Self { scale, rotation, translation: -(rotation * self.translation) * scale }
    }

    /// The angle between the rotations of two transforms, in radians. Accurate near 0, unlike the arc cosine of the
    /// trace.
    pub fn rotation_angle_to(&self, other: &Self) -> f64 {
        let relative = self.rotation.matrix().transpose() * other.rotation.matrix();
        let sine = Vector3::new(
            relative[(2, 1)] - relative[(1, 2)],
            relative[(0, 2)] - relative[(2, 0)],
            relative[(1, 0)] - relative[(0, 1)],
        )
        .norm();
        libm::atan2(sine, relative.trace() - 1.0)
    }

    /// Converts to f32.
    pub fn to_f32(&self) -> SimilarityF32 {
        let linear = self.rotation.matrix() * self.scale;
        SimilarityF32 {
            linear: mat3(&linear),
            rotation: mat3(self.rotation.matrix()),
            translation: vec3(&self.translation),
        }
    }
}

/// A similarity in f32, for hot loops.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SimilarityF32 {
    /// s·R.
    pub linear: Mat3,
    /// R, for normals.
    pub rotation: Mat3,
    /// t.
    pub translation: Vec3,
}

impl SimilarityF32 {
    /// s·R·x + t.
    #[inline]
    pub fn apply(&self, x: Vec3) -> Vec3 {
        self.linear * x + self.translation
    }

    /// R·n.
    #[inline]
    pub fn rotate(&self, n: Vec3) -> Vec3 {
        self.rotation * n
    }
}

/// ∛x for x ≥ 0: exp(ln x / 3) and one Newton step. `libm::cbrt` would be linked for this use alone.
fn cube_root(x: f64) -> f64 {
    let root = libm::exp(libm::log(x) / 3.0);
    // Not for 0 and non-finite values.
    if root.is_normal() { root - (root - x / (root * root)) / 3.0 } else { root }
}

/// The rotation nearest to an almost orthonormal matrix, by Newton's iteration for the polar decomposition. The error
/// is squared in each step, so that three steps reduce 1e-3 below the rounding of f64.
pub fn nearest_rotation(mut m: Matrix3<f64>) -> Rotation3<f64> {
    for _ in 0..3 {
        if let Some(inverse) = m.try_inverse() {
            m = (m + inverse.transpose()) * 0.5;
        }
    }
    Rotation3::from_matrix_unchecked(m)
}

/// Converts an f64 vector (nalgebra) to f32 (glam).
pub fn vec3(v: &Vector3<f64>) -> Vec3 {
    Vec3::new(v.x as f32, v.y as f32, v.z as f32)
}

/// Converts an f32 vector (glam) to f64 (nalgebra).
pub fn vector3(v: Vec3) -> Vector3<f64> {
    Vector3::new(f64::from(v.x), f64::from(v.y), f64::from(v.z))
}

/// Converts an f64 matrix (nalgebra) to f32 (glam).
fn mat3(m: &Matrix3<f64>) -> Mat3 {
    let columns: [[f64; 3]; 3] = (*m).into();
    Mat3::from_cols_array_2d(&columns.map(|column| column.map(|x| x as f32)))
}
