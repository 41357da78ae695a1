//! What registers a pair: the one place where methods are plugged in.

use std::path::PathBuf;
use std::time::Instant;

use glam::Vec3;
use serde_json::Value;
use sim3align::align::field::{Field, Options};
use sim3align::align::options::{RegisterOptions, ScaleOption};
use sim3align::align::progress::Silent;
use sim3align::align::register::register;
use sim3align::baselines::{Baseline, PairSettings, register_pair};
use sim3align::geometry::cloud::Cloud;
use sim3align::geometry::similarity::Similarity;
use sim3align::samples::registration::cloud_file::flat;
use sim3align::samples::registration::pair::Pair;
use sim3align::stages::icp::IcpMetric;

/// A registration method. To add one: a variant, its name in [`Method::from_name`], its call in [`Method::run`].
pub enum Method {
    /// `register` with the scale fixed at 1.
    Register(Box<RegisterOptions>),
    /// Another method of the crate's, at the pair's voxel size.
    Baseline(Baseline),
    /// Transforms that another program has written, under a name for the tables.
    Import { name: String, folder: PathBuf },
}

/// A transform, or why there is none, and what it took.
pub struct Answer {
    pub target_from_source: Result<Similarity, String>,
    pub seconds: f64,
}

impl Method {
    /// `register`, a baseline's name, `import:DIR` or `NAME=import:DIR`.
    pub fn from_name(text: &str, assignments: &[String]) -> Result<Self, String> {
        if let Some((before, folder)) = text.split_once("import:") {
            let folder = PathBuf::from(folder);
            let own_name = folder.file_name().map_or("import".into(), |name| name.to_string_lossy().into_owned());
            let name = if before.is_empty() { own_name } else { before.trim_end_matches('=').to_owned() };
            return Ok(Self::Import { name, folder });
        }
        if text != "register" {
            let names = || Baseline::ALL.map(Baseline::as_str).join(", ");
            let unknown = || format!("--method {text}: expected register, {}, or NAME=import:DIR", names());
            return Baseline::from_name(text).map(Self::Baseline).ok_or_else(unknown);
        }
        let mut options = RegisterOptions::default();
        for assignment in assignments {
            let (name, value) = assignment.split_once('=').ok_or_else(|| format!("--option {assignment}: no ="))?;
            assign(&mut options, name, value).ok_or_else(|| format!("--option {assignment}: not an option"))?;
        }
        options.validate().map_err(|error| error.to_string())?;
        Ok(Self::Register(Box::new(options)))
    }

    /// Its name in the tables.
    pub fn name(&self) -> &str {
        match self {
            Self::Register(_) => "register",
            Self::Baseline(baseline) => baseline.as_str(),
            Self::Import { name, .. } => name,
        }
    }

    /// Whether it needs the clouds.
    pub fn needs_clouds(&self) -> bool {
        !matches!(self, Self::Import { .. })
    }

    /// Registers a pair.
    pub fn run(&self, pair: &Pair, source: &[Vec3], target: &[Vec3]) -> Answer {
        match self {
            Self::Register(options) => {
                let (source, target) = (flat(source), flat(target));
                let begun = Instant::now();
                let found = register(&source, &target, ScaleOption::Fixed(1.0), options, &mut Silent);
                let seconds = begun.elapsed().as_secs_f64();
                let pose = found.and_then(|found| Similarity::from_column_major(&found.target_from_source.matrix));
                Answer { target_from_source: pose.map_err(|error| error.to_string()), seconds }
            }
            Self::Baseline(baseline) => {
                let [source, target] = [source, target].map(|points| Cloud::from_points(points.to_vec()));
                let begun = Instant::now();
                // As the tutorials have it, RANSAC's pose is refined.
                let settings =
                    PairSettings { icp: Some(IcpMetric::PointToPlane), ..PairSettings::new(pair.voxel_size_m) };
                let pose = register_pair(&source, &target, *baseline, &settings);
                let seconds = begun.elapsed().as_secs_f64();
                Answer { target_from_source: pose.map_err(|error| error.to_string()), seconds }
            }
            Self::Import { folder, .. } => imported(&folder.join(format!("{}.json", pair.id))),
        }
    }
}

fn assign(options: &mut RegisterOptions, name: &str, text: &str) -> Option<()> {
    let (_, field) = options.fields().into_iter().find(|(own, _)| *own == name)?;
    match field {
        Field::Count { value, .. } => *value = text.parse().ok()?,
        Field::Number { value, .. } => *value = text.parse().ok()?,
        Field::Positive(value) => *value = if text == "null" { None } else { Some(text.parse().ok()?) },
        Field::Choice(choice) => return choice.set(text).then_some(()),
        _ => return None,
    }
    Some(())
}

/// `{ targetFromSource: { scale, rotation: [rows], translation }, seconds }` or `{ error }`.
fn imported(path: &std::path::Path) -> Answer {
    let none = |error: String| Answer { target_from_source: Err(error), seconds: f64::NAN };
    let bytes = match std::fs::read(path) {
        Ok(bytes) => bytes,
        Err(error) => return none(format!("{}: {error}", path.display())),
    };
    let json: Value = match serde_json::from_slice(&bytes) {
        Ok(json) => json,
        Err(error) => return none(format!("{}: {error}", path.display())),
    };
    let seconds = json.get("seconds").and_then(Value::as_f64).unwrap_or(f64::NAN);
    if let Some(error) = json.get("error").and_then(Value::as_str) {
        return Answer { target_from_source: Err(error.to_owned()), seconds };
    }
    let pose = transform(&json).ok_or_else(|| format!("{}: no targetFromSource", path.display()));
    let checked = pose.and_then(|(scale, rotation, translation)| {
        let matrix = nalgebra::Matrix3::from_row_slice(rotation.as_flattened());
        Similarity::from_parts(scale, matrix, translation.into()).map_err(|error| error.to_string())
    });
    Answer { target_from_source: checked, seconds }
}

fn transform(json: &Value) -> Option<(f64, [[f64; 3]; 3], [f64; 3])> {
    let pose = json.get("targetFromSource")?;
    let part = |name: &str| pose.get(name).cloned();
    let scale = part("scale").map_or(Some(1.0), |scale| scale.as_f64())?;
    let rotation = serde_json::from_value(part("rotation")?).ok()?;
    Some((scale, rotation, serde_json::from_value(part("translation")?).ok()?))
}
