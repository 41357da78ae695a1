//! Variants of cases that rows ask for: meshes with surplus parts, of other objects, and with a placement.

use super::row::Row;
use crate::case::{Case, CaseObject};
use crate::objects::mesh::{box_of, canonicalise, joined, mapped};
use crate::objects::solid::Solid;
use crate::objects::{Object, Pool};
use crate::prelude::*;

/// Radii and distances of floaters, relative to the diagonal.
const RADII: [f64; 2] = [0.02, 0.05];
const DISTANCES: [f64; 2] = [0.15, 0.6];
/// Extents of a plate relative to those of the object, and its thickness relative to the larger one.
const PLATES: [f64; 2] = [1.35, 1.9];
const THICKNESSES: [f64; 2] = [0.008, 0.03];
/// Standard deviations of simulated placements: of the logarithm of the size, of the turn about each axis (degrees) and of
/// the place along each (of the diameter). Their medians are those of 16 objects that SAM 3D Objects placed: 3.6 %, 5.8°,
/// 4.4 %.
const PLACEMENT: (f64, f64, f64) = (0.0534, 3.77, 0.0286);

named! {
    /// Parts that a generator adds.
    pub enum Surplus {
        /// Two to four blobs beside the object.
        Floaters = "floaters",
        /// A plate below it.
        Plate = "plate",
    }
}

/// The case as a row changes it. The draws follow from the names of case and object.
pub fn varied(case: &Case, row: &Row) -> Result<Case> {
    let mut case = case.clone();
    for (k, object) in case.objects.iter_mut().enumerate() {
        let frame = &mut case.frames[0];
        let random = &mut Random::new(u64::from(crc32fast::hash(case.name.as_bytes())), k as u64);
        if let (true, Some(truth)) = (row.initial && object.initial.is_none(), &frame.truths[k]) {
            object.initial = Some(misplaced(&object.mesh, truth, random)?);
        }
        if let (Some(surplus), Some(truth), Some(world_from_camera)) =
            (row.surplus, &frame.truths[k], &frame.world_from_camera)
        {
            let world_from_mesh = world_from_camera.compose(truth);
            let in_world = mapped(&object.mesh, |p| vec3(&world_from_mesh.apply(vector3(*p))))?;
            let mesh_from_world = world_from_mesh.inverse();
            let with_parts = surplus.added_to(&in_world, random)?;
            object.surplus = Some(mapped(&with_parts, |p| vec3(&mesh_from_world.apply(vector3(*p))))?);
        }
        if row.misfit {
            let (mesh, _) = canonicalise(&Object::draw(Pool::All, random)?.mesh, k as u64)?;
            let (name, class) = (object.name.clone(), "misfit".into());
            *object =
                CaseObject { name, class, mesh, surplus: None, colors: None, symmetry: Symmetry::Auto, initial: None };
            frame.truths[k] = None;
        }
    }
    Ok(case)
}

impl Surplus {
    /// The mesh, in a frame in which z is up, with these parts.
    fn added_to(self, mesh: &Mesh, random: &mut Random) -> Result<Mesh> {
        let (low, high) = box_of(mesh);
        let (center, diagonal) = ((low + high) * 0.5, (high - low).length());
        let mut solid = Solid::default();
        if self == Self::Floaters {
            for _ in 0..2 + random.below(3) {
                let towards = DVec3::from_array([0; 3].map(|_| normal(random))).normalize_or(DVec3::X);
                let away = diagonal * (0.5 + between(random, DISTANCES[0], DISTANCES[1]));
                let radii = DVec3::from_array([0; 3].map(|_| diagonal * between(random, RADII[0], RADII[1])));
                solid.at(DAffine3::from_translation(center + towards * away)).ellipsoid(radii);
            }
            return joined(&[mesh, &solid.finish()?.0]);
        }
        let larger = DVec2::new(between(random, PLATES[0], PLATES[1]), between(random, PLATES[0], PLATES[1]));
        let half = (high - low).truncate() * 0.5 * larger;
        let thickness = half.max_element() * 2.0 * between(random, THICKNESSES[0], THICKNESSES[1]);
        // The object is sunk in by a third of the plate.
        let at = DVec3::new(center.x, center.y, low.z - thickness / 6.0);
        solid.at(DAffine3::from_translation(at)).cuboid(half.extend(0.5 * thickness), 0.3 * thickness);
        joined(&[mesh, &solid.finish()?.0])
    }
}

/// A pose with the errors of a simulated placement, about the middle of the mesh.
fn misplaced(mesh: &Mesh, truth: &Similarity, random: &mut Random) -> Result<Similarity> {
    let middle = Bounds::of(mesh.positions()).map_or(Vec3::ZERO, |bounds| bounds.center());
    let (size, turn, place) = PLACEMENT;
    let mut vector = |deviation: f64| Vector3::from_fn(|_, _| deviation * normal(random));
    let scale = truth.scale * libm::exp(vector(size).x);
    let rotation = truth.rotation * Rotation3::from_scaled_axis(vector(turn.to_radians()));
    let moved = truth.apply(vector3(middle)) + vector(place * truth.scale * mesh.diagonal());
    Similarity::from_parts(scale, *rotation.matrix(), moved - rotation * vector3(middle) * scale)
}
