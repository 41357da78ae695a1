//! The surface of a mesh: points spread evenly over it, its moments, and the check for degenerate meshes.

use glam::{DMat3, DVec3, Vec3};

use crate::cloud::{Bounds, Cloud};
use crate::mesh::{Mesh, volume6};
use crate::random::Random;
use crate::symmetric_eigen::{SymmetricEigen, outer};
use sim3align_runtime::error::{Error, ErrorCode, Result};
use sim3align_runtime::number::number;

/// Random stream of [`each_surface_sample`].
const STREAM: u64 = 2;

/// Root-mean-square thickness, relative to the box diagonal, below which a surface is a plane (or, in its second
/// direction, a line). A sheet of A4 paper has 1.4e-4, a bank card 4e-3; the rounding of f32 vertices 1e-7.
pub const MIN_THICKNESS: f64 = 1e-4;

/// The thickness, relative to the box diagonal, from which on some of the triangles show that all of a mesh is no plane, and
/// about their number.
const CLEARLY_THICK: f64 = 0.01;
const FEW_TRIANGLES: usize = 4096;

/// Smallest and largest diagonal of a mesh's bounding box, mesh units. Beyond, squares of distances on the surface leave
/// the range of f32. An object of a metre has 1e9 in nanometres.
pub const DIAGONALS: [f64; 2] = [1e-15, 1e15];

/// Maximum number of triangles of a mesh: ten times those of generated meshes. With more, copies of the mesh alone would
/// take the memory that an alignment may.
pub const MAX_TRIANGLES: usize = 1 << 22;

/// A point on a mesh's surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceSample {
    /// Index of the triangle.
    pub triangle: usize,
    /// Barycentric weights of the triangle's second and third corner.
    pub weights: [f64; 2],
    /// Its position.
    pub point: Vec3,
    /// The unit normal of its triangle, outward.
    pub normal: Vec3,
}

/// `count` points spread evenly by area over the mesh's surface, each with its triangle's unit normal: those of
/// [`each_surface_sample`].
///
/// # Errors
/// As [`each_surface_sample`].
pub fn sample_surface(mesh: &Mesh, count: usize, seed: u64) -> Result<Cloud> {
    let mut cloud = Cloud { points: Vec::with_capacity(count), normals: Vec::with_capacity(count) };
    each_surface_sample(mesh, count, seed, &mut |sample| {
        cloud.points.push(sample.point);
        cloud.normals.push(sample.normal);
    })?;
    Ok(cloud)
}

/// Calls `visit` with `count` points spread evenly by area over the mesh's surface, in the order of the triangles.
///
/// Stratified: the cumulative area over all triangles is divided into `count` equal intervals with one point each, so
/// that a triangle with n intervals gets n ± 1 points. If the mesh faces inward (negative signed volume), all normals
/// are flipped.
///
/// # Errors
/// [`ErrorCode::DegenerateMesh`] if the area is 0 or not finite, or the diagonal beyond [`DIAGONALS`];
/// [`ErrorCode::FileTooLarge`] above [`MAX_TRIANGLES`].
pub fn each_surface_sample(mesh: &Mesh, count: usize, seed: u64, visit: &mut dyn FnMut(SurfaceSample)) -> Result<()> {
    check_triangles(mesh.triangles().len())?;
    // One pass for the areas and for `Mesh::signed_volume6`.
    let (mut total, mut volume) = (0.0, 0.0);
    let origin = mesh.positions().first().map_or(DVec3::ZERO, |p| p.as_dvec3());
    let ends: Vec<f64> = (mesh.triangles().iter())
        .map(|&t| {
            let corners = corners(mesh, t);
            volume += volume6(corners, origin);
            total += area_of(corners);
            total
        })
        .collect();
    check_area(total)?;
    check_diagonal(mesh)?;
    // The last triangle with area; rounding must not select one after it.
    let last = ends.partition_point(|&end| end < total).min(ends.len() - 1);
    let facing = if volume < 0.0 { -1.0 } else { 1.0 };

    let mut random = Random::new(seed, STREAM);
    let mut triangle = 0;
    for k in 0..count {
        let at = (k as f64 + random.uniform()) / count as f64 * total;
        while triangle < last && ends[triangle] <= at {
            triangle += 1;
        }
        let [a, b, c] = corners(mesh, mesh.triangles()[triangle]);
        // The square root makes the draw uniform in area (Osada et al. 2002, "Shape distributions", §3.1).
        let (r, w) = (random.uniform().sqrt(), random.uniform());
        let weights = [r * (1.0 - w), r * w];
        let point = (a + (b - a) * weights[0] + (c - a) * weights[1]).as_vec3();
        let normal = (area_vector([a, b, c]).normalize_or_zero() * facing).as_vec3();
        visit(SurfaceSample { triangle, weights, point, normal });
    }
    Ok(())
}

/// Rejects meshes whose pose or scale cannot be determined from any view: without area, planar, or collinear. Of a large mesh,
/// a few thousand triangles are enough to show that it is none of these.
///
/// # Errors
/// [`ErrorCode::DegenerateMesh`], from the thickness along the principal axes (see [`MIN_THICKNESS`]), and those of
/// [`each_surface_sample`].
pub fn check_shape(mesh: &Mesh) -> Result<()> {
    check_triangles(mesh.triangles().len())?;
    // Unused vertices only make it larger, and the mesh thinner.
    let diagonal = mesh.diagonal();
    let thickness = |moments: &SurfaceMoments, diagonal: f64| {
        moments.principal_axes().values.map(|variance| variance.max(0.0).sqrt() / diagonal)
    };
    let some = SurfaceMoments::of_triangles(mesh, mesh.triangles().len().div_ceil(FEW_TRIANGLES));
    if is_usual(diagonal) && thickness(&some, diagonal)[0] > CLEARLY_THICK {
        return Ok(());
    }
    let moments = SurfaceMoments::of(mesh);
    check_area(moments.area)?;
    let [thin, middle, _] = thickness(&moments, check_diagonal(mesh)?);
    let degenerate = |found: String, remedy: &str| {
        Err(Error::new(ErrorCode::DegenerateMesh, "mesh", found, "a surface around a volume", remedy.to_owned()))
    };
    if middle < MIN_THICKNESS {
        return degenerate(
            format!("a needle: {} of its diagonal thick in two directions", number(middle)),
            "Check that the vertices are x, y, z triples and that no axis was scaled to zero.",
        );
    }
    if thin < MIN_THICKNESS {
        return degenerate(
            format!("a plane: {} of its diagonal thick", number(thin)),
            "Pass the whole object's mesh, not a flat patch; a sheet needs a thickness of its own.",
        );
    }
    Ok(())
}

/// Area, centroid and covariance of a surface with uniform weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceMoments {
    /// Total area.
    pub area: f64,
    /// Centroid of the surface.
    pub centroid: DVec3,
    /// Mean of (x − centroid)(x − centroid)ᵀ.
    pub covariance: DMat3,
}

impl SurfaceMoments {
    /// The moments of a mesh's surface, integrated exactly. All zero for a mesh without area.
    pub fn of(mesh: &Mesh) -> Self {
        Self::of_triangles(mesh, 1)
    }

    /// The moments of every `step`-th triangle.
    #[inline(never)]
    fn of_triangles(mesh: &Mesh, step: usize) -> Self {
        // Relative to a vertex: second moments about a distant origin would lose the precision of the covariance.
        let origin = mesh.positions().first().map_or(DVec3::ZERO, |p| p.as_dvec3());
        let (mut area, mut first, mut second) = (0.0, DVec3::ZERO, DMat3::ZERO);
        for &triangle in mesh.triangles().iter().step_by(step.max(1)) {
            let [a, b, c] = corners(mesh, triangle).map(|p| p - origin);
            let weight = area_of([a, b, c]);
            let sum = a + b + c;
            area += weight;
            first += sum * (weight / 3.0);
            // ∫ x xᵀ over a triangle is A/12 · (Σ vᵢvᵢᵀ + (Σ vᵢ)(Σ vᵢ)ᵀ).
            second += (outer(a) + outer(b) + outer(c) + outer(sum)) * (weight / 12.0);
        }
        if area == 0.0 {
            return Self { area, centroid: origin, covariance: DMat3::ZERO };
        }
        let mean = first / area;
        Self { area, centroid: origin + mean, covariance: second * (1.0 / area) - outer(mean) }
    }

    /// The principal axes, the thinnest first; the values are variances.
    pub fn principal_axes(&self) -> SymmetricEigen {
        SymmetricEigen::of(self.covariance)
    }
}

#[inline(always)]
fn corners(mesh: &Mesh, triangle: [u32; 3]) -> [DVec3; 3] {
    let [a, b, c] = mesh.corners(triangle);
    [a.as_dvec3(), b.as_dvec3(), c.as_dvec3()]
}

/// The area of a mesh's surface.
pub fn surface_area(mesh: &Mesh) -> f64 {
    (0..mesh.triangles().len()).map(|triangle| triangle_area(mesh, triangle)).sum()
}

/// The area of the triangle with this index; 0 if there is none.
pub fn triangle_area(mesh: &Mesh, triangle: usize) -> f64 {
    mesh.triangles().get(triangle).map_or(0.0, |&t| area_of(corners(mesh, t)))
}

// `DVec3::length` calls libm, which takes the square root in software: the time of all else here.
#[inline(always)]
fn area_of(corners: [DVec3; 3]) -> f64 {
    area_vector(corners).length_squared().sqrt()
}

/// The vector along the normal whose length is the area of the triangle.
#[inline(always)]
fn area_vector([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a) * 0.5
}

fn is_usual(diagonal: f64) -> bool {
    (DIAGONALS[0]..=DIAGONALS[1]).contains(&diagonal)
}

/// Checks the diagonal of the bounding box; unused vertices are ignored. In 64 bits: the squares of what is refused are
/// beyond 32 bits.
fn check_diagonal(mesh: &Mesh) -> Result<f64> {
    let used = mesh.without_unused_vertices();
    let Bounds { min, max } = Bounds::of(used.as_ref().unwrap_or(mesh).positions()).unwrap_or(Bounds::NOTHING);
    let diagonal = (max.as_dvec3() - min.as_dvec3()).length();
    if is_usual(diagonal) {
        return Ok(diagonal);
    }
    Err(Error::new(
        ErrorCode::DegenerateMesh,
        "mesh",
        format!("a bounding box with a diagonal of {}", number(diagonal)),
        format!("a diagonal from {} to {}", number(DIAGONALS[0]), number(DIAGONALS[1])),
        "Scale the mesh to any usual unit, such as metres or millimetres.",
    ))
}

/// Checks the number of a mesh's triangles.
///
/// # Errors
/// [`ErrorCode::FileTooLarge`] above [`MAX_TRIANGLES`].
pub fn check_triangles(count: usize) -> Result<()> {
    if count <= MAX_TRIANGLES {
        return Ok(());
    }
    Err(Error::new(
        ErrorCode::FileTooLarge,
        "mesh",
        format!("{count} triangles"),
        format!("at most {MAX_TRIANGLES}"),
        "Simplify the mesh: the search uses ten thousand triangles at most.",
    ))
}

fn check_area(total: f64) -> Result<()> {
    if total > 0.0 && total.is_finite() {
        return Ok(());
    }
    Err(Error::new(
        ErrorCode::DegenerateMesh,
        "mesh",
        format!("triangles with a total area of {}", number(total)),
        "a surface with area",
        "Check that the vertices are x, y, z triples and that the indices do not all refer to one vertex.",
    ))
}
