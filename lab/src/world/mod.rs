//! Scenes: objects and what stands around them, and cameras that see them.

mod desk;
pub mod view;

use std::sync::Arc;

use crate::conditions::Tier;
use crate::objects::mesh::{bounds, box_of, mapped, random_rotation, shifted, turned_axes};
use crate::objects::print::{Print, PrintKind};
use crate::objects::{Axis, Object};
use crate::prelude::*;

/// An object at its place.
#[derive(Debug, Clone)]
pub struct Placed {
    /// The object in its own frame.
    pub object: Arc<Object>,
    /// Its surface in the world's frame.
    pub mesh: Mesh,
    /// Its axes of symmetry there.
    pub symmetry: Vec<Axis>,
    /// Its print, if it is coloured.
    pub print: Option<Print>,
}

/// A scene before a camera sees it: metres, z up, the table at z = 0.
#[derive(Debug)]
pub struct World {
    pub objects: Vec<Placed>,
    pub others: Vec<Mesh>,
    /// The wall: its normal, and its distance behind the origin.
    pub wall: (Vector3<f64>, f64),
    /// The middle of the box of the objects.
    pub center: DVec3,
    /// Distance from `center` to the farthest vertex of an object.
    pub reach: f64,
    /// The angle about z from which cameras look.
    pub front: f64,
}

impl Placed {
    /// A rotated object on z = 0, above the origin.
    pub fn turned(object: Object, rotation: &Matrix3<f64>) -> Result<Self> {
        let turned = mapped(&object.mesh, |p| vec3(&(rotation * vector3(*p))))?;
        let (low, high) = box_of(&turned);
        let down = ((low + high) * 0.5).with_z(low.z);
        let mesh = shifted(&turned, -down)?;
        let symmetry = turned_axes(rotation, &object.symmetry);
        Ok(Self { object: Arc::new(object), mesh, symmetry, print: None })
    }

    /// An object on z = 0: mostly upright, else on a side or as it fell.
    pub fn put_down(object: Object, tier: Tier, random: &mut Random) -> Result<Self> {
        let about = |axis, angle| Rotation3::from_axis_angle(&axis, angle);
        let heading = about(Vector3::z_axis(), TAU * random.uniform());
        let rotation = if random.uniform() < tier.pick(0.9, 0.75, 0.6) {
            heading
        } else if chance(random, 0.6) {
            heading * about(Vector3::x_axis(), 0.25 * TAU * random.below(4) as f64)
        } else {
            random_rotation(random).to_rotation_matrix()
        };
        Self::turned(object, rotation.matrix())
    }

    /// The object with a print.
    pub fn printed(self, kind: Option<PrintKind>, random: &mut Random) -> Self {
        let print = kind.map(|kind| Print::draw(&self.mesh, &self.symmetry, kind, random));
        Self { print, ..self }
    }
}

impl World {
    /// A world of objects. `front` is the angle about z from which cameras look, and `behind` how far the wall is behind
    /// objects and things.
    pub fn new(objects: Vec<Placed>, others: Vec<Mesh>, front: f64, behind: f64) -> Self {
        let center = center_of(&objects);
        let reach = points(&objects).fold(0.0f64, |far, p| far.max(p.distance(center)));
        let faces = unit(front).extend(0.0);
        let all = points(&objects).chain(others.iter().flat_map(|mesh| mesh.positions()).map(|p| p.as_dvec3()));
        let depth = all.fold(0.0f64, |far, p| far.max(-p.dot(faces)));
        let wall = (Vector3::from(faces.to_array()), depth + behind);
        Self { objects, others, wall, center, reach, front }
    }
}

/// The vertices of objects.
fn points(objects: &[Placed]) -> impl Iterator<Item = DVec3> {
    objects.iter().flat_map(|placed| placed.mesh.positions()).map(|p| p.as_dvec3())
}

/// The middle of the box of objects.
fn center_of(objects: &[Placed]) -> DVec3 {
    let (low, high) = bounds(points(objects));
    (low + high) * 0.5
}

/// The unit vector in the plane at an angle, radians.
pub fn unit(angle: f64) -> DVec2 {
    let (sine, cosine) = libm::sincos(angle);
    DVec2::new(cosine, sine)
}
