//! Placements: what the alignment of an object tells about it to the rest of the scene.

use crate::precise::searched::ranking::Found;
use crate::precise::searched::recipe::SearchSettings;
use std::rc::Rc;

use glam::{DVec3, Vec3};

use super::layers::{extremes, extremes_along, layer};
use super::plane::Plane;
use crate::align::search::{Given, Searched};
use crate::error::Result;
use crate::evidence::observation::Observation;
use crate::geometry::cloud::Bounds;
use crate::geometry::mesh::Mesh;
use crate::geometry::similarity::{Similarity, vec3, vector3};
use crate::precise::drawn::mesh_pyramid::MeshPyramid;
use crate::precise::drawn::pose::{CropPose, MeshFrame};
use crate::precise::drawn::prepared_mesh::PreparedMesh;
use crate::precise::scored::score::Score;
use crate::precise::scored::surroundings::{Layer, Neighbourhood};
use crate::precise::searched::rounds::Rounds;
use crate::report::{Alignment, Effort, Sim3};

/// Numbers of a candidate in [`Placement::numbers`].
const NUMBERS: usize = 21;

/// What the alignment of an object tells.
#[derive(Debug, Clone)]
pub struct Placement {
    /// The candidates, best first.
    pub found: Vec<Found>,
    /// The effort of the search that found them.
    pub effort: Effort,
    /// Number of images that it drew.
    pub renders: usize,
    /// The probability that the best one is right.
    pub confidence: f64,
    /// The best pose.
    pub camera_from_mesh: Similarity,
    /// The space that the object takes in the best pose.
    pub body: Body,
}

/// The space that a posed object takes.
#[derive(Debug, Clone)]
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
    /// What a search has found; `None` if it has found nothing.
    pub fn new(searched: &Searched, observation: &Observation) -> Option<Self> {
        let Rounds { found, search, .. } = &searched.rounds;
        let pose = found.first()?.pose;
        Some(Self {
            found: found.clone(),
            effort: search.effort(),
            renders: search.renders,
            confidence: searched.confidence(),
            camera_from_mesh: pose.similarity(&search.mesh.frame),
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
        let camera_from_mesh = Similarity::from_column_major(&alignment.camera_from_mesh.matrix)?;
        if Sim3::from(&self.camera_from_mesh) != alignment.camera_from_mesh
            && let Some(pyramid) = mesh.pyramid(&SearchSettings::from(self.effort).grids)
            && let Some(pose) = CropPose::of_similarity(&camera_from_mesh, &pyramid.frame)
        {
            self.body = Body::new(&pyramid, &pose, observation);
        }
        if let Some(normal) = normal {
            self.body = self.body.measured(mesh.mesh(), &camera_from_mesh, normal);
        }
        Ok(self)
    }

    /// What the search of the object begins with, once it knows its surroundings.
    pub fn given(&self, known: Neighbourhood) -> Given {
        let Self { effort, renders, confidence, .. } = *self;
        Given { found: self.found.clone(), effort, renders, confidence, known }
    }

    /// The candidates as numbers, without loss.
    pub fn numbers(&self) -> Vec<f64> {
        self.found.iter().flat_map(numbers_of).collect()
    }
}

fn numbers_of(found: &Found) -> [f64; NUMBERS] {
    let Found { pose, score, converged, renders } = found;
    let [qx, qy, qz, qw] = pose.rotation.to_array();
    let &Score { total, overlap, coverage, depth, normals, outline, hidden, union, counts } = score;
    let [depths, turns, rims] = counts;
    let terms = [total, overlap, coverage, depth, normals, outline, hidden, union, depths, turns, rims].map(f64::from);
    let [a, b, c, d, e, f, g, h, i, j, k] = terms;
    let more = [f64::from(u8::from(*converged)), *renders as f64];
    let [place_x, place_y] = pose.place.to_array();
    let (size, distance) = (pose.size, pose.distance);
    [qx, qy, qz, qw, size, place_x, place_y, distance, a, b, c, d, e, f, g, h, i, j, k, more[0], more[1]]
}

/// The candidates of [`Placement::numbers`].
pub fn found_of(numbers: &[f64]) -> Vec<Found> {
    let candidate = |n: &[f64; NUMBERS]| {
        let term = |i: usize| n[8 + i] as f32;
        Found {
            pose: CropPose {
                rotation: glam::DQuat::from_xyzw(n[0], n[1], n[2], n[3]),
                size: n[4],
                place: glam::DVec2::new(n[5], n[6]),
                distance: n[7],
            },
            score: Score {
                total: term(0),
                overlap: term(1),
                coverage: term(2),
                depth: term(3),
                normals: term(4),
                outline: term(5),
                hidden: term(6),
                union: term(7),
                counts: [term(8), term(9), term(10)],
            },
            converged: n[19] != 0.0,
            renders: n[20] as usize,
        }
    };
    numbers.as_chunks().0.iter().map(candidate).collect()
}
