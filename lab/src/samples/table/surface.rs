//! The surface of an object in the world, with smooth normals.

use std::collections::HashMap;

use crate::cases::distortion::mapped;
use crate::prelude::*;

/// Surfaces that meet at a larger angle have an edge between them: its cosine.
const CREASE: f64 = 0.75;
/// At most so many times each triangle is split in four.
const MOST_SPLITS: usize = 8;

/// A surface in the world frame.
pub struct Surface {
    mesh: Mesh,
    /// Of each vertex, weighted by area.
    normals: Vec<Vector3<f64>>,
    object_from_world: Similarity,
    size: [Vector3<f64>; 2],
}

impl Surface {
    /// The surface of an object's mesh at its pose.
    pub fn new(object: &Mesh, world_from_object: &Similarity) -> Result<Self> {
        let mesh = mapped(object, |p| vec3(&world_from_object.apply(vector3(*p))))?;
        let mut normals = vec![Vector3::zeros(); mesh.positions().len()];
        for &triangle in mesh.triangles() {
            let normal = face(&mesh, triangle);
            triangle.iter().for_each(|&vertex| normals[vertex as usize] += normal);
        }
        let low = object.positions().iter().copied().fold(Vec3::INFINITY, Vec3::min);
        let high = object.positions().iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
        let size = [vector3(low), vector3(high)];
        Ok(Self { mesh, normals, object_from_world: world_from_object.inverse(), size })
    }

    /// In the world frame.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The surface in the object's frame.
    pub fn in_object(&self) -> Result<Mesh> {
        mapped(&self.mesh, |p| vec3(&self.object_from_world.apply(vector3(*p))))
    }

    /// The corners of the bounding box in the object's frame.
    pub fn size(&self) -> [Vector3<f64>; 2] {
        self.size
    }

    /// A point of a triangle in the object's frame, and the normal there in the world frame.
    pub fn at(&self, triangle: u32, point: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        let corners = self.mesh.triangles()[triangle as usize];
        let flat = face(&self.mesh, corners).normalize();
        let [a, b, c] = self.mesh.corners(corners).map(vector3);
        let area = (b - a).cross(&(c - a)).norm().max(f64::MIN_POSITIVE);
        let share = |p: Vector3<f64>, q: Vector3<f64>| (p - point).cross(&(q - point)).norm() / area;
        let weights = [share(b, c), share(c, a), share(a, b)];
        let smooth: Vector3<f64> = corners
            .iter()
            .zip(weights)
            .map(|(&vertex, weight)| {
                let own = self.normals[vertex as usize].normalize();
                weight * if own.dot(&flat) > CREASE { own } else { flat }
            })
            .sum();
        (self.object_from_world.apply(*point), smooth.normalize())
    }
}

/// The normal of a triangle, as long as twice its area.
fn face(mesh: &Mesh, triangle: [u32; 3]) -> Vector3<f64> {
    let [a, b, c] = mesh.corners(triangle).map(vector3);
    (b - a).cross(&(c - a))
}

/// A mesh with every triangle split in four that has a long edge, and its neighbours at that edge in two or three, until there
/// is none. Vertices may have several positions, which are split together.
pub fn split<const N: usize>(
    mut positions: Vec<[Vec3; N]>,
    mut triangles: Vec<[u32; 3]>,
    is_long: impl Fn(&[Vec3; N], &[Vec3; N]) -> bool,
) -> (Vec<[Vec3; N]>, Vec<[u32; 3]>) {
    for _ in 0..MOST_SPLITS {
        let mut middles: HashMap<(u32, u32), u32> = HashMap::new();
        let mut next = Vec::with_capacity(2 * triangles.len());
        for triangle in &triangles {
            let [a, b, c] = *triangle;
            let mut middle = |p: u32, q: u32| -> Option<u32> {
                let [from, to] = [positions[p as usize], positions[q as usize]];
                if !is_long(&from, &to) {
                    return None;
                }
                Some(*middles.entry((p.min(q), p.max(q))).or_insert_with(|| {
                    positions.push(core::array::from_fn(|k| 0.5 * (from[k] + to[k])));
                    positions.len() as u32 - 1
                }))
            };
            match [middle(a, b), middle(b, c), middle(c, a)] {
                [None, None, None] => next.push(*triangle),
                [Some(d), None, None] => next.extend([[a, d, c], [d, b, c]]),
                [None, Some(d), None] => next.extend([[b, d, a], [d, c, a]]),
                [None, None, Some(d)] => next.extend([[c, d, b], [d, a, b]]),
                [Some(d), Some(e), None] => next.extend([[a, d, c], [d, e, c], [d, b, e]]),
                [None, Some(d), Some(e)] => next.extend([[b, d, a], [d, e, a], [d, c, e]]),
                [Some(e), None, Some(d)] => next.extend([[c, d, b], [d, e, b], [d, a, e]]),
                [Some(d), Some(e), Some(f)] => next.extend([[a, d, f], [d, b, e], [f, e, c], [d, e, f]]),
            }
        }
        if next.len() == triangles.len() {
            break;
        }
        triangles = next;
    }
    (positions, triangles)
}
