//! Objects before observation: metres, z up, standing on the plane z = 0.

use super::solid::Solid;
use crate::prelude::*;

/// An axis of symmetry in the object's frame: direction, and how many times it looks the same in a full turn.
pub type Axis = (DVec3, Option<u32>);

/// An object under construction by a family.
#[derive(Debug, Default)]
pub struct Draft {
    /// The parts.
    pub solid: Solid,
    /// The symmetry of the object.
    pub symmetry: Vec<Axis>,
    /// Parts of which at least one must be visible to determine the orientation.
    pub keys: Vec<usize>,
    /// Parts that a generator may omit, and the symmetry without them.
    pub losable: Vec<(usize, Vec<Axis>)>,
}

/// An object.
#[derive(Debug, Clone)]
pub struct Object {
    /// Name of the family or the mesh file.
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
    /// Whether it rests on any side, instead of mostly upright.
    pub any_side_up: bool,
}

impl Object {
    /// The diagonal of its bounding box, metres.
    pub fn diagonal(&self) -> f64 {
        self.mesh.diagonal()
    }
}
