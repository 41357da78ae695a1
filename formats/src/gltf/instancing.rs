//! `EXT_mesh_gpu_instancing`: several copies of a node's mesh, each with a transform of its own.

use glam::{DMat4, DQuat, DVec3, Vec3};

use crate::gltf::accessor::AccessorReader;
use crate::gltf::document::Instances;
use crate::guard::{MAX_VERTICES, corrupt, too_large};
use sim3align_runtime::error::Result;

impl Instances {
    /// The transforms of the copies of the node's mesh, each node_from_instance.
    pub fn transforms(&self, reader: &mut AccessorReader<'_>) -> Result<Vec<DMat4>> {
        let attributes = &self.attributes;
        let translations = attributes.translation.map(|index| reader.positions(index)).transpose()?;
        let scales = attributes.scale.map(|index| reader.positions(index)).transpose()?;
        let rotations = attributes.rotation.map(|index| reader.rotations(index)).transpose()?;
        let of_vectors = |vectors: &Option<Vec<Vec3>>| vectors.as_ref().map(Vec::len);
        let counts = [of_vectors(&translations), of_vectors(&scales), rotations.as_ref().map(Vec::len)];
        let count = counts.into_iter().flatten().next().unwrap_or_default();
        if counts.into_iter().flatten().any(|other| other != count) {
            return Err(corrupt("mesh", "instances whose attributes differ in number", "one per instance"));
        }
        // Each has a triangle at least.
        if count > MAX_VERTICES / 3 {
            return Err(too_large("mesh", format!("{count} instances"), format!("at most {}", MAX_VERTICES / 3)));
        }
        let at = |vectors: &Option<Vec<Vec3>>, i: usize, default: DVec3| {
            vectors.as_ref().and_then(|vectors| vectors.get(i)).map_or(default, |vector| vector.as_dvec3())
        };
        let transform = |i: usize| {
            let rotation = rotations.as_ref().and_then(|rotations| rotations.get(i));
            let rotation = rotation.map_or(DQuat::IDENTITY, |xyzw| unit(xyzw.map(f64::from)));
            let (scale, translation) = (at(&scales, i, DVec3::ONE), at(&translations, i, DVec3::ZERO));
            DMat4::from_scale_rotation_translation(scale, rotation, translation)
        };
        Ok((0..count).map(transform).collect())
    }
}

/// A quaternion x, y, z, w of length 1. Some exporters write zeros for the identity.
pub(super) fn unit(xyzw: [f64; 4]) -> DQuat {
    let rotation = DQuat::from_array(xyzw);
    if rotation.length_squared() > 0.0 { rotation.normalize() } else { DQuat::IDENTITY }
}
