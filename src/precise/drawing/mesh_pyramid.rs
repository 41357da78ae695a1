//! The mesh at several resolutions: decimated for every grid of the search.

use core::cell::OnceCell;
use std::rc::Rc;

use glam::Vec3;

use super::equivalence::Equivalence;
use super::facing::draw_one_side;
use super::pose::MeshFrame;
use super::render::Model;
use super::turns::Turns;
use crate::error::Result;
use crate::geometry::cloud::outermost;
use crate::geometry::decimate::decimate;
use crate::geometry::mesh::Mesh;
use crate::geometry::surface::SurfaceMoments;
use crate::metrics::symmetry::Symmetry;
use crate::precise::observation::{FINE, FINEST, GRIDS, Grid};

/// Number of directions along which extreme vertices of the mesh are kept, for bounding boxes.
const DIRECTIONS: usize = 128;

/// A mesh in its normalised frame, decimated for every grid of the search.
pub struct MeshPyramid {
    /// The normalised frame, to which poses refer.
    pub frame: MeshFrame,
    /// The mesh of the fine grid.
    pub fine: Mesh,
    /// The model rendered on each grid.
    pub models: [Model; GRIDS],
    /// The extreme vertices of the fine mesh: almost all that a bounding box can touch.
    pub outermost: Vec<Vec3>,
    /// The moments of the surface of the fine mesh.
    pub surface: SurfaceMoments,
    /// The turns in which the object may look alike.
    pub turns: Turns,
    /// The symmetry that its surface shows, on first use.
    symmetry: OnceCell<Rc<Equivalence>>,
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
        let mut models = meshes.each_ref().map(Model::new);
        draw_one_side(&fine, &mut models);
        let surface = SurfaceMoments::of(&fine);
        let turns = Turns::new(&surface);
        Some(Self {
            frame,
            outermost: outermost(&models[FINE].positions, DIRECTIONS),
            surface,
            turns,
            models,
            fine,
            symmetry: OnceCell::new(),
        })
    }

    /// The equivalent poses of the mesh by its symmetry.
    ///
    /// # Errors
    /// As [`Symmetry::group`].
    pub fn equivalence(&self, symmetry: &Symmetry) -> Result<Rc<Equivalence>> {
        let known = self.symmetry.get().filter(|_| *symmetry == Symmetry::Auto);
        if let Some(known) = known {
            return Ok(Rc::clone(known));
        }
        let found = Rc::new(Equivalence::new(symmetry.group(&self.fine)?));
        if *symmetry == Symmetry::Auto {
            self.symmetry.get_or_init(|| Rc::clone(&found));
        }
        Ok(found)
    }
}
