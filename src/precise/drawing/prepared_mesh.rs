//! A mesh that is validated and decimated once for many alignments.

use core::cell::{Cell, OnceCell, RefCell};
use std::borrow::Cow;
use std::rc::Rc;

use super::ground_plate::without_plate;
use super::mesh_pyramid::MeshPyramid;
use super::removed_parts::{RemovedParts, Trimmed};
use crate::error::Result;
use crate::geometry::mesh::Mesh;
use crate::geometry::surface::check_shape;
use crate::geometry::surface_colors::SurfaceColors;
use crate::metrics::symmetry::{Symmetry, SymmetryGroup};
use crate::precise::observation::{FINE, GRIDS, Grid};

/// A mesh with cached derived data: the result of its validation, and its decimations. Both are computed on first use.
/// Results are bit-identical to those of the mesh itself. Vertices that no triangle uses are removed: they are no part
/// of the object, and every render would transform them. So is the [surplus](super::removed_parts) of generators.
pub struct PreparedMesh<'a> {
    /// As it was given.
    whole: Cow<'a, Mesh>,
    /// The rest, where there is surplus; on first use.
    trimmed: OnceCell<Option<Trimmed>>,
    /// The colours of all of the mesh, and those of the rest; on first use.
    colors: Option<SurfaceColors>,
    trimmed_colors: OnceCell<SurfaceColors>,
    /// Whether it has colours that could not be read.
    lacks_colors: bool,
    is_checked: Cell<bool>,
    /// The symmetry of its surface, on first use.
    symmetry: OnceCell<Rc<SymmetryGroup>>,
    /// By number of triangles, which depends on the quality.
    pyramids: RefCell<Vec<([usize; GRIDS], Rc<MeshPyramid>)>>,
    /// The mesh without what looks like a ground plate, on first use; `None` for one from which a plate is taken already.
    plates: Option<OnceCell<Box<Plate>>>,
}

/// The mesh without what looks like a ground plate, if it has one, decided by the mesh with so many triangles; and the decisions by
/// others.
struct Plate {
    triangles: usize,
    rest: Option<PreparedMesh<'static>>,
    next: OnceCell<Box<Plate>>,
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
        let whole = mesh.without_unused_vertices().map_or(mesh, Cow::Owned);
        Self::with(whole, OnceCell::new(), Some(OnceCell::new()))
    }

    fn with(whole: Cow<'a, Mesh>, trimmed: OnceCell<Option<Trimmed>>, plates: Option<OnceCell<Box<Plate>>>) -> Self {
        let (is_checked, pyramids, trimmed_colors) = (Cell::new(false), RefCell::default(), OnceCell::new());
        let symmetry = OnceCell::new();
        Self {
            whole,
            trimmed,
            colors: None,
            trimmed_colors,
            lacks_colors: false,
            is_checked,
            symmetry,
            pyramids,
            plates,
        }
    }

    /// The mesh with the colours of its surface, or without any.
    pub fn with_colors(self, colors: impl Into<Option<SurfaceColors>>) -> Self {
        Self { colors: colors.into(), ..self }
    }

    /// The mesh, and whether it has colours that could not be read.
    pub fn lacking_colors(self, lacks_colors: bool) -> Self {
        Self { lacks_colors, ..self }
    }

    /// Whether it has colours that could not be read: its turns may look different.
    pub fn lacks_colors(&self) -> bool {
        self.lacks_colors
    }

    /// The colours of the surface of the object, if they are known.
    pub fn colors(&self) -> Option<&SurfaceColors> {
        let colors = self.colors.as_ref()?;
        Some(match self.trimmed() {
            Some(trimmed) => self.trimmed_colors.get_or_init(|| colors.clone().beside(&trimmed.surplus)),
            None => colors,
        })
    }

    /// The colours of all of the mesh, if they are known.
    pub fn all_colors(&self) -> Option<&SurfaceColors> {
        self.colors.as_ref()
    }

    fn trimmed(&self) -> Option<&Trimmed> {
        self.trimmed.get_or_init(|| Trimmed::of(&self.whole)).as_ref()
    }

    /// The mesh of the object, without surplus: what the evidence is compared with.
    pub fn mesh(&self) -> &Mesh {
        self.trimmed().map_or(&self.whole, |trimmed| &trimmed.mesh)
    }

    /// All of the mesh, as it was given.
    pub fn whole(&self) -> &Mesh {
        &self.whole
    }

    /// The parts left out of it.
    pub fn removed_parts(&self) -> RemovedParts {
        self.trimmed().map_or_else(RemovedParts::default, |trimmed| trimmed.removed_parts)
    }

    /// The mesh without what looks like a ground plate, as the mesh decimated for `grids` shows it; `None` if it has nothing of the
    /// kind.
    pub fn without_plate(&self, grids: &[Grid; GRIDS]) -> Option<&PreparedMesh<'static>> {
        let rest = || {
            let trimmed = without_plate(self.mesh(), &self.pyramid(grids)?.fine)?;
            let removed_parts = RemovedParts { ground: trimmed.removed_parts.ground, ..self.removed_parts() };
            let whole = Cow::Owned(self.whole.as_ref().clone());
            let rest = PreparedMesh::with(whole, OnceCell::from(Some(Trimmed { removed_parts, ..trimmed })), None);
            // Without those of what is left out already.
            Some(rest.with_colors(self.colors().cloned()).lacking_colors(self.lacks_colors))
        };
        let triangles = grids[FINE].triangles;
        let mut plates = self.plates.as_ref()?;
        loop {
            let plate = plates.get_or_init(|| Box::new(Plate { triangles, rest: rest(), next: OnceCell::new() }));
            if plate.triangles == triangles {
                return plate.rest.as_ref();
            }
            plates = &plate.next;
        }
    }

    /// Whether every image of the mesh is compared with the same part of it. Helpers of a search, which have the mesh as it was
    /// given, take part only then.
    pub fn has_one_form(&self, grids: &[Grid; GRIDS]) -> bool {
        self.removed_parts().ground == 0.0 && self.without_plate(grids).is_none()
    }

    /// The rotations that this symmetry of the object makes equal.
    ///
    /// # Errors
    /// As [`Symmetry::group`].
    pub fn symmetry(&self, symmetry: &Symmetry) -> Result<Rc<SymmetryGroup>> {
        if *symmetry != Symmetry::Auto {
            return symmetry.group(self.mesh()).map(Rc::new);
        }
        if let Some(known) = self.symmetry.get() {
            return Ok(Rc::clone(known));
        }
        let found = Rc::new(symmetry.group(self.mesh())?);
        Ok(Rc::clone(self.symmetry.get_or_init(|| found)))
    }

    /// Checks that the surface encloses a volume.
    ///
    /// # Errors
    /// [`DegenerateMesh`](crate::error::ErrorCode::DegenerateMesh).
    pub fn check(&self) -> Result<()> {
        if !self.is_checked.get() {
            check_shape(self.mesh())?;
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
        let pyramid = Rc::new(MeshPyramid::new(self.mesh(), grids)?);
        pyramids.push((triangles, pyramid.clone()));
        Some(pyramid)
    }
}
