//! Aligns the objects of scenes alone and together, and compares both with the truth.

use std::fs;
use std::time::Instant;

use serde::Serialize;
use serde_json::Value;

use super::benchmark::{BenchCase, LOOSE, STRICT, Tolerance};
use super::statistics::{cell, median};
use crate::case_folder::case::{depth_and_camera, last_name, mask_in, mesh_in, name_of, truth_of};
use crate::case_folder::json;
use crate::files::entries;
use crate::prelude::*;
use crate::scenes::{Below, ClutteredScene, Prior, ScenePair, Stance};
use sim3align::align::align;
use sim3align::align::evaluate::Truth;
use sim3align::metrics::pose_error::{PoseErrors, pose_errors};
use sim3align::report::Sim3;
use sim3align::scene::contact::Contact;
use sim3align::scene::plane::Plane;
use sim3align::scene::support::{RestsOn, Support, SupportChoice};
use sim3align::scene::task::{PlacedObject, Scene, SceneObject, align_scene};

/// A scene from any source.
#[derive(Debug, Clone)]
pub struct BenchScene {
    /// Its name.
    pub name: String,
    /// Depth.
    pub depth: DepthMap,
    /// Its camera.
    pub camera: Pinhole,
    /// The objects.
    pub objects: Vec<BenchObject>,
    /// The true support.
    pub plane: Option<Plane>,
}

/// An object of a scene.
#[derive(Debug, Clone)]
pub struct BenchObject {
    /// Its name.
    pub name: String,
    /// Its mask.
    pub mask: Mask,
    /// Its mesh.
    pub mesh: Mesh,
    /// The true pose, if known.
    pub truth: Option<Truth>,
    /// How it is held, if known.
    pub stance: Option<&'static str>,
    /// What it rests on, if known; `Some(None)` for an object in the air.
    pub below: Option<Option<RestsOn>>,
}

/// An object, aligned alone and together with the others.
#[derive(Debug, Clone, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct ObjectRecord {
    /// See [`BenchObject`].
    pub name: String,
    /// See [`BenchObject`].
    pub stance: Option<&'static str>,
    /// Errors and confidence of `align`.
    pub alone: Outcome,
    /// Errors and confidence in the scene.
    pub together: Outcome,
    /// What it rests on.
    pub contact: Option<Contact>,
    /// See [`BenchObject`].
    #[serde(skip)]
    pub below: Option<Option<RestsOn>>,
}

/// How well an object was aligned.
#[derive(Debug, Clone, Default, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Outcome {
    /// The pose.
    pub pose: Option<Sim3>,
    /// Errors relative to the truth, if it is known.
    pub errors: Option<PoseErrors>,
    /// Signed relative error of the scale.
    pub scale: Option<f64>,
    /// The angle by which the object leans relative to the true plane, degrees, if both are known.
    pub tilt_deg: Option<f64>,
    /// Height of the lowest vertex over the true plane less that of the true pose, metres.
    pub gap_m: Option<f64>,
    /// Confidence.
    pub confidence: f64,
    /// Why there is no pose.
    pub error: Option<String>,
}

impl Outcome {
    /// Whether the pose is within a tolerance; never if the true pose is unknown.
    fn is_within(&self, tolerance: &Tolerance) -> bool {
        self.errors.is_some_and(|errors| tolerance.holds(&errors))
    }
}

/// A scene, aligned.
#[derive(Debug, Clone, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct SceneRecord {
    /// See [`BenchScene`].
    pub name: String,
    /// The objects.
    pub objects: Vec<ObjectRecord>,
    /// The support found.
    pub support: Option<Support>,
    /// Angle between the normals of the support found and of the true one, degrees, and difference of their heights at
    /// the objects, metres.
    pub plane_errors: Option<[f64; 2]>,
    /// Seconds of all objects alone, and of the scene.
    pub seconds: [f64; 2],
}

impl BenchScene {
    /// A cluttered scene with the meshes of a prior.
    ///
    /// # Errors
    /// Only in case of a bug in the generator.
    pub fn of_cluttered(scene: &ClutteredScene, prior: Prior) -> Result<Self> {
        let cases = scene.pairs.iter().map(|pair| pair.case(prior)).collect::<Result<Vec<_>>>()?;
        let first = &scene.pairs[0];
        // The objects rest on z = 0 of the frame that all share; each has a metric of its own.
        let pose = &first.camera_from_object;
        let normal = pose.rotation * Vector3::z();
        let plane = Plane::new(DVec3::from_array(normal.into()), -normal.dot(&pose.translation));
        let object = |(case, pair): (BenchCase, &ScenePair)| BenchObject {
            name: case.name,
            mask: case.observation.mask().clone(),
            mesh: case.mesh,
            truth: case.truth,
            stance: Some(pair.stance().as_str()),
            below: match pair.below() {
                Below::Table => Some(Some(RestsOn::Support)),
                Below::Board => Some(Some(RestsOn::Level)),
                Below::Air => Some(None),
                Below::Object(k) => {
                    // A thing without a mask is none that a result could name.
                    scene.pairs.iter().position(|other| other.index == k).map(|k| Some(RestsOn::Object(k)))
                }
            },
        };
        Ok(Self {
            name: format!("{:03}-{}", scene.index, prior.as_str()),
            depth: first.observation.depth().clone(),
            camera: first.observation.camera(),
            objects: cases.into_iter().zip(&scene.pairs).map(object).collect(),
            plane,
        })
    }

    /// A scene folder: `depth.npy|png`, `camera.json`, `objects/NAME/` with `mask.png|npy`, `mesh.*` and, optionally,
    /// `gt.json`; optionally `plane.json`, the true support.
    ///
    /// # Errors
    /// Those of [`read_case`](crate::case_folder::case::read_case).
    pub fn read(folder: &Path) -> Result<Self> {
        let (depth, camera) = depth_and_camera(folder)?;
        let folders = entries(&folder.join("objects")).into_iter().filter(|path| path.is_dir());
        let objects = folders.map(|folder| BenchObject::read(&folder)).collect::<Result<_>>()?;
        let plane = fs::read(folder.join("plane.json")).ok().and_then(|bytes| {
            let value: Value = serde_json::from_slice(&bytes).ok()?;
            Plane::new(json::numbers::<3>(value.get("normal")?)?.into(), value.get("d")?.as_f64()?)
        });
        Ok(Self { name: name_of(folder), depth, camera, objects, plane })
    }

    /// Aligns it.
    ///
    /// # Errors
    /// Those of [`align_scene`].
    pub fn run(&self, options: &AlignOptions, snap: bool) -> Result<SceneRecord> {
        let begun = Instant::now();
        let alone: Vec<_> = self.objects.iter().map(|object| self.alone(object, options)).collect();
        let alone_seconds = begun.elapsed().as_secs_f64();
        let scene = Scene { snap, ..self.with_options(|_| options.clone()) };
        let begun = Instant::now();
        let aligned = align_scene(&scene, &mut Silent)?;
        let seconds = [alone_seconds, begun.elapsed().as_secs_f64()];
        let record = |((object, alone), placed): ((&BenchObject, Outcome), &Result<PlacedObject>)| {
            let together = match placed {
                Ok(placed) => self.outcome(object, &placed.alignment.camera_from_mesh, placed.alignment.confidence),
                Err(error) => Outcome { error: Some(error.to_string()), ..Outcome::default() },
            };
            let contact = placed.as_ref().ok().map(|placed| placed.contact.clone());
            ObjectRecord {
                name: object.name.clone(),
                stance: object.stance,
                alone,
                together,
                contact,
                below: object.below,
            }
        };
        let plane_errors = self.plane.zip(aligned.support).map(|(truth, found)| {
            let angle = truth.normal.dot(found.plane.normal).clamp(-1.0, 1.0).acos().to_degrees();
            let center = self.objects.iter().filter_map(|o| o.truth.as_ref()).map(|t| t.camera_from_mesh.translation);
            let count = center.clone().count().max(1) as f64;
            let center = DVec3::from_array((center.sum::<Vector3<f64>>() / count).into());
            [angle, (truth.height(center) - found.plane.height(center)).abs()]
        });
        Ok(SceneRecord {
            name: self.name.clone(),
            objects: self.objects.iter().zip(alone).zip(&aligned.objects).map(record).collect(),
            support: aligned.support,
            plane_errors,
            seconds,
        })
    }

    /// The scene, whose support is to be found, with the options of each object.
    pub(super) fn with_options(&self, options: impl Fn(usize) -> AlignOptions) -> Scene<'_> {
        let object = |(k, object): (usize, &BenchObject)| SceneObject {
            mask: object.mask.clone(),
            mesh: PreparedMesh::new(object.mesh.clone()),
            options: options(k),
        };
        Scene {
            depth: self.depth.clone(),
            camera: self.camera,
            objects: self.objects.iter().enumerate().map(object).collect(),
            occluders: Vec::new(),
            support: SupportChoice::Auto,
            snap: false,
        }
    }

    fn alone(&self, object: &BenchObject, options: &AlignOptions) -> Outcome {
        let aligned = Observation::new(self.depth.clone(), object.mask.clone(), self.camera)
            .and_then(|observation| align(&observation, &object.mesh, options, &mut Silent));
        match aligned {
            Ok(aligned) => self.outcome(object, &aligned.camera_from_mesh, aligned.confidence),
            Err(error) => Outcome { error: Some(error.to_string()), ..Outcome::default() },
        }
    }

    fn outcome(&self, object: &BenchObject, pose: &Sim3, confidence: f64) -> Outcome {
        let mut outcome = Outcome { pose: Some(pose.clone()), confidence, ..Outcome::default() };
        let (Some(truth), Ok(found)) = (&object.truth, Similarity::from_column_major(&pose.matrix)) else {
            return outcome;
        };
        outcome.errors = pose_errors(&object.mesh, &found, &truth.camera_from_mesh, &truth.symmetry).ok();
        outcome.scale = Some(found.scale / truth.camera_from_mesh.scale - 1.0);
        if let Some(plane) = self.plane {
            let up = Vector3::from(plane.normal.to_array());
            let relative =
                UnitQuaternion::from_rotation_matrix(&(truth.camera_from_mesh.rotation.inverse() * found.rotation));
            // The true pose in the equivalent rotation that is nearest.
            let same = truth.symmetry.group(&object.mesh).map_or(relative, |group| group.nearest(&relative));
            let leaning = found.rotation * (same.inverse() * (truth.camera_from_mesh.rotation.inverse() * up));
            outcome.tilt_deg = Some(leaning.dot(&up).clamp(-1.0, 1.0).acos().to_degrees());
            let lowest = |pose: &Similarity| {
                let heights = object.mesh.positions().iter().map(|p| up.dot(&pose.apply(vector3(*p))));
                heights.fold(f64::INFINITY, f64::min)
            };
            outcome.gap_m = Some(lowest(&found) - lowest(&truth.camera_from_mesh));
        }
        outcome
    }
}

impl BenchObject {
    fn read(folder: &Path) -> Result<Self> {
        let truth = |(camera_from_mesh, words): (Similarity, String)| Truth {
            camera_from_mesh,
            symmetry: Symmetry::from_description(&words),
        };
        Ok(Self {
            name: last_name(folder),
            mask: mask_in(folder)?,
            mesh: mesh_in(folder)?.mesh,
            truth: truth_of(folder)?.map(truth),
            stance: None,
            below: None,
        })
    }
}

/// The table of a set of scenes.
pub fn table(scenes: &[SceneRecord]) -> String {
    let objects: Vec<&ObjectRecord> = scenes.iter().flat_map(|scene| &scene.objects).collect();
    let mut text = table_of("all", scenes, &objects);
    for stance in Stance::ALL.iter().map(|stance| stance.as_str()) {
        let held: Vec<&ObjectRecord> = objects.iter().copied().filter(|o| o.stance == Some(stance)).collect();
        if !held.is_empty() && held.len() < objects.len() {
            text += "\n";
            text += &table_of(stance, scenes, &held);
        }
    }
    text
}

fn table_of(name: &str, scenes: &[SceneRecord], objects: &[&ObjectRecord]) -> String {
    let of = |outcome: &dyn Fn(&ObjectRecord) -> Outcome| row(&objects.iter().map(|o| outcome(o)).collect::<Vec<_>>());
    let right = |outcome: &Outcome| outcome.is_within(&STRICT);
    let count = |test: &dyn Fn(&&ObjectRecord) -> bool| objects.iter().copied().filter(|o| test(o)).count();
    let (worse, better) =
        (count(&|o| right(&o.alone) && !right(&o.together)), count(&|o| !right(&o.alone) && right(&o.together)));
    let shared = objects.iter().filter_map(|o| o.contact.as_ref()).map(|c| c.shared_volume).collect();
    let resting = count(&|o| o.contact.as_ref().is_some_and(|c| c.rests_on == Some(RestsOn::Support)));
    let told = count(&|o| o.below.is_some_and(|below| o.contact.as_ref().is_some_and(|c| c.rests_on == below)));
    let tellable = count(&|o| o.below.is_some());
    let overlapping = count(&|o| o.contact.as_ref().is_some_and(|c| c.shared_volume > 0.005));
    let planes: Vec<[f64; 2]> = scenes.iter().filter_map(|scene| scene.plane_errors).collect();
    let time: f64 = scenes.iter().map(|s| s.seconds[1]).sum::<f64>() / scenes.iter().map(|s| s.seconds[0]).sum::<f64>();
    let number = |x: Option<f64>, unit: f64| cell(x.map(|x| unit * x), 2);
    format!(
        "{name}: {} scenes, {} objects\n\n| | strict | loose | tilt ≤ 3° | median tilt, ° | median gap, mm | confidence where right, wrong |\n|---|---|---|---|---|---|---|\n| alone | {} |\n| together | {} |\n\nright alone and wrong together: {worse}; wrong alone and right together: {better}\non the support: {resting}; contact right: {told} of {tellable}; median shared volume: {} %, over .5 %: {overlapping}; planes found: {}, median errors {}°, {} mm; time: {time:.2} ×\n",
        scenes.len(),
        objects.len(),
        of(&|o| o.alone.clone()),
        of(&|o| o.together.clone()),
        number(median(shared), 100.0),
        scenes.iter().filter(|s| s.support.is_some()).count(),
        number(median(planes.iter().map(|p| p[0]).collect()), 1.0),
        number(median(planes.iter().map(|p| p[1]).collect()), 1000.0),
    )
}

fn row(outcomes: &[Outcome]) -> String {
    let known = outcomes.len().max(1) as f64;
    let share = |tolerance: &Tolerance| {
        let right = outcomes.iter().filter(|o| o.is_within(tolerance)).count();
        format!("{:.1} %", 100.0 * right as f64 / known)
    };
    let tilts: Vec<f64> = outcomes.iter().filter_map(|o| o.tilt_deg).collect();
    let level = tilts.iter().filter(|tilt| **tilt <= 3.0).count() as f64 / tilts.len().max(1) as f64;
    let gaps = outcomes.iter().filter_map(|o| o.gap_m.map(f64::abs)).collect();
    let sure = |is_right: bool| {
        let of = outcomes.iter().filter(|o| o.is_within(&STRICT) == is_right);
        cell(median(of.map(|o| o.confidence).collect()), 2)
    };
    format!(
        "{} | {} | {:.1} % | {} | {} | {}, {}",
        share(&STRICT),
        share(&LOOSE),
        100.0 * level,
        cell(median(tilts), 2),
        cell(median(gaps).map(|gap| 1000.0 * gap), 2),
        sure(true),
        sure(false),
    )
}
