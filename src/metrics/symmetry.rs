//! Which turns leave an object as it is.

use glam::DVec3;
use nalgebra::{Unit, UnitQuaternion, Vector3};

use crate::error::{Error, ErrorCode, Result};
use crate::evidence::sample::{SurfaceMoments, sample_surface};
use crate::geometry::angle::sin_cos;
use crate::geometry::mesh::Mesh;
use crate::geometry::order::quantile;
use crate::geometry::similarity::{vec3, vector3};
use crate::geometry::triangle_tree::TriangleTree;
use crate::number::numbers;

/// Mean distance between a surface and its turned self, as a share of the diagonal of the box around the mesh,
/// up to which [`Symmetry::Auto`] calls the turn a symmetry. On scanned objects, real symmetries gave 0.1 to
/// 0.5 %, a bottle stood on its head 1.8 %, no likeness at all 3 % and more.
pub const AUTO_MEAN: f64 = 0.01;

/// The same for the 95th percentile, by which a small part that does not fit, such as a handle, shows. Real
/// symmetries gave 0.2 to 1.4 %, the bottle on its head 6.6 %.
pub const AUTO_TAIL: f64 = 0.03;

/// Largest finite group told apart from a mistake; the turns of an icosahedron are 60.
const MAX_ELEMENTS: usize = 720;

/// Elements nearer than this (1 − |cos half angle|) are one; 1e-9 is an angle of 0.005°.
const SAME_TURN: f64 = 1e-9;

/// Points that [`Symmetry::Auto`] compares.
const AUTO_SAMPLES: usize = 2000;

/// What is known of an object's rotational symmetry. All axes pass through the centroid of its surface, which
/// every symmetry of the surface leaves in place.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Symmetry {
    /// None.
    #[default]
    None,
    /// These axes, and all turns that follow from them.
    Declared(Vec<SymmetryAxis>),
    /// The half turns about the principal axes of the surface that the mesh itself shows to be symmetries (see
    /// [`AUTO_MEAN`]). Other symmetries, and those of a shape whose principal axes are not determined (a
    /// cube, a square prism turned at random), have to be declared.
    Auto,
    /// [`Symmetry::Auto`], and every turn about those principal axes that are axes of revolution.
    AutoRevolution,
}

/// An axis of symmetry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SymmetryAxis {
    /// Direction in the mesh frame, of any length above 0.
    pub axis: Vector3<f64>,
    /// How many times the object looks the same in a full turn; `None` for any turn (a surface of revolution).
    pub fold: Option<u32>,
}

impl Symmetry {
    /// From a word, as data sets give it: text starting with `discrete` is [`Symmetry::Auto`], with `continuous`
    /// [`Symmetry::AutoRevolution`]; anything else (`none`, `unknown`) is [`Symmetry::None`].
    pub fn from_description(text: &str) -> Self {
        let text = text.trim().to_ascii_lowercase();
        if text.starts_with("discrete") {
            Self::Auto
        } else if text.starts_with("continuous") {
            Self::AutoRevolution
        } else {
            Self::None
        }
    }

    /// The turns themselves.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidOption`] for an axis of no length, a fold of 0, or axes that do not generate a finite
    /// group; [`ErrorCode::DegenerateMesh`] where an automatic one meets a mesh without area.
    pub fn group(&self, mesh: &Mesh) -> Result<SymmetryGroup> {
        match self {
            Self::None => SymmetryGroup::generated(&[]),
            Self::Declared(axes) => SymmetryGroup::generated(axes),
            Self::Auto => SymmetryGroup::generated(&principal_symmetry(mesh, false)?),
            Self::AutoRevolution => SymmetryGroup::generated(&principal_symmetry(mesh, true)?),
        }
    }
}

/// A group of rotations: finitely many, each followed by any turn about `continuous` where there is one.
#[derive(Debug, Clone, PartialEq)]
pub struct SymmetryGroup {
    discrete: Vec<UnitQuaternion<f64>>,
    continuous: Option<Unit<Vector3<f64>>>,
    /// Any rotation at all: two axes of revolution.
    sphere: bool,
}

impl SymmetryGroup {
    /// The member nearest to `rotation`.
    pub fn nearest(&self, rotation: &UnitQuaternion<f64>) -> UnitQuaternion<f64> {
        if self.sphere {
            return *rotation;
        }
        let mut best = (f64::NEG_INFINITY, UnitQuaternion::identity());
        for element in &self.discrete {
            let member = match &self.continuous {
                Some(axis) => element * twist(&(element.inverse() * rotation), axis),
                None => *element,
            };
            let cosine = member.coords.dot(&rotation.coords).abs();
            if cosine > best.0 {
                best = (cosine, member);
            }
        }
        best.1
    }

    fn generated(axes: &[SymmetryAxis]) -> Result<Self> {
        let mut group = Self { discrete: vec![UnitQuaternion::identity()], continuous: None, sphere: false };
        let mut generators = Vec::new();
        for declared in axes {
            let axis = Unit::try_new(declared.axis, 1e-12).filter(|a| a.iter().all(|x| x.is_finite()));
            let axis =
                axis.ok_or_else(|| invalid(format!("axis {}", numbers(declared.axis.as_slice())), "a direction"))?;
            match declared.fold {
                Some(0) => return Err(invalid("fold 0".into(), "a fold of at least 1, or none for any turn")),
                Some(fold) => {
                    let (sin, cos) = sin_cos(core::f64::consts::PI / f64::from(fold));
                    let turn = nalgebra::Quaternion::from_parts(cos, axis.into_inner() * sin);
                    generators.push(UnitQuaternion::new_normalize(turn));
                }
                None => match group.continuous {
                    None => group.continuous = Some(axis),
                    Some(first) => group.sphere |= !parallel(&first, &axis),
                },
            }
        }
        // Turns about the continuous axis are in the group already, whatever their fold.
        if let Some(axis) = group.continuous {
            group.sphere |= generators.iter().any(|g| !parallel(&axis, &(g * axis)));
            generators.retain(|g| !same(&twist(g, &axis), g));
        }
        if group.sphere {
            return Ok(group);
        }
        let mut next = 0;
        while next < group.discrete.len() {
            for generator in &generators {
                let element = group.discrete[next] * generator;
                if !group.discrete.iter().any(|known| same(known, &element)) {
                    group.discrete.push(element);
                }
            }
            if group.discrete.len() > MAX_ELEMENTS {
                return Err(invalid(
                    format!("axes that generate more than {MAX_ELEMENTS} turns"),
                    "the axes of a finite group, or a fold of none for any turn",
                ));
            }
            next += 1;
        }
        Ok(group)
    }
}

/// The turn about `axis` nearest to `rotation` (the twist of its swing-twist decomposition).
fn twist(rotation: &UnitQuaternion<f64>, axis: &Unit<Vector3<f64>>) -> UnitQuaternion<f64> {
    let along = rotation.vector().dot(axis);
    let twist = nalgebra::Quaternion::from_parts(rotation.w, axis.into_inner() * along);
    // A half turn about a perpendicular axis has no twist: all turns are equally near.
    UnitQuaternion::try_new(twist, 1e-12).unwrap_or_else(UnitQuaternion::identity)
}

fn same(a: &UnitQuaternion<f64>, b: &UnitQuaternion<f64>) -> bool {
    1.0 - a.coords.dot(&b.coords).abs() < SAME_TURN
}

fn parallel(a: &Unit<Vector3<f64>>, b: &Unit<Vector3<f64>>) -> bool {
    a.cross(b).norm() < 1e-6
}

fn invalid(found: String, expected: &str) -> Error {
    Error::new(
        ErrorCode::InvalidOption,
        "symmetry",
        found,
        expected.to_owned(),
        "Give each axis of symmetry once, in the mesh's frame, with its fold.",
    )
}

/// The principal axes of the surface about which the mesh turns into itself: by half a turn or, where `revolution`
/// allows it, by any.
///
/// # Errors
/// [`ErrorCode::DegenerateMesh`] for a mesh without area.
pub fn principal_symmetry(mesh: &Mesh, revolution: bool) -> Result<Vec<SymmetryAxis>> {
    let samples = sample_surface(mesh, AUTO_SAMPLES, 0)?.points;
    let moments = SurfaceMoments::of(mesh);
    let tree = TriangleTree::new(mesh);
    let center = vector_of(moments.centroid);
    let diagonal = mesh_diagonal(mesh);
    let maps_onto_itself = |axis: &Unit<Vector3<f64>>, share: f64| {
        let (sin, cos) = sin_cos(core::f64::consts::PI * share);
        let turn = UnitQuaternion::new_normalize(nalgebra::Quaternion::from_parts(cos, axis.into_inner() * sin));
        let distance = |p: &glam::Vec3| {
            let turned = turn * (vector3(*p) - center) + center;
            tree.nearest(vec3(&turned)).map_or(f64::INFINITY, |s| f64::from(s.distance_squared).sqrt())
        };
        let distances: Vec<f64> = samples.iter().map(distance).collect();
        let tail = quantile(distances.iter().map(|&d| d as f32), 0.95).map_or(f64::INFINITY, f64::from);
        let mean = distances.iter().sum::<f64>() / distances.len() as f64;
        mean <= AUTO_MEAN * diagonal && tail <= AUTO_TAIL * diagonal
    };
    let mut axes = Vec::new();
    for direction in moments.principal_axes().vectors {
        let axis = Unit::new_normalize(vector_of(direction));
        // Turns that no regular polygon of few sides shares.
        let revolves = || [0.07, 0.13, 0.19, 0.29, 0.37, 0.43].iter().all(|&share| maps_onto_itself(&axis, share));
        if revolution && revolves() {
            axes.push(SymmetryAxis { axis: axis.into_inner(), fold: None });
        } else if maps_onto_itself(&axis, 0.5) {
            axes.push(SymmetryAxis { axis: axis.into_inner(), fold: Some(2) });
        }
    }
    Ok(axes)
}

fn vector_of(v: DVec3) -> Vector3<f64> {
    Vector3::new(v.x, v.y, v.z)
}

/// The diagonal of the box around the vertices.
pub(super) fn mesh_diagonal(mesh: &Mesh) -> f64 {
    crate::geometry::cloud::Bounds::of(mesh.positions()).map_or(0.0, |b| f64::from(b.diagonal()))
}
