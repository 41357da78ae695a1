//! The mesh as the search draws it: decimated for every grid.

use glam::Vec3;

use super::coarse::outermost;
use super::pose::MeshFrame;
use super::recipe::{FINE, FINEST, GRIDS, Grid};
use super::render::Model;
use crate::geometry::decimate::decimate;
use crate::geometry::mesh::Mesh;

/// A mesh in its own normalised frame, decimated for every grid of the search.
pub struct MeshPyramid {
    /// The frame, from which poses are counted.
    pub frame: MeshFrame,
    /// The mesh of the fine grid.
    pub fine: Mesh,
    /// The model that is drawn on each grid.
    pub models: [Model; GRIDS],
    /// Vertices of the fine mesh that its boxes touch; see [`outermost`].
    pub outermost: Vec<Vec3>,
}

impl MeshPyramid {
    /// Decimates a mesh for `grids`, each from the next finer one. `None` where no triangle is left.
    pub fn new(mesh: &Mesh, grids: &[Grid; GRIDS]) -> Option<Self> {
        let frame = MeshFrame::of(mesh);
        let finest = frame.normalized(&decimate(mesh, grids[FINEST].triangles))?;
        let fine = decimate(&finest, grids[FINE].triangles);
        let mut meshes = [fine.clone(), fine.clone(), fine.clone(), fine.clone(), finest];
        for grid in (0..FINE).rev() {
            meshes[grid] = decimate(&meshes[grid + 1], grids[grid].triangles);
        }
        let models = meshes.each_ref().map(Model::new);
        Some(Self { frame, outermost: outermost(&models[FINE]), models, fine })
    }
}
