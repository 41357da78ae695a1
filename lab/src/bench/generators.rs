//! Meshes of generators: where their own layout puts them, and where alignments do.

use std::fs;

use super::benchmark::{LOOSE, STRICT};
use super::scene_bench::{BenchObject, BenchScene};
use super::statistics::{cell, median};
use crate::baselines::icp::{classical, solve};
use crate::case_folder::{json, pose};
use crate::cases::streams::PLACEMENT_STREAM;
use crate::files::entries;
use crate::prelude::*;
use sim3align::align::align;
use sim3align::align::evaluate::{EvaluateOptions, Evaluation, Truth, evaluate};
use sim3align::evidence::Evidence;
use sim3align::evidence::clouds::Sampling;
use sim3align::precise::options::Proportions;
use sim3align::register::icp::IcpMetric;
use sim3align::report::Alignment;
use sim3align::scene::task::{SceneAlignment, align_scene};

/// The files with a generator's own placement, beside that of the truth; the first one that is there counts.
const PLACEMENTS: [&str; 2] = ["initial.json", "sam3d.json"];
/// Largest distance of correspondences of ICP, relative to the diameter of the mesh; and its iterations.
const REACH: f64 = 0.1;
const ITERATIONS: usize = 200;

/// Standard deviations of simulated placements: of the logarithm of the size, of the turn about each axis (degrees) and of
/// the place along each (of the diameter). Their medians are those of 16 objects that SAM 3D Objects placed: 3.6 %, 5.8°, 4.4 %.
const SIMULATED: (f64, f64, f64) = (0.0534, 3.77, 0.0286);
/// The angle by which the up direction that an alignment is told is off, degrees: a generator's objects stand about so.
const UP_ERROR_DEG: f64 = 5.0;

/// The rows of the table.
pub const ROWS: [&str; 8] = [
    "the generator's own",
    "ICP from it",
    "align",
    "align, initial",
    "align, up",
    "alignScene",
    "alignScene, initial",
    "align, proportions",
];

/// What was measured of an object, by row; `None` where there is no pose.
pub type Record = [Option<Evaluation>; ROWS.len()];

/// A scene, and where a generator has put the meshes of its objects.
pub struct PlacedScene {
    scene: BenchScene,
    placements: Vec<Option<Similarity>>,
}

impl PlacedScene {
    /// A scene folder.
    ///
    /// # Errors
    /// Those of the readers.
    pub fn read(folder: &Path) -> Result<Self> {
        let scene = BenchScene::read(folder)?;
        let folders = entries(&folder.join("objects")).into_iter().filter(|path| path.is_dir());
        let placement = |folder: PathBuf| {
            let found = PLACEMENTS.iter().find_map(|name| Some((name, fs::read(folder.join(name)).ok()?)));
            found.map(|(name, bytes)| pose::similarity(name, &json::parse(name, &bytes)?)).transpose()
        };
        Ok(Self { scene, placements: folders.map(placement).collect::<Result<_>>()? })
    }

    /// A scene whose meshes are placed with about the errors of SAM 3D Objects. The seeds are those of the set, and of the scene.
    ///
    /// # Errors
    /// Only in case of a bug.
    pub fn simulated(scene: BenchScene, [set, index]: [u64; 2]) -> Result<Self> {
        let placement = |(k, object): (usize, &BenchObject)| {
            let random = &mut Random::new(mixed([set, index, k as u64]), PLACEMENT_STREAM);
            object.truth.as_ref().map(|truth| misplaced(&object.mesh, &truth.camera_from_mesh, random)).transpose()
        };
        let placements = scene.objects.iter().enumerate().map(placement).collect::<Result<_>>()?;
        Ok(Self { scene, placements })
    }

    /// The records of the objects whose true pose is known.
    ///
    /// # Errors
    /// Those of [`align_scene`].
    pub fn records(&self, options: &AlignOptions) -> Result<Vec<(String, Record)>> {
        let together = |is_told: bool| {
            let own = |k: usize| AlignOptions { initial: self.placements[k].filter(|_| is_told), ..options.clone() };
            align_scene(&self.scene.with_options(own), &mut Silent)
        };
        let pose_in = |scene: &SceneAlignment, k: usize| {
            let object = scene.objects.get(k)?.as_ref().ok()?;
            Similarity::from_column_major(&object.alignment.camera_from_mesh.matrix).ok()
        };
        let (plain, told) = (together(false)?, together(true)?);
        let of = |(k, object): (usize, &BenchObject)| {
            let truth = object.truth.as_ref()?;
            let scenes = [pose_in(&plain, k), pose_in(&told, k).filter(|_| self.placements[k].is_some())];
            Some(self.record(k, object, truth, scenes, options).map(|record| (object.name.clone(), record)))
        };
        self.scene.objects.iter().enumerate().filter_map(of).collect()
    }

    fn record(
        &self,
        k: usize,
        object: &BenchObject,
        truth: &Truth,
        [together, together_told]: [Option<Similarity>; 2],
        options: &AlignOptions,
    ) -> Result<Record> {
        let BenchObject { mask, mesh, .. } = object;
        let own = self.placements[k];
        let mut observation = Observation::new(self.scene.depth.clone(), mask.clone(), self.scene.camera)?;
        if let Some(others) = others(&self.scene, k)? {
            observation = observation.with_others(others)?;
        }
        let judged = |mesh: &Mesh, pose: Similarity| {
            evaluate(&observation, mesh, &pose, &EvaluateOptions::against(Some(truth))).ok()
        };
        let aligned = |options: AlignOptions| align(&observation, mesh, &options, &mut Silent).ok();
        let pose = |found: &Alignment| Similarity::from_column_major(&found.camera_from_mesh.matrix).ok();
        let found = aligned(AlignOptions { proportions: Proportions::Full, ..options.clone() });
        let stretched = found.as_ref().and_then(|found| found.proportions.as_ref()).and_then(|found| {
            let by = DMat3::from_cols_array_2d(&found.stretch);
            let positions = mesh.positions().iter().map(|p| (by * p.as_dvec3()).as_vec3()).collect();
            let mesh = Mesh::new(positions, mesh.triangles().to_vec()).ok()?;
            judged(&mesh, Similarity::from_column_major(&found.camera_from_stretched.matrix).ok()?)
        });
        let told = own.and_then(|own| aligned(AlignOptions { initial: Some(own), ..options.clone() }));
        let upright = self.scene.plane.and_then(|plane| {
            let about = Vector3::new(1.0, 0.0, 0.0);
            let off = Rotation3::from_scaled_axis(about * UP_ERROR_DEG.to_radians());
            let up = off * (truth.camera_from_mesh.rotation.inverse() * Vector3::from(plane.normal.to_array()));
            let (camera_up, mesh_up) = (Some(plane.normal.to_array()), Some(up.into()));
            aligned(AlignOptions { camera_up, mesh_up, ..options.clone() })
        });
        let found_poses = [
            own,
            own.and_then(|own| from_placement(&observation, mesh, &own)),
            found.as_ref().and_then(pose),
            told.as_ref().and_then(pose),
            upright.as_ref().and_then(pose),
            together,
            together_told,
        ];
        let [a, b, c, d, e, f, g] = found_poses.map(|found| found.and_then(|pose| judged(mesh, pose)));
        Ok([a, b, c, d, e, f, g, stretched])
    }
}

/// A pose with the errors of a simulated placement, about the middle of the mesh.
fn misplaced(mesh: &Mesh, truth: &Similarity, random: &mut Random) -> Result<Similarity> {
    let bounds = Bounds::of(mesh.positions());
    let (middle, diagonal) = bounds.map_or((Vec3::ZERO, 0.0), |bounds| (bounds.center(), bounds.diagonal()));
    let (size, turn, place) = SIMULATED;
    let mut vector = |deviation: f64| Vector3::from_fn(|_, _| deviation * normal(random));
    let scale = truth.scale * libm::exp(vector(size).x);
    let rotation = truth.rotation * Rotation3::from_scaled_axis(vector(turn.to_radians()));
    let moved = truth.apply(vector3(middle)) + vector(place * truth.scale * f64::from(diagonal));
    Similarity::from_parts(scale, *rotation.matrix(), moved - rotation * vector3(middle) * scale)
}

/// Point-to-point ICP from a placement, at its scale.
fn from_placement(observation: &Observation, mesh: &Mesh, own: &Similarity) -> Option<Similarity> {
    let sampling = Sampling { max_points: 20_000, surface_samples: 10_000, seed: 0 };
    let evidence = Evidence::of(observation, mesh, &sampling).ok()?;
    let reach = REACH * own.scale * f64::from(Bounds::of(mesh.positions())?.diagonal());
    let settings = classical(IcpMetric::PointToPoint, reach as f32, ITERATIONS);
    let tree = KdTree::new(&evidence.observed.points);
    let refined = solve(&evidence.reconstructed, &evidence.observed, &tree, own, &settings).ok()?;
    Some(refined.target_from_source)
}

/// The pixels of all objects but one; `None` if there are no others.
fn others(scene: &BenchScene, k: usize) -> Result<Option<Mask>> {
    let masks: Vec<&Mask> =
        scene.objects.iter().enumerate().filter(|(j, _)| *j != k).map(|(_, object)| &object.mask).collect();
    let Some(first) = masks.first() else { return Ok(None) };
    let is_other = |i: usize| u8::from(masks.iter().any(|mask| mask.data()[i] != 0));
    Image::new("mask", first.width(), first.height(), (0..first.data().len()).map(is_other).collect()).map(Some)
}

/// The share of the objects that a row puts nearer to their true poses, by ADD-S, than the generator.
fn nearer(records: &[(String, Record)], row: usize) -> String {
    let distance = |evaluation: &Option<Evaluation>| Some(evaluation.as_ref()?.layout?.add_s_relative);
    let pairs: Vec<_> = records.iter().filter_map(|(_, r)| Some((distance(&r[row])?, distance(&r[0])?))).collect();
    let count = pairs.iter().filter(|(found, own)| found < own).count();
    cell((row > 0 && !pairs.is_empty()).then(|| 100.0 * count as f64 / pairs.len() as f64), 1)
}

/// A table with a row per method: medians over the objects.
pub fn table(records: &[(String, Record)]) -> String {
    let mut lines = vec![
        "| method | n | strict | loose | scale % | rotation ° | place % | ADD-S % | ADD-S@0.1 | 3D IoU | ICP-Rot ° | nearer % | IoU | depth mm |"
            .to_owned(),
        format!("|---{}|", "|---".repeat(13)),
    ];
    for (k, name) in ROWS.iter().enumerate() {
        let all: Vec<&Evaluation> = records.iter().filter_map(|(_, record)| record[k].as_ref()).collect();
        let of = |digits: usize, value: &dyn Fn(&Evaluation) -> Option<f64>| {
            cell(median(all.iter().filter_map(|each| value(each)).collect()), digits)
        };
        let share = |holds: &dyn Fn(&Evaluation) -> bool| {
            let count = all.iter().filter(|each| holds(each)).count();
            cell((!all.is_empty()).then(|| 100.0 * count as f64 / records.len() as f64), 1)
        };
        // The truth is that of the mesh as it is: a stretched one has no errors against it.
        let is_stretched = k + 1 == ROWS.len();
        let mut cells = vec![(*name).to_owned(), all.len().to_string()];
        if is_stretched {
            cells.extend(core::iter::repeat_n("–".to_owned(), 10));
        } else {
            let errors = |each: &Evaluation| each.errors;
            let layout = |each: &Evaluation| each.layout;
            cells.extend([
                share(&|each| errors(each).is_some_and(|errors| STRICT.holds(&errors))),
                share(&|each| errors(each).is_some_and(|errors| LOOSE.holds(&errors))),
                of(1, &|each| Some(100.0 * errors(each)?.scale_error)),
                of(1, &|each| Some(errors(each)?.rotation_error_deg)),
                of(1, &|each| Some(100.0 * errors(each)?.translation_error_relative)),
                of(2, &|each| Some(100.0 * layout(each)?.add_s_relative)),
                share(&|each| layout(each).is_some_and(|layout| layout.is_found)),
                of(3, &|each| Some(layout(each)?.box_iou)),
                of(1, &|each| Some(layout(each)?.icp_rotation_deg)),
                nearer(records, k),
            ]);
        }
        cells.extend([of(3, &|each| each.metrics.iou), of(1, &|each| each.metrics.depth_mae_mm)]);
        lines.push(format!("| {} |", cells.join(" | ")));
    }
    lines.join("\n")
}
