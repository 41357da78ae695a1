//! A mesh that is validated and decimated once for many alignments.

use core::cell::{Cell, RefCell};
use std::borrow::Cow;
use std::rc::Rc;

use super::mesh_pyramid::MeshPyramid;
use crate::error::Result;
use crate::geometry::mesh::Mesh;
use crate::geometry::surface::check_shape;
use crate::geometry::surface_colors::SurfaceColors;
use crate::precise::observed::resolution::{GRIDS, Grid};

/// A mesh with cached derived data: the result of its validation, and its decimations. Both are computed on first use.
/// Results are bit-identical to those of the mesh itself. Vertices that no triangle uses are removed: they are no part
/// of the object, and every render would transform them.
pub struct PreparedMesh<'a> {
    mesh: Cow<'a, Mesh>,
    colors: Option<SurfaceColors>,
    is_checked: Cell<bool>,
    /// By number of triangles, which depends on the quality.
    pyramids: RefCell<Vec<([usize; GRIDS], Rc<MeshPyramid>)>>,
}

impl PreparedMesh<'static> {
    /// Takes ownership of a mesh.
    pub fn new(mesh: Mesh) -> Self {
        Self::of(Cow::Owned(mesh))
    }
}

impl<'a> PreparedMesh<'a> {
    /// Borrows a mesh.
    pub fn borrowed(mesh: &'a Mesh) -> Self {
        Self::of(Cow::Borrowed(mesh))
    }

    fn of(mesh: Cow<'a, Mesh>) -> Self {
        let mesh = mesh.without_unused_vertices().map_or(mesh, Cow::Owned);
        Self { mesh, colors: None, is_checked: Cell::new(false), pyramids: RefCell::default() }
    }

    /// The mesh with the colours of its surface, or without any.
    pub fn with_colors(self, colors: impl Into<Option<SurfaceColors>>) -> Self {
        Self { colors: colors.into(), ..self }
    }

    /// The colours of the surface, if they are known.
    pub fn colors(&self) -> Option<&SurfaceColors> {
        self.colors.as_ref()
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Checks that the surface encloses a volume.
    ///
    /// # Errors
    /// [`DegenerateMesh`](crate::error::ErrorCode::DegenerateMesh).
    pub fn check(&self) -> Result<()> {
        if !self.is_checked.get() {
            check_shape(&self.mesh)?;
            self.is_checked.set(true);
        }
        Ok(())
    }

    /// The decimations for `grids`; `None` if no triangle remains.
    pub fn pyramid(&self, grids: &[Grid; GRIDS]) -> Option<Rc<MeshPyramid>> {
        let triangles = grids.map(|grid| grid.triangles);
        let mut pyramids = self.pyramids.borrow_mut();
        if let Some((_, known)) = pyramids.iter().find(|(known, _)| *known == triangles) {
            return Some(known.clone());
        }
        let pyramid = Rc::new(MeshPyramid::new(&self.mesh, grids)?);
        pyramids.push((triangles, pyramid.clone()));
        Some(pyramid)
    }
}
