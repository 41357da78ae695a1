//! Skins: vertices follow the joints of a skeleton, in the pose that the nodes have.

use glam::{DMat4, DVec3, Vec3};

use crate::gltf::accessor::AccessorReader;
use crate::gltf::document::Primitive;
use crate::guard::{corrupt, missing};
use sim3align_runtime::error::Result;

/// The joints of a skin, each as scene_from_joint · joint_from_mesh.
pub(super) struct Skin(Vec<DMat4>);

impl Skin {
    /// The skin of this index. `scene_from_node`: of each node, if it is in the scene.
    pub fn read(index: usize, reader: &mut AccessorReader<'_>, scene_from_node: &[Option<DMat4>]) -> Result<Self> {
        let skins = &reader.document.skins;
        let skin = skins.get(index).ok_or_else(|| missing("skin", index, skins.len()))?;
        let bind = match skin.inverse_bind_matrices {
            Some(accessor) => reader.matrices(accessor)?,
            None => vec![DMat4::IDENTITY; skin.joints.len()],
        };
        reader.spend(skin.joints.len())?;
        let joint = |(&node, mesh_to_joint): (&usize, DMat4)| {
            let transform = scene_from_node.get(node).copied().flatten();
            transform.map(|transform| transform * mesh_to_joint).ok_or_else(|| {
                corrupt("mesh", format!("joint {node} outside the scene"), "joints in the scene of their mesh")
            })
        };
        if bind.len() < skin.joints.len() {
            let found = format!("{} inverse bind matrices for {} joints", bind.len(), skin.joints.len());
            return Err(corrupt("mesh", found, "one per joint"));
        }
        skin.joints.iter().zip(bind).map(joint).collect::<Result<_>>().map(Self)
    }

    /// The positions of a primitive in the scene: the average of where its joints move a vertex, by weight.
    pub fn apply(&self, positions: &mut [Vec3], primitive: &Primitive, reader: &mut AccessorReader<'_>) -> Result<()> {
        let mut sums = vec![(DVec3::ZERO, 0.0_f64); positions.len()];
        for set in 0.. {
            let attribute = |name: &str| primitive.attributes.get(&format!("{name}_{set}")).copied();
            let (Some(joints), Some(weights)) = (attribute("JOINTS"), attribute("WEIGHTS")) else {
                break;
            };
            let (joints, weights) = (reader.joints(joints)?, reader.weights(weights)?);
            if joints.len() != positions.len() || weights.len() != positions.len() {
                let found =
                    format!("{} joints and {} weights for {} vertices", joints.len(), weights.len(), sums.len());
                return Err(corrupt("mesh", found, "one per vertex"));
            }
            for (((joints, weights), position), (sum, total)) in
                joints.iter().zip(&weights).zip(&*positions).zip(&mut sums)
            {
                for (&joint, &weight) in joints.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
                    let transform =
                        self.0.get(joint as usize).ok_or_else(|| missing("joint", joint as usize, self.0.len()))?;
                    *sum += transform.transform_point3(position.as_dvec3()) * f64::from(weight);
                    *total += f64::from(weight);
                }
            }
        }
        for (position, (sum, total)) in positions.iter_mut().zip(sums).filter(|(_, (_, total))| *total > 0.0) {
            *position = (sum / total).as_vec3();
        }
        Ok(())
    }
}
