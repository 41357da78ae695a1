//! Runs methods over cases, and records the results for tables.

use std::rc::Rc;
use std::time::Instant;

use serde::Serialize;
use serde_json::{Value, json};

use crate::case_folder::case::read_case;
use crate::case_folder::contents::{case_files, parameters_json, symmetry_json};
use crate::cases::case::EvaluationCase;
use crate::cpu_time::CpuTimer;
use crate::files::NamedFile;
use crate::prelude::*;
use sim3align::align::evaluate::{EvaluateOptions, Truth, evaluate};
use sim3align::align::method::Method;
use sim3align::align::search::Request;
use sim3align::align::{align_paper, align_prepared};
use sim3align::metrics::Metrics;
use sim3align::metrics::layout::LayoutErrors;
use sim3align::metrics::pose_error::{PoseComparison, PoseErrors};
use sim3align::precise::drawn::mesh_pyramid::MeshPyramid;
use sim3align::precise::drawn::pose::CropPose;
use sim3align::precise::observed::clean::CleanObservation;
use sim3align::precise::searched::efforts;
use sim3align::precise::searched::recipe::{FIRST_REFINEMENT, SearchSettings};
use sim3align::precise::searched::search::Search;
use sim3align::progress::{Host, Stage};
use sim3align::report::{Alternative, AnyAlignment, Sim3};

/// A case from any source.
#[derive(Debug, Clone)]
pub struct BenchCase {
    /// Its name.
    pub name: String,
    /// `"easy"`, `"medium"`, `"hard"`; of a folder, what its `meta.json` says, else `"given"`.
    pub tier: String,
    /// Of a folder, what its `meta.json` says, else `"given"`.
    pub class: String,
    /// The object.
    pub family: String,
    /// Names of the simulated errors.
    pub tags: Vec<String>,
    /// Magnitudes of the simulated errors, by name.
    pub parameters: Value,
    /// Depth, mask and camera, and the photo if there is one.
    pub observation: Observation,
    /// The mesh.
    pub mesh: Mesh,
    /// What methods get instead, where it has parts that are not of the object.
    pub given: Option<Mesh>,
    /// Its colours, if it has any.
    pub colors: Option<SurfaceColors>,
    /// The true pose, if known.
    pub truth: Option<Truth>,
}

/// The record of a case.
#[derive(Debug, Clone, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Record {
    /// See [`BenchCase`].
    pub name: String,
    /// See [`BenchCase`].
    pub tier: String,
    /// See [`BenchCase`].
    pub class: String,
    /// See [`BenchCase`].
    pub family: String,
    /// See [`BenchCase`].
    pub tags: Vec<String>,
    /// See [`BenchCase`].
    pub parameters: Value,
    /// The result of `align`.
    pub alignment: Option<AnyAlignment>,
    /// The error, if it failed.
    pub error: Option<String>,
    /// Errors relative to the true pose, if available.
    pub errors: Option<PoseErrors>,
    /// Errors of layout relative to the true pose, if available.
    pub layout: Option<LayoutErrors>,
    /// Index of the first alternative within [`STRICT`], if any.
    pub right_alternative: Option<usize>,
    /// Index of the first alternative within [`LOOSE`], if any.
    pub near_alternative: Option<usize>,
    /// Metrics of the true pose.
    pub truth_metrics: Option<Metrics>,
    /// Score of the true pose by the objective of the search.
    pub truth_score: Option<f64>,
    /// Ratio of the true to the initial scale, s / s_init.
    pub truth_scale_ratio: Option<f64>,
    /// CPU time of `align`, which a busy machine changes little; NaN, `null` in JSON, where another program did not say
    /// what it took.
    pub seconds: f64,
}

/// Maximum errors of a success.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// |s / s_true − 1|.
    pub scale: f64,
    /// Degrees.
    pub rotation_deg: f64,
    /// Fraction of the diameter.
    pub translation: f64,
}

/// Scale within 5 %, rotation within 10°, translation within 5 % of the diameter.
pub const STRICT: Tolerance = Tolerance { scale: 0.05, rotation_deg: 10.0, translation: 0.05 };
/// Twice the errors of [`STRICT`].
pub const LOOSE: Tolerance = Tolerance { scale: 0.1, rotation_deg: 20.0, translation: 0.1 };

impl Tolerance {
    /// Whether the errors of a pose are within the tolerance.
    pub fn holds(&self, errors: &PoseErrors) -> bool {
        errors.scale_error <= self.scale
            && errors.rotation_error_deg <= self.rotation_deg
            && errors.translation_error_relative <= self.translation
    }
}

impl Record {
    /// Whether the pose is within a tolerance; `None` if the true pose is unknown. An error is a failure.
    pub fn success(&self, tolerance: &Tolerance) -> Option<bool> {
        self.truth_metrics.map(|_| self.errors.is_some_and(|errors| tolerance.holds(&errors)))
    }
}

impl From<EvaluationCase> for BenchCase {
    fn from(case: EvaluationCase) -> Self {
        let parameters = parameters_json(&case.parameters);
        Self {
            name: case.name(),
            tier: case.tier.as_str().into(),
            class: case.class.as_str().into(),
            family: case.family,
            tags: case.tags.iter().map(|tag| (*tag).to_owned()).collect(),
            parameters,
            observation: case.observation,
            mesh: case.mesh,
            given: None,
            colors: case.colors,
            truth: Some(Truth { camera_from_mesh: case.camera_from_mesh, symmetry: case.symmetry }),
        }
    }
}

impl BenchCase {
    /// A case folder, with what a generated one says of itself in `meta.json` and `gt.json`.
    ///
    /// # Errors
    /// Those of [`read_case`], and [`ErrorCode::CorruptFile`] for `symmetryAxes` that are none.
    pub fn read(folder: &Path) -> Result<Self> {
        let case = read_case(folder)?;
        if let Some(problem) = &case.color_problem {
            eprintln!("\nwithout colours: {problem}");
        }
        let json =
            |name: &str| -> Option<Value> { serde_json::from_slice(&std::fs::read(folder.join(name)).ok()?).ok() };
        let meta = json("meta.json").unwrap_or_default();
        let text = |name: &str| meta.get(name).and_then(Value::as_str).unwrap_or("given").to_owned();
        let tags = meta.get("tags").and_then(Value::as_array).into_iter().flatten();
        let axes = json("gt.json").and_then(|truth| truth.get("symmetryAxes").cloned());
        let truth = case.truth.map(|(camera_from_mesh, words)| {
            let symmetry = match &axes {
                None => Symmetry::from_description(&words),
                Some(axes) => symmetry_of(axes).ok_or_else(|| {
                    let found = "something else";
                    let expected = "an array of { axis: [x, y, z], fold: number or null }";
                    let argument = folder.join("gt.json").display().to_string();
                    Error::new(ErrorCode::CorruptFile, argument, found, expected, "Write symmetryAxes so.")
                })?,
            };
            Ok(Truth { camera_from_mesh, symmetry })
        });
        Ok(Self {
            name: case.name,
            tier: text("tier"),
            class: text("class"),
            family: text("family"),
            tags: tags.filter_map(|tag| Some(tag.as_str()?.to_owned())).collect(),
            parameters: meta.get("parameters").cloned().unwrap_or_default(),
            observation: case.observation,
            mesh: case.mesh,
            given: None,
            colors: case.colors,
            truth: truth.transpose()?,
        })
    }

    /// The files of its case folder: name and content. `gt.json` has the symmetry in words, as all readers understand them,
    /// and, exactly, as `symmetryAxes`; `note` says there what was generated. `index` is that in a set. For `depth_scale`
    /// see [`view_files`](crate::case_folder::contents::view_files).
    ///
    /// # Errors
    /// [`ErrorCode::Internal`] if an encoder fails, or for a case without truth.
    pub(crate) fn files(
        &self,
        note: &str,
        mesh_files: Vec<NamedFile>,
        index: Option<usize>,
        depth_scale: Option<f64>,
    ) -> Result<Vec<NamedFile>> {
        let none = || Error::new(ErrorCode::Internal, "case", "no true pose", "a generated case", "Please report it.");
        let Truth { camera_from_mesh, symmetry } = self.truth.as_ref().ok_or_else(none)?;
        let truth = symmetry_json(symmetry, note);
        let mut files = case_files(&self.observation, mesh_files, camera_from_mesh, truth, depth_scale)?;
        let mut meta = json!({
            "tier": self.tier,
            "class": self.class,
            "family": self.family,
            "tags": self.tags,
            "parameters": self.parameters,
        });
        if let Some(index) = index {
            meta["index"] = json!(index);
        }
        files.push(("meta.json", format!("{meta:#}\n").into_bytes()));
        Ok(files)
    }

    /// The case without its photo and colours.
    pub fn without_color(self) -> Self {
        Self { observation: self.observation.without_photo(), colors: None, ..self }
    }
}

fn symmetry_of(axes: &Value) -> Option<Symmetry> {
    let axes: Option<Vec<SymmetryAxis>> = axes
        .as_array()?
        .iter()
        .map(|declared| {
            let numbers = declared.get("axis")?.as_array()?;
            let axis: Option<Vec<f64>> = numbers.iter().map(Value::as_f64).collect();
            let [x, y, z] = axis?.try_into().ok()?;
            let fold = declared.get("fold").and_then(Value::as_u64).and_then(|fold| u32::try_from(fold).ok());
            Some(SymmetryAxis { axis: Vector3::new(x, y, z), fold })
        })
        .collect();
    let axes = axes?;
    Some(if axes.is_empty() { Symmetry::None } else { Symmetry::Declared(axes) })
}

/// A host with a clock and no listener.
pub struct Clock(Instant);

impl Default for Clock {
    fn default() -> Self {
        Self(Instant::now())
    }
}

impl Host for Clock {
    fn now_ms(&mut self) -> f64 {
        1000.0 * self.0.elapsed().as_secs_f64()
    }

    fn progress(&mut self, _stage: Stage, _fraction: f64) {}
}

/// Aligns a case and scores what came of it, and the truth beside it.
///
/// `overrides` change single settings of the search (see [`override_setting`]).
pub fn run_case(case: &BenchCase, method: &Method, overrides: &[(String, f64)]) -> Record {
    run_prepared(case, method, overrides, |mesh| PreparedMesh::borrowed(mesh))
}

type Prepare = fn(&Mesh) -> PreparedMesh<'_>;

/// [`run_case`] with another way to prepare the mesh.
pub fn run_prepared(case: &BenchCase, method: &Method, overrides: &[(String, f64)], prepare: Prepare) -> Record {
    let mut searches = match method {
        Method::Precise(options) => efforts::of(options),
        Method::Paper(_) => efforts::of(&AlignOptions::default()),
    };
    for (name, value) in overrides {
        searches.iter_mut().for_each(|settings| {
            override_setting(settings, name, *value);
        });
    }
    let mut record = run_method(case, |observation, mesh, host| match method {
        Method::Precise(options) => {
            let mesh = prepare(mesh).with_colors(case.colors.clone());
            let request = Request::new(options.clone())?.with_efforts(searches.clone());
            align_prepared(observation, &mesh, request, host).map(Into::into)
        }
        Method::Paper(options) => align_paper(observation, mesh, options, host).map(Into::into),
    });
    record.truth_score = case.truth.as_ref().and_then(|truth| {
        // By the objective of the search that found the pose: scores of others are not comparable.
        let effort = record.alignment.as_ref().and_then(|alignment| match alignment {
            AnyAlignment::Precise(alignment) => Some(alignment.diagnostics.effort),
            AnyAlignment::Paper(_) => None,
        });
        let settings = searches.iter().find(|s| Some(s.effort) == effort).or(searches.last())?;
        let mesh = MeshPyramid::new(&case.mesh, &settings.grids)?;
        let search = Search::new(Rc::new(CleanObservation::new(&case.observation)), Rc::new(mesh), *settings);
        let pose = CropPose::of_similarity(&truth.camera_from_mesh, &search.mesh.frame)?;
        Some(f64::from(search.score(&pose).total))
    });
    record
}

/// Sets one of the search's settings by its name; `false` where there is none of that name. Flags are 0 or 1.
pub fn override_setting(settings: &mut SearchSettings, name: &str, value: f64) -> bool {
    let count = value as usize;
    match name {
        "rotations" => settings.rounds[0].work = count,
        name if let Some(round) = element(name, "keep", &mut settings.rounds) => round.keep = count,
        // Of the refinements, counted from 0.
        name if let Some(round) = element(name, "iterations", &mut settings.rounds[FIRST_REFINEMENT..]) => {
            round.work = count;
        }
        name if let Some(grid) = element(name, "cells", &mut settings.grids) => grid.cells = count,
        name if let Some(grid) = element(name, "triangles", &mut settings.grids) => grid.triangles = count,
        name if let Some(grid) = element(name, "depthError", &mut settings.grids) => grid.depth_error = value,
        "overlap" => settings.weights.overlap = value as f32,
        "depth" => settings.weights.depth = value as f32,
        "normals" => settings.weights.normals = value as f32,
        "outline" => settings.weights.outline = value as f32,
        "occluded" => settings.weights.occluded = value as f32,
        "unknown" => settings.weights.unknown = value as f32,
        "occlusion" => settings.occlusion = value != 0.0,
        "anchors" => settings.anchors = value != 0.0,
        "lockScale" => settings.lock_scale = value != 0.0,
        _ => return false,
    }
    true
}

/// The element that `name` is the `stem` and index of.
fn element<'a, T>(name: &str, stem: &str, values: &'a mut [T]) -> Option<&'a mut T> {
    let index = name.strip_prefix(stem)?.parse::<usize>().ok()?;
    values.get_mut(index)
}

/// Like [`run_case`], for any method.
pub fn run_method(
    case: &BenchCase,
    method: impl FnOnce(&Observation, &Mesh, &mut dyn Host) -> Result<AnyAlignment>,
) -> Record {
    let timer = CpuTimer::start();
    let outcome = method(&case.observation, case.given.as_ref().unwrap_or(&case.mesh), &mut Clock::default());
    let seconds = timer.seconds();
    record_of(case, outcome.map_err(|error| described(&error)), seconds)
}

/// Text of an error in a record.
pub(super) fn described(error: &Error) -> String {
    format!("{}: {error}", error.code.as_str())
}

/// The record of a case: the result or error, and the run time.
pub(super) fn record_of(case: &BenchCase, outcome: Result<AnyAlignment, String>, seconds: f64) -> Record {
    let (alignment, error) = match outcome {
        Ok(alignment) => (Some(alignment), None),
        Err(error) => (None, Some(error)),
    };
    let evaluated = case.truth.as_ref().map(|truth| {
        let scored = evaluate(&case.observation, &case.mesh, &truth.camera_from_mesh, &EvaluateOptions::default());
        let compared = |pose: &Sim3| -> Result<_> {
            let pose = Similarity::from_column_major(&pose.matrix)?;
            let comparison = PoseComparison::new(&case.mesh, &pose, &truth.camera_from_mesh, &truth.symmetry)?;
            let errors = comparison.errors()?;
            Ok((comparison, errors))
        };
        let of_answer = |answer: &AnyAlignment| -> Result<_> {
            let (comparison, errors) = compared(answer.camera_from_mesh())?;
            Ok((errors, LayoutErrors::of(&comparison, &errors)?))
        };
        let alternatives = alignment.as_ref().map_or(&[][..], AnyAlignment::alternatives);
        let [right, near] = [STRICT, LOOSE].map(|tolerance| {
            let is_within = |other: &Alternative| {
                compared(&other.camera_from_mesh).is_ok_and(|(_, errors)| tolerance.holds(&errors))
            };
            alternatives.iter().position(is_within)
        });
        (scored.ok(), alignment.as_ref().and_then(|answer| of_answer(answer).ok()), right, near)
    });
    let (scored, errors, right_alternative, near_alternative) = evaluated.unwrap_or_default();
    let (errors, layout) = errors.unzip();
    Record {
        name: case.name.clone(),
        tier: case.tier.clone(),
        class: case.class.clone(),
        family: case.family.clone(),
        tags: case.tags.clone(),
        parameters: case.parameters.clone(),
        alignment,
        error,
        errors,
        layout,
        right_alternative,
        near_alternative,
        truth_metrics: scored.as_ref().map(|scored| scored.metrics),
        truth_score: None,
        truth_scale_ratio: scored.map(|scored| scored.diagnostics.scale_ratio),
        seconds,
    }
}
