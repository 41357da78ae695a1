//! Other poses that explain an observation as well: flips and mirror turns, told from repetitions of one placement.

use glam::DVec3;

use super::search::{Found, Search};
use crate::error::Result;
use crate::geometry::mesh::Mesh;
use crate::geometry::order::quantile;
use crate::geometry::rotations::angle_between;
use crate::geometry::triangle_tree::TriangleTree;
use crate::metrics::symmetry::{AUTO_MEAN, AUTO_TAIL, Symmetry};
use crate::report::Alternative;

/// How far below the best a score is still within what noise does to it: on generated cases, the truth's is that far
/// below where a flip won.
pub(super) const NOISE: f32 = 0.15;
/// Smallest turn that makes another pose, radians.
const MIN_TURN: f64 = 0.26;
/// Vertices that are compared to tell whether two poses place the mesh alike.
const SAMPLES: usize = 300;
/// A turn this near to a declared symmetry is one, radians.
const SAME_TURN: f64 = 0.17;

/// The poses after the first that are within noise of it, and neither near it, nor near one another, nor placements
/// that the object's symmetry makes the same.
pub(super) fn alternatives(
    found: &[Found],
    search: &Search,
    mesh: &Mesh,
    symmetry: &Symmetry,
) -> Result<Vec<Alternative>> {
    let Some((best, others)) = found.split_first() else { return Ok(Vec::new()) };
    let turn = |a: &Found, b: &Found| angle_between(a.pose.rotation, b.pose.rotation);
    let likely: Vec<&Found> =
        others.iter().filter(|o| o.score.total > best.score.total - NOISE && turn(best, o) > MIN_TURN).collect();
    if likely.is_empty() {
        return Ok(Vec::new());
    }
    let likeness = Likeness::new(search, mesh, symmetry)?;
    let mut kept = vec![best];
    for other in likely {
        if kept.iter().all(|k| turn(k, other) > MIN_TURN && !likeness.same(k, other)) {
            kept.push(other);
        }
    }
    let report = |other: &&Found| Alternative {
        camera_from_mesh: (&other.pose.similarity(&search.mesh.frame)).into(),
        score: f64::from(other.score.total),
        turn_deg: turn(best, other).to_degrees(),
    };
    Ok(kept.iter().skip(1).map(report).collect())
}

/// What tells whether two poses place the mesh alike.
enum Likeness {
    /// They never do.
    Never,
    /// Where the turn between them is one of these.
    Turns(Box<crate::metrics::symmetry::SymmetryGroup>),
    /// Where the surfaces coincide.
    Surfaces(Box<TriangleTree>, Vec<DVec3>),
}

impl Likeness {
    fn new(search: &Search, mesh: &Mesh, symmetry: &Symmetry) -> Result<Self> {
        Ok(match symmetry {
            Symmetry::None => Self::Never,
            Symmetry::Declared(_) => Self::Turns(Box::new(symmetry.group(mesh)?)),
            Symmetry::Auto | Symmetry::AutoRevolution => {
                let positions = search.mesh.fine.positions();
                let step = positions.len().div_ceil(SAMPLES).max(1);
                let samples = positions.iter().step_by(step).map(|p| p.as_dvec3()).collect();
                Self::Surfaces(Box::new(TriangleTree::new(&search.mesh.fine)), samples)
            }
        })
    }

    fn same(&self, a: &Found, b: &Found) -> bool {
        match self {
            Self::Never => false,
            Self::Turns(group) => {
                let turn = a.pose.rotation.conjugate() * b.pose.rotation;
                let turn = nalgebra::UnitQuaternion::new_normalize(nalgebra::Quaternion::from(turn.to_array()));
                group.nearest(&turn).angle_to(&turn) < SAME_TURN
            }
            Self::Surfaces(tree, samples) => coincide(tree, samples, a, b),
        }
    }
}

/// Whether the mesh under one pose lies on itself under the other, within the tolerance of automatic symmetry.
fn coincide(tree: &TriangleTree, samples: &[DVec3], a: &Found, b: &Found) -> bool {
    let (scale_b, origin_b) = b.pose.scale_translation();
    let (scale, origin) = a.pose.scale_translation();
    let back = a.pose.rotation.conjugate();
    let distance = |p: &DVec3| {
        let point = back * (b.pose.rotation * *p * scale_b + origin_b - origin) / scale;
        tree.nearest(point.as_vec3()).map_or(f32::INFINITY, |s| s.distance_squared.sqrt())
    };
    let distances: Vec<f32> = samples.iter().map(distance).collect();
    let mean = distances.iter().map(|d| f64::from(*d)).sum::<f64>() / distances.len().max(1) as f64;
    let tail = quantile(distances.iter().copied(), 0.95).map_or(f64::INFINITY, f64::from);
    // Two refinements end somewhat apart: twice the tolerance of one turn.
    mean <= 2.0 * AUTO_MEAN && tail <= 2.0 * AUTO_TAIL
}
