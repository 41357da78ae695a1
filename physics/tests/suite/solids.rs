//! Solids whose volume is known, and seeded draws.

use glam::{DQuat, DVec3, Vec3};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use sim3align_geometry::mesh::Mesh;
use sim3align_geometry::random::Random;
use sim3align_geometry::similarity::Similarity;
use sim3align_physics::part::ConvexPart;

/// A box from one corner to the opposite one, with outward faces.
pub fn cuboid(low: Vec3, high: Vec3) -> Mesh {
    let positions = (0..8u32).map(|i| {
        let side = |axis: usize| if i >> axis & 1 == 1 { high[axis] } else { low[axis] };
        Vec3::new(side(0), side(1), side(2))
    });
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh::new(positions.collect(), triangles).unwrap()
}

/// Meshes side by side in one.
pub fn together(meshes: &[Mesh]) -> Mesh {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for mesh in meshes {
        let first = positions.len() as u32;
        triangles.extend(mesh.triangles().iter().map(|t| t.map(|i| i + first)));
        positions.extend_from_slice(mesh.positions());
    }
    Mesh::new(positions, triangles).unwrap()
}

/// An L of two boxes, which share a face: 3 litres.
pub fn bracket() -> Mesh {
    together(&[
        cuboid(Vec3::ZERO, Vec3::new(0.2, 0.1, 0.1)),
        cuboid(Vec3::new(0.0, 0.0, 0.1), Vec3::new(0.1, 0.1, 0.2)),
    ])
}

/// A tray of five plates, and its volume.
pub fn tray() -> (Mesh, f64) {
    let plates = [
        [[0.0, 0.0, 0.0], [0.2, 0.2, 0.02]],
        [[0.0, 0.0, 0.02], [0.02, 0.2, 0.1]],
        [[0.18, 0.0, 0.02], [0.2, 0.2, 0.1]],
        [[0.02, 0.0, 0.02], [0.18, 0.02, 0.1]],
        [[0.02, 0.18, 0.02], [0.18, 0.2, 0.1]],
    ]
    .map(|corners| corners.map(Vec3::from_array));
    let volume = plates.iter().map(|[a, b]| f64::from((b - a).element_product())).sum();
    (together(&plates.map(|[a, b]| cuboid(a, b))), volume)
}

/// Seeded draws.
pub struct Draw(Random);

impl Draw {
    /// The draws of a test under `seed`.
    pub fn new(seed: u64) -> Self {
        Self(Random::new(seed, 1900))
    }

    /// In [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.uniform()
    }

    /// In [low, high)³.
    pub fn vector(&mut self, low: f64, high: f64) -> DVec3 {
        DVec3::from_array([0; 3].map(|_| self.between(low, high)))
    }

    /// A rotation.
    pub fn rotation(&mut self) -> DQuat {
        let turn = self.between(0.0, core::f64::consts::PI);
        DQuat::from_axis_angle((self.vector(-1.0, 1.0) + DVec3::Z * 1e-3).normalize(), turn)
    }
}

/// A similarity of its parts.
pub fn similarity(scale: f64, rotation: DQuat, translation: DVec3) -> Similarity {
    let [x, y, z, w] = rotation.to_array();
    Similarity {
        scale,
        rotation: UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)).to_rotation_matrix(),
        translation: Vector3::from(translation.to_array()),
    }
}

/// A similarity that only moves.
pub fn moved(x: f64, y: f64, z: f64) -> Similarity {
    similarity(1.0, DQuat::IDENTITY, DVec3::new(x, y, z))
}

/// Whether numbers agree, relative to the second one.
pub fn is_near(a: f64, b: f64, relative: f64) -> bool {
    (a - b).abs() <= relative * b.abs()
}

/// How far a point is outside of a convex part, metres: 0 inside.
pub fn outside(part: &ConvexPart, p: DVec3) -> f64 {
    let beyond = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).normalize_or_zero().dot(p - a);
    part.corners().map(beyond).fold(0.0, f64::max)
}
