//! One case of an evaluation set, and the set.

use super::draft::{Axis, Object};
use super::edges::DepthSource;
use super::families;
use super::generator::generate;
use super::mask::Segmented;
use super::photo::take;
use super::print::{Print, PrintKind};
use super::readings::Readings;
use super::scans::Scan;
use super::scene::{Scene, put_down, turned_axis};
use super::sensor;
use super::split::in_two;
use super::streams::{
    COLOR_STREAM, EDGE_STREAM, GENERATOR_STREAM, MASK_STREAM, MONOCULAR_STREAM, OBJECT_STREAM, READINGS_STREAM,
    SCENE_STREAM, SENSOR_STREAM,
};
use super::texture::paint;
use super::tier::{CaseSet, Class, OutlineErrors, Tier};
use crate::bench::benchmark::BenchCase;
use crate::case_folder::contents::glb_file;
use crate::cases::distortion::canonicalise;
use crate::files::{NamedFile, write_files};
use crate::prelude::*;
use sim3align::geometry::surface::SurfaceMoments;

/// Default number of cases.
pub const CASES: usize = 240;
/// Minimum number of pixels in a mask.
pub const MIN_MASK_PX: usize = 350;
/// Maximum distance of the object.
const FARTHEST_M: f32 = 12.0;
/// Maximum number of draws per case.
const DRAWS: u64 = 400;

/// A set of cases.
#[derive(Debug, Clone, Default)]
pub struct EvaluationSet {
    seed: u64,
    classes: CaseSet,
    scans: Vec<Scan>,
}

/// A generated case with its truth.
#[derive(Debug, Clone)]
pub struct EvaluationCase {
    /// Index in the set.
    pub index: usize,
    /// Difficulty.
    pub tier: Tier,
    /// The property that the case tests.
    pub class: Class,
    /// What it shows: the family's name, or the mesh file's.
    pub family: String,
    /// The source of its depth map: a [`DepthSource`] by name, or `"monocular"`, `"sensor"` or `"exact"`.
    pub depth: &'static str,
    /// The source of its mask: `"network-mask"`, `"annotated-mask"` or `"uniform-mask"`.
    pub mask: &'static str,
    /// Names of the simulated errors.
    pub tags: Vec<&'static str>,
    /// Magnitudes of the simulated errors.
    pub parameters: Vec<(&'static str, f64)>,
    /// Depth, mask and camera.
    pub observation: Observation,
    /// The generated mesh, in its canonical frame.
    pub mesh: Mesh,
    /// Its colours; the observation then has a photo.
    pub colors: Option<SurfaceColors>,
    /// The files from which photo, mesh and colours were read, if it has colours.
    pub color_files: Vec<NamedFile>,
    /// The true pose, in the scale of the depth map.
    pub camera_from_mesh: Similarity,
    /// Rotational symmetries of the mesh, in its frame.
    pub symmetry: Symmetry,
    /// The true object: metres, z up, on the table.
    pub object: Mesh,
    /// Where it is seen, in the depth map's own metric.
    pub camera_from_object: Similarity,
}

impl EvaluationSet {
    /// The general set of a seed, of procedural objects.
    pub fn new(seed: u64) -> Self {
        Self { seed, ..Self::default() }
    }

    /// The set of the same seed with the classes of `classes`.
    pub fn of(self, classes: CaseSet) -> Self {
        Self { classes, ..self }
    }

    /// The set that shows, in a third of its cases, the GLB files of a folder.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidArgument`] if a folder cannot be read, and those of the readers.
    pub fn with_meshes(seed: u64, folder: &Path) -> Result<Self> {
        Ok(Self { scans: Scan::all(folder)?, ..Self::new(seed) })
    }

    /// Case `index`. It depends on the set's seed, its meshes and the index alone.
    ///
    /// # Errors
    /// Only in case of a bug in the generator.
    pub fn case(&self, index: usize) -> Result<EvaluationCase> {
        first_fit(&format!("case {index}"), DRAWS, |draw| {
            let seed = mixed([self.seed, index as u64, draw]);
            let seed = match self.classes {
                CaseSet::General | CaseSet::Dilated => seed,
                CaseSet::Sensors => mixed([seed, SENSOR_STREAM]),
                CaseSet::Colors => mixed([seed, COLOR_STREAM]),
                CaseSet::Monocular => mixed([seed, MONOCULAR_STREAM]),
            };
            self.draw(index, seed)
        })
    }

    /// A draw of a case; `None` if it shows too little of the object, or not the property of its class.
    fn draw(&self, index: usize, seed: u64) -> Result<Option<EvaluationCase>> {
        let (tier, class) = (Tier::of(index), self.classes.class(index));
        let random = &mut Random::new(seed, OBJECT_STREAM);
        let object = families::draw(random, tier, class, &self.scans)?;
        let random = &mut Random::new(seed, SCENE_STREAM);
        let (placed, symmetry) = put_down(&object, tier, random)?;
        let scene = Scene::draw(&placed, tier, class, random)?;
        let Some(mut tags) = shows_enough(&scene, &placed, &object, tier, class) else { return Ok(None) };

        let errors = self.classes.outlines();
        let mut segmented = Segmented::draw(&scene, (tier, class), errors, &mut Random::new(seed, MASK_STREAM))?;
        let random = &mut Random::new(seed, READINGS_STREAM);
        let mut readings = if self.classes == CaseSet::Monocular {
            Readings::exact(&scene)?
        } else {
            let has_edges = errors == OutlineErrors::Measured && class.has_measured_edges();
            let mut edge_random = has_edges.then(|| Random::new(seed, EDGE_STREAM));
            Readings::draw(&scene, object.diagonal(), (tier, class), random, edge_random.as_mut())?
        };
        if readings.missing > tier.pick(0.1, 0.25, 0.4) {
            return Ok(None);
        }
        let random = &mut Random::new(seed, SENSOR_STREAM);
        let (cell, observed) = ((tier, class), (&mut readings, &mut segmented));
        let Some(effects) = sensor::apply(&scene, (&object, &placed), cell, observed, random)? else {
            return Ok(None);
        };
        let mask_px = segmented.mask.data().iter().filter(|m| **m != 0).count();
        if mask_px < MIN_MASK_PX || (class == Class::Tiny && mask_px > 1600) {
            return Ok(None);
        }
        let random = &mut Random::new(seed, GENERATOR_STREAM);
        let generated = generate(&object, &placed, &symmetry, &scene, (tier, class), random)?;
        let (mut mesh, object_from_mesh) = canonicalise(&generated.mesh, seed)?;
        let mut observation = Observation::new(readings.depth, segmented.mask, scene.camera)?;
        let (mut colors, mut color_files, mut of_photo) = (None, Vec::new(), None);
        let random = &mut Random::new(seed, COLOR_STREAM);
        let is_told = class.is_told_by_color();
        if let Some(kind) = PrintKind::of(class, chance(random, 0.5)) {
            let print = Print::draw(&placed, &symmetry, kind, random);
            if is_told && !print.tells(&placed, &symmetry, &scene) {
                return Ok(None);
            }
            let photo = take(&scene, (&placed, &print), class, tier, random)?;
            observation = observation.with_photo(photo.photo)?;
            let eye = DVec3::from_array(scene.camera_from_world.inverse().translation.into());
            let painted = paint(&mesh, &object_from_mesh, (&print, &placed), eye, (tier, class), random)?;
            (mesh, colors) = (painted.mesh.mesh, painted.mesh.colors);
            color_files = painted.files;
            color_files.push(photo.file);
            of_photo = Some(photo.parameters);
        }

        // The scale error of the depth map scales the camera frame.
        let metric = Similarity { scale: readings.bias, ..Similarity::identity() };
        let camera_from_object = metric.compose(&scene.camera_from_world);
        tags.push(readings.kind);
        tags.extend(readings.source.map(DepthSource::as_str));
        tags.extend(segmented.tags);
        tags.extend(generated.tags);
        let mut parameters = vec![
            ("maskPx", mask_px as f64),
            ("visible", scene.visible_px() as f64 / scene.silhouette_px.max(1) as f64),
            ("hidden", scene.hidden),
            ("cut", scene.cut),
            ("maskOffsetPx", segmented.offset_px),
            ("depthBias", readings.bias),
            ("missingDepth", readings.missing),
            ("diagonalM", object.diagonal()),
        ];
        parameters.extend(readings.parameters);
        parameters.extend(effects);
        parameters.extend(generated.parameters);
        parameters.extend(of_photo.into_iter().flatten());
        Ok(Some(EvaluationCase {
            index,
            tier,
            class,
            family: object.family,
            depth: readings.source.map_or(readings.kind, DepthSource::as_str),
            mask: segmented.kind,
            tags,
            parameters,
            observation,
            mesh,
            colors,
            color_files,
            camera_from_mesh: camera_from_object.compose(&object_from_mesh),
            symmetry: if is_told { Symmetry::None } else { declared(&generated.symmetry, &object_from_mesh) },
            object: placed,
            camera_from_object,
        }))
    }
}

impl EvaluationCase {
    /// Name of the case and its folder.
    pub fn name(&self) -> String {
        format!("{:04}-{}-{}-{}", self.index, self.tier.as_str(), self.class.as_str(), self.family)
    }

    /// The files of its case folder: name and content. `gt.json` has the symmetry in words, as all readers understand
    /// them, and, exactly, as `symmetryAxes`.
    ///
    /// # Errors
    /// [`ErrorCode::Internal`] if an encoder fails.
    pub fn files(&self) -> Result<Vec<NamedFile>> {
        let mesh_files =
            if self.color_files.is_empty() { vec![glb_file(&self.mesh)] } else { self.color_files.clone() };
        BenchCase::from(self.clone()).files(&self.name(), mesh_files, Some(self.index), None)
    }

    /// Writes the case folder, and creates it if necessary.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidArgument`] if the folder or a file cannot be written, and those of
    /// [`EvaluationCase::files`].
    pub fn write(&self, folder: &Path) -> Result<()> {
        write_files(folder, &self.files()?)
    }
}

/// Whether a scene shows enough of its object, and what its class is about; if so, what there is to remark.
fn shows_enough(scene: &Scene, placed: &Mesh, object: &Object, tier: Tier, class: Class) -> Option<Vec<&'static str>> {
    let pixels = scene.visible_px();
    let visible = pixels as f64 / scene.silhouette_px.max(1) as f64;
    let shows_class = match class {
        Class::Occluded => scene.hidden >= tier.pick(0.0, 0.05, 0.08),
        Class::BorderCut => (0.04..=0.25).contains(&scene.cut),
        Class::SplitMask => scene.cut < 1e-9 && in_two(&scene.visible, scene.width),
        _ => scene.cut < 1e-9,
    };
    if pixels < MIN_MASK_PX || visible < tier.least_visible(class) || !shows_class || !is_telling(scene, placed, tier) {
        return None;
    }
    let far = scene.object_depth.iter().any(|z| *z > FARTHEST_M);
    if far {
        return None;
    }
    let mut tags = Vec::new();
    if !object.keys.is_empty() {
        let key_px = scene.part_px(&object.keys, &object.parts);
        if key_px < (pixels / 50).max(25) {
            // What tells how the object is turned is out of sight: no case to count on, though one that occurs.
            if tier != Tier::Hard {
                return None;
            }
            tags.push("key-part-hidden");
        }
    }
    if scene.hidden > 0.02 {
        tags.push("partly-hidden");
    }
    if scene.cut > 0.0 {
        tags.push("cut");
    }
    Some(tags)
}

/// Whether what is flat is not seen on edge, nor what is long from its end: nobody takes such a photo to be measured.
pub(crate) fn is_telling(scene: &Scene, placed: &Mesh, tier: Tier) -> bool {
    let moments = SurfaceMoments::of(placed);
    let axes = moments.principal_axes();
    let [thin, middle, long] = axes.values.map(|variance| variance.max(0.0).sqrt());
    let eye = DVec3::from_array(scene.camera_from_world.inverse().translation.into());
    let view = (eye - moments.centroid).normalize_or_zero();
    let across = tier.pick(0.5, 0.4, 0.3);
    let on_edge = thin < 0.35 * middle && axes.vectors[0].dot(view).abs() < across;
    let from_its_end = middle < 0.5 * long && axes.vectors[2].cross(view).length() < across;
    !on_edge && !from_its_end
}

/// The symmetry in the frame of the mesh.
pub(crate) fn declared(axes: &[Axis], object_from_mesh: &Similarity) -> Symmetry {
    if axes.is_empty() {
        return Symmetry::None;
    }
    let mesh_from_object = object_from_mesh.rotation.inverse();
    let axis = |&(axis, fold): &Axis| {
        let turned = turned_axis(mesh_from_object.matrix(), axis);
        SymmetryAxis { axis: Vector3::from(turned.to_array()), fold }
    };
    Symmetry::Declared(axes.iter().map(axis).collect())
}
