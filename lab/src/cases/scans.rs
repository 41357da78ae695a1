//! Objects from mesh files.

use super::cluster::cluster;
use super::distortion::mapped;
use super::draft::{Axis, Object};
use crate::files::{listed, read};
use crate::prelude::*;
use sim3align::metrics::mesh_symmetry::symmetry_axes;
use sim3align_formats::mesh::{MeshFormat, MeshReadOptions, read_mesh};

/// A mesh of more triangles is thinned out.
const MAX_TRIANGLES: usize = 60_000;
/// Cells along the box diagonal where it is.
const CELLS: f64 = 220.0;

/// A mesh file's content.
#[derive(Debug, Clone)]
pub struct Scan {
    name: String,
    /// Its box's diagonal is 1.
    mesh: Mesh,
    symmetry: Vec<Axis>,
}

impl Scan {
    /// The GLB files of a folder, by name.
    pub fn all(folder: &Path) -> Result<Vec<Self>> {
        let mut paths = listed(folder)?;
        paths.retain(|path| path.extension().is_some_and(|extension| extension == "glb") && path.is_file());
        paths
            .iter()
            .map(|path| {
                let bytes = read(path)?;
                let name = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
                Self::read(name, &bytes).map_err(|error| error.about(path.display().to_string()))
            })
            .collect()
    }

    fn read(name: String, bytes: &[u8]) -> Result<Self> {
        let mut mesh = read_mesh(bytes, &MeshReadOptions { format: Some(MeshFormat::Gltf), resources: None })?;
        if mesh.triangles().len() > MAX_TRIANGLES {
            let cell = mesh.diagonal() / CELLS;
            mesh = cluster(&mesh, cell, DVec3::ZERO)?;
        }
        let symmetry = symmetry_axes(&mesh)?;
        let symmetry = symmetry.iter().map(|a| (DVec3::from_array(a.axis.into()), a.fold)).collect();
        let bounds = Bounds::of(mesh.positions()).unwrap_or(Bounds { min: Vec3::ZERO, max: Vec3::ONE });
        let unit = |p: &Vec3| (*p - bounds.center()) / bounds.diagonal();
        let mesh = mapped(&mesh, unit)?;
        Ok(Self { name, mesh, symmetry })
    }

    /// The object at a size that things on tables have.
    pub fn object(&self, random: &mut Random) -> Result<Object> {
        let diagonal = libm::exp(between(random, libm::log(0.1), libm::log(0.7))) as f32;
        let mesh = mapped(&self.mesh, |p| *p * diagonal)?;
        Ok(Object {
            family: self.name.clone(),
            parts: vec![0; mesh.triangles().len()],
            mesh,
            symmetry: self.symmetry.clone(),
            keys: Vec::new(),
            losable: Vec::new(),
            any_side_up: true,
        })
    }
}
