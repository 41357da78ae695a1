//! Placements: the results of the alignment of an object that the rest of the scene needs.

use std::rc::Rc;

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

use super::layers::{extremes, extremes_along, layer};
use super::plane::Plane;
use crate::align::search::SearchResult;
use crate::error::Result;
use crate::evidence::observation::Observation;
use crate::geometry::cloud::Bounds;
use crate::geometry::mesh::Mesh;
use crate::geometry::similarity::{Similarity, vec3, vector3};
use crate::precise::drawing::mesh_pyramid::MeshPyramid;
use crate::precise::drawing::pose::{CropPose, MeshFrame};
use crate::precise::drawing::prepared_mesh::PreparedMesh;
use crate::precise::scoring::scene_term::Layer;
use crate::precise::search::recipe::SearchSettings;
use crate::precise::search::rounds::Rounds;
use crate::precise::search::start::SearchState;
use crate::report::Alignment;

/// The results of the alignment of an object.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Placement {
    /// The poses that its search has found.
    pub search_state: SearchState,
    /// The matrix of the pose, see [`Sim3`](crate::report::Sim3).
    pub camera_from_mesh: [f64; 16],
    /// The space that the object takes in this pose.
    pub body: Body,
}

/// The space that a posed object takes.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Body {
    /// Its extreme points, camera frame, metres.
    pub points: Vec<Vec3>,
    /// Its layer.
    pub layer: Rc<Layer>,
    /// The least and the largest coordinate of all its vertices along the normal of the ground, metres, once that is
    /// known.
    pub along: Option<[f64; 2]>,
}

impl Body {
    /// The space that a mesh takes in a pose of its normalised frame.
    fn new(mesh: &MeshPyramid, pose: &CropPose, observation: &Observation) -> Self {
        let pose = pose.similarity(&MeshFrame::NORMALIZED);
        let points = mesh.outermost.iter().map(|p| vec3(&pose.apply(vector3(*p)))).collect();
        let size = [observation.depth().width(), observation.depth().height()];
        let layer = Rc::new(layer(&mesh.fine, &pose, &observation.camera(), size));
        Self { points, layer, along: None }
    }

    /// The lowest and the highest point over a plane, metres.
    pub fn extent(&self, plane: &Plane) -> [f64; 2] {
        extremes_along(&self.points, plane.normal).map(|h| h + plane.d)
    }

    /// The diagonal of its box, metres.
    pub fn diameter(&self) -> f64 {
        Bounds::of(&self.points).map_or(0.0, |b| f64::from(b.diagonal()))
    }

    /// The mean depth of its points, metres.
    pub fn depth_m(&self) -> f64 {
        let sum: f64 = self.points.iter().map(|p| f64::from(p.z)).sum();
        sum / self.points.len().max(1) as f64
    }

    /// With the extent of all vertices of the mesh along the normal of the ground.
    fn measured(self, mesh: &Mesh, camera_from_mesh: &Similarity, normal: DVec3) -> Self {
        let normal = nalgebra::Vector3::from(normal.to_array());
        // n·(s·R·p + t), with n in the frame of the mesh.
        let direction =
            DVec3::from_array((camera_from_mesh.rotation.inverse() * normal * camera_from_mesh.scale).into());
        let heights = mesh.positions().iter().map(|p| direction.dot(p.as_dvec3()));
        let [low, high] = extremes(heights);
        let offset = normal.dot(&camera_from_mesh.translation);
        Self { along: Some([low + offset, high + offset]), ..self }
    }
}

impl Placement {
    /// The placement that follows from a search; `None` if it has found no pose.
    pub fn new(searched: &SearchResult, observation: &Observation) -> Option<Self> {
        let Rounds { candidates, search, .. } = &searched.rounds;
        let pose = candidates.first()?.pose;
        Some(Self {
            search_state: SearchState {
                candidates: candidates.clone(),
                effort: search.effort(),
                renders: search.renders,
                confidence: searched.confidence(),
            },
            camera_from_mesh: pose.similarity(&search.mesh.frame).to_column_major(),
            body: Body::new(&search.mesh, &pose, observation),
        })
    }

    /// With the space that the object takes in the pose of its alignment: colours may have chosen another one than the
    /// search. With the normal of the ground, all vertices of the mesh are measured along it.
    ///
    /// # Errors
    /// Those of [`Similarity::from_column_major`], which only a bug could cause.
    pub fn in_pose_of(
        mut self,
        alignment: &Alignment,
        mesh: &PreparedMesh<'_>,
        observation: &Observation,
        normal: Option<DVec3>,
    ) -> Result<Self> {
        let matrix = alignment.camera_from_mesh.matrix;
        let camera_from_mesh = Similarity::from_column_major(&matrix)?;
        if self.camera_from_mesh != matrix
            && let Some(pyramid) = mesh.pyramid(&SearchSettings::from(self.search_state.effort).grids)
            && let Some(pose) = CropPose::of_similarity(&camera_from_mesh, &pyramid.frame)
        {
            self.body = Body::new(&pyramid, &pose, observation);
        }
        self.camera_from_mesh = matrix;
        if let Some(normal) = normal {
            self.body = self.body.measured(mesh.mesh(), &camera_from_mesh, normal);
        }
        Ok(self)
    }
}
