//! Parts that generators add to the mesh of an object: floaters, a plate of ground below.

use crate::conditions::Surplus;
use crate::objects::mesh::{box_of, joined};
use crate::objects::solid::Solid;
use crate::prelude::*;

/// Radii and distances of floaters, relative to the diagonal.
const RADII: [f64; 2] = [0.02, 0.05];
const DISTANCES: [f64; 2] = [0.15, 0.6];
/// Extents of a plate relative to those of the object, and its thickness relative to the larger one.
const PLATES: [f64; 2] = [1.35, 1.9];
const THICKNESSES: [f64; 2] = [0.008, 0.03];

impl Surplus {
    /// The mesh, in a frame in which z is up, with these parts.
    pub fn added_to(self, mesh: &Mesh, random: &mut Random) -> Result<Mesh> {
        let (low, high) = box_of(mesh);
        let (center, diagonal) = ((low + high) * 0.5, (high - low).length());
        let mut solid = Solid::default();
        match self {
            Self::Floaters => {
                for _ in 0..2 + random.below(3) {
                    let towards = DVec3::from_array([0; 3].map(|_| normal(random))).normalize_or(DVec3::X);
                    let away = diagonal * (0.5 + between(random, DISTANCES[0], DISTANCES[1]));
                    let radii = DVec3::from_array([0; 3].map(|_| diagonal * between(random, RADII[0], RADII[1])));
                    solid.at(DAffine3::from_translation(center + towards * away)).ellipsoid(radii);
                }
            }
            Self::Plate | Self::FusedPlate => {
                let larger = DVec2::new(between(random, PLATES[0], PLATES[1]), between(random, PLATES[0], PLATES[1]));
                let half = (high - low).truncate() * 0.5 * larger;
                let thickness = half.max_element() * 2.0 * between(random, THICKNESSES[0], THICKNESSES[1]);
                // The object is sunk in by a third of the plate.
                let at = DVec3::new(center.x, center.y, low.z - thickness / 6.0);
                solid.at(DAffine3::from_translation(at)).cuboid(half.extend(0.5 * thickness), 0.3 * thickness);
            }
        }
        let joined = joined(&[mesh, &solid.finish()?.0])?;
        if self != Self::FusedPlate {
            return Ok(joined);
        }
        // A sliver between the lowest vertex and the plate.
        let height = |i: &u32| mesh.positions()[*i as usize].z;
        let lowest = (0..mesh.positions().len() as u32).min_by(|a, b| height(a).total_cmp(&height(b))).unwrap_or(0);
        let [a, b, _] = joined.triangles()[mesh.triangles().len()];
        Mesh::new(joined.positions().to_vec(), [joined.triangles(), &[[lowest, a, b]]].concat())
    }
}
