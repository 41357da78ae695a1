//! The mesh at several resolutions: decimated for every grid of the search.

use glam::Vec3;

use super::coarse::outermost;
use super::pose::MeshFrame;
use super::recipe::{FINE, FINEST, GRIDS, Grid};
use super::render::Model;
use super::turns::Turns;
use crate::geometry::decimate::decimate;
use crate::geometry::mesh::Mesh;

/// A mesh in its normalised frame, decimated for every grid of the search.
pub struct MeshPyramid {
    /// The normalised frame, to which poses refer.
    pub frame: MeshFrame,
    /// The mesh of the fine grid.
    pub fine: Mesh,
    /// The model rendered on each grid.
    pub models: [Model; GRIDS],
    /// Extreme vertices of the fine mesh; see [`outermost`].
    pub outermost: Vec<Vec3>,
    /// The turns in which the object may look alike.
    pub turns: Turns,
}

impl MeshPyramid {
    /// Decimates a mesh for `grids`, each from the next finer one. `None` if no triangle remains.
    pub fn new(mesh: &Mesh, grids: &[Grid; GRIDS]) -> Option<Self> {
        let frame = MeshFrame::of(mesh);
        let finest = frame.normalized(&decimate(mesh, grids[FINEST].triangles))?;
        let fine = decimate(&finest, grids[FINE].triangles);
        let mut meshes = [fine.clone(), fine.clone(), fine.clone(), fine.clone(), finest];
        for grid in (0..FINE).rev() {
            meshes[grid] = decimate(&meshes[grid + 1], grids[grid].triangles);
        }
        let models = meshes.each_ref().map(Model::new);
        Some(Self { frame, outermost: outermost(&models[FINE]), turns: Turns::new(&fine), models, fine })
    }
}
