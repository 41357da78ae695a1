//! Objects before observation: metres, z up, standing on the plane z = 0.

use glam::DVec3;

use super::solid::Solid;
use sim3align_geometry::cloud::Bounds;
use sim3align_geometry::mesh::Mesh;

/// An axis of symmetry in the object's frame: direction, and how many times it looks the same in a full turn.
pub type Axis = (DVec3, Option<u32>);

/// What a family makes.
#[derive(Debug, Default)]
pub struct Draft {
    /// The parts.
    pub solid: Solid,
    /// The object's symmetry.
    pub symmetry: Vec<Axis>,
    /// Parts of which at least one has to be seen to tell how the object is turned.
    pub keys: Vec<usize>,
    /// Parts that a generator may lose, and the symmetry without them.
    pub losable: Vec<(usize, Vec<Axis>)>,
}

/// An object.
#[derive(Debug, Clone)]
pub struct Object {
    /// The family's, or the file's, name.
    pub family: String,
    /// The surface.
    pub mesh: Mesh,
    /// The part of each triangle.
    pub parts: Vec<usize>,
    /// See [`Draft::symmetry`].
    pub symmetry: Vec<Axis>,
    /// See [`Draft::keys`].
    pub keys: Vec<usize>,
    /// See [`Draft::losable`].
    pub losable: Vec<(usize, Vec<Axis>)>,
    /// Whether it lies in any way, or mostly as it is made.
    pub any_side_up: bool,
}

impl Object {
    /// The diagonal of the box around it, metres.
    pub fn diagonal(&self) -> f64 {
        Bounds::of(self.mesh.positions()).map_or(0.0, |b| f64::from(b.diagonal()))
    }
}
