//! Results of other programs, one JSON file per case, evaluated like those of the aligner. `docs/importing-results.md`
//! describes the files.

use std::io::ErrorKind;

use serde_json::{Map, Value};

use super::benchmark::{BenchCase, Record, described, record_of};
use crate::case_folder::{json, pose};
use crate::prelude::*;
use sim3align::align::Setup;
use sim3align::align::align_by;
use sim3align::evidence::extents::{Extents, initial_scale};
use sim3align::progress::Stage;
use sim3align::register::estimate_sim3;
use sim3align::register::options::EstimateSim3Options;
use sim3align::register::report::Registration;
use sim3align::report::Solution;
use sim3align::report::{AnyAlignment, Counts};
use sim3align_geometry::error::Text;

const REMEDY: &str = "docs/importing-results.md describes the file.";

/// Names of the fields of a result file.
#[derive(Debug, Clone, Copy)]
pub struct Names {
    /// The pose.
    pub pose: &'static str,
    /// Field of the transformed points of correspondences.
    pub moved: &'static str,
    /// Field of the reference points of correspondences.
    pub fixed: &'static str,
}

/// Fields of the result for a case.
pub const CASE: Names = Names { pose: "cameraFromMesh", moved: "mesh", fixed: "camera" };

/// Fields of the result for a pair of clouds.
pub const CLOUDS: Names = Names { pose: "targetFromSource", moved: "source", fixed: "target" };

/// When each stage begins, as a share of the whole: all that is computed here is the metrics.
const PLAN: &[(Stage, f64)] = &[(Stage::Observe, 0.0), (Stage::Metrics, 0.2)];

/// An inlier's distance by default, as a share of the box diagonal of P_obs: 1.5 voxels of the paper's.
const INLIER_DISTANCE: f64 = 0.05;

/// The content of a result file.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// The pose, or the data that determine it.
    pub outcome: Outcome,
    /// Run time of the program, if known, in seconds.
    pub seconds: Option<f64>,
}

/// A result without its run time.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// The pose itself.
    Pose(Similarity),
    /// Correspondences from which the pose is estimated.
    Pairs(Pairs),
    /// The error message of the program.
    Failure(String),
}

/// Corresponding points, by position.
#[derive(Debug, Clone, PartialEq)]
pub struct Pairs {
    /// Those that the pose moves, in the mesh's or the source's frame, x, y, z one after the other.
    pub moved_xyz: Vec<f64>,
    /// Those that stay, in the camera's or the target's frame, metres, likewise.
    pub fixed_xyz: Vec<f64>,
    /// What the estimate may do with the scale.
    pub scale: PairScale,
    /// A pair that the pose leaves further apart is an outlier; by default a twentieth of the box diagonal of P_obs.
    pub inlier_distance_m: Option<f64>,
}

impl Pairs {
    /// The similarity with the highest consensus, by `estimateSim3`.
    ///
    /// # Errors
    /// Those of [`estimate_sim3`].
    pub fn estimate(&self, scale: ScaleOption, inlier_distance: f64) -> Result<Registration> {
        let indices: Vec<u32> =
            (0..u32::try_from(self.moved_xyz.len() / 3).unwrap_or(u32::MAX)).flat_map(|i| [i, i]).collect();
        let options =
            EstimateSim3Options { scale, inlier_distance: Some(inlier_distance), ..EstimateSim3Options::default() };
        estimate_sim3(&self.moved_xyz, &self.fixed_xyz, &indices, &options, &mut Silent)
    }
}

/// What the estimate from pairs may do with the scale.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PairScale {
    /// It is s_init, the ratio of the boxes: the paper's unified preprocessing.
    Initial,
    /// Estimated, within the paper's guard around s_init.
    Bounded,
    /// Estimated.
    Free,
}

/// The record of a case by the answer in `folder`, in the file of the case's name. Its seconds are the file's own, NaN
/// where there are none. What is wrong with the file is the record's error.
pub fn imported(case: &BenchCase, folder: &Path) -> Record {
    let (outcome, seconds) = match answer_in(folder, &case.name, &CASE) {
        Ok(Answer { outcome, seconds }) => (align_as(case, outcome), seconds),
        Err(error) => (Err(error), None),
    };
    record_of(case, outcome, seconds.unwrap_or(f64::NAN))
}

/// The answer to `case` in `folder`, or what is wrong with it, in words.
///
/// # Errors
/// Those of [`read_answer`], and that there is no such file.
pub fn answer_in(folder: &Path, case: &str, names: &Names) -> Result<Answer, String> {
    let path = folder.join(format!("{case}.json"));
    match std::fs::read(&path) {
        Ok(bytes) => read_answer(&path.display().to_string(), names, &bytes).map_err(|error| described(&error)),
        Err(error) if error.kind() == ErrorKind::NotFound => Err("no answer file".into()),
        Err(error) => Err(described(&unreadable(&path, &error))),
    }
}

fn unreadable(path: &Path, error: &std::io::Error) -> Error {
    let (argument, found) = (path.display().to_string(), error.to_string());
    Error::new(ErrorCode::CorruptFile, argument, found, "a file that can be read", "Check its permissions.")
}

/// The report of a pose that is known beforehand, or follows from pairs.
fn align_as(case: &BenchCase, outcome: Outcome) -> Result<AnyAlignment, String> {
    if let Outcome::Failure(message) = outcome {
        return Err(format!("the method's own error: {message}"));
    }
    let aligned = Setup::of_paper(&PaperOptions::default()).and_then(|setup| {
        align_by(&case.observation, &case.mesh, &setup, PLAN, &mut Silent, |clouds, _| {
            let solution = match &outcome {
                Outcome::Pairs(pairs) => estimated(pairs, clouds.extents())?,
                Outcome::Pose(pose) => (Solution::of_pose(*pose), Counts::default()),
                // Taken care of above.
                Outcome::Failure(_) => (Solution::of_pose(Similarity::identity()), Counts::default()),
            };
            Ok(solution)
        })
    });
    aligned.map(Into::into).map_err(|error| described(&error))
}

fn estimated(pairs: &Pairs, [observed, reconstructed]: [&Extents; 2]) -> Result<(Solution, Counts)> {
    let initial = initial_scale(observed, reconstructed);
    let scale = match (pairs.scale, PaperOptions::default().guard) {
        (PairScale::Initial, _) => ScaleOption::Fixed(initial),
        (PairScale::Bounded, Some([min, max])) => ScaleOption::Between([min * initial, max * initial]),
        (PairScale::Bounded, None) | (PairScale::Free, _) => ScaleOption::Free,
    };
    let inlier_distance = pairs.inlier_distance_m.unwrap_or(INLIER_DISTANCE * observed.diagonal());
    let found = pairs.estimate(scale, inlier_distance)?;
    let pose = Similarity::from_column_major(&found.target_from_source.matrix)?;
    Ok((Solution { residual_m: found.residual, ..Solution::of_pose(pose) }, found.diagnostics.counts))
}

/// Reads an answer. `argument` names the file in errors, `names` is what its parts are called.
///
/// # Errors
/// [`ErrorCode::CorruptFile`] for what is no JSON or holds something else, [`ErrorCode::InvalidTransform`] for what is
/// no similarity, [`ErrorCode::WrongLength`] and [`ErrorCode::TooFewPoints`] for pairs that are none.
pub fn read_answer(argument: &str, names: &Names, bytes: &[u8]) -> Result<Answer> {
    let in_file = |error: Error| {
        let within = format!("{argument}: {}", error.argument);
        error.about(within)
    };
    let value = json::parse(argument, bytes)?;
    let Some(fields) = value.as_object() else {
        return Err(invalid(argument, json::found(Some(&value)), "a JSON object"));
    };
    let seconds = fields.get("seconds").map(|value| non_negative("seconds", value)).transpose().map_err(in_file)?;
    let answers: Vec<(&str, &Value)> = [names.pose, "correspondences", "error"]
        .into_iter()
        .filter_map(|name| Some((name, fields.get(name)?)))
        .collect();
    let outcome = match answers[..] {
        [(name, value)] if name == names.pose => pose::similarity(name, value).map(Outcome::Pose),
        [("correspondences", pairs)] => read_pairs(names, pairs, fields).map(Outcome::Pairs),
        [("error", message)] => match message.as_str() {
            Some(message) => Ok(Outcome::Failure(message.to_owned())),
            None => Err(invalid("error", json::found(Some(message)), "text")),
        },
        _ => {
            let given: Vec<&str> = fields.keys().map(String::as_str).take(12).collect();
            let found =
                format!("an object with {}", if given.is_empty() { "nothing".into() } else { given.join(", ") });
            return Err(invalid(argument, found, format!("one of {}, correspondences, error", names.pose)));
        }
    };
    Ok(Answer { outcome: outcome.map_err(in_file)?, seconds })
}

fn read_pairs(names: &Names, value: &Value, fields: &Map<String, Value>) -> Result<Pairs> {
    let points = |name: &str| -> Result<Vec<f64>> {
        let argument = format!("correspondences.{name}");
        let expected = "an array of points, each [x, y, z]";
        let points = value.get(name).and_then(Value::as_array);
        let points = points.ok_or_else(|| invalid(&argument, json::found(value.get(name)), expected))?;
        let mut xyz = Vec::with_capacity(3 * points.len());
        for (i, point) in points.iter().enumerate() {
            let wrong = || invalid(&argument, format!("{} as point {i}", json::found(Some(point))), expected);
            xyz.extend(json::numbers::<3>(point).ok_or_else(wrong)?);
        }
        Ok(xyz)
    };
    let (moved_xyz, fixed_xyz) = (points(names.moved)?, points(names.fixed)?);
    let (moved, fixed) = (moved_xyz.len() / 3, fixed_xyz.len() / 3);
    if moved != fixed {
        return Err(Error::new(
            ErrorCode::WrongLength,
            "correspondences",
            format!("{moved} points of {} and {fixed} of {}", names.moved, names.fixed),
            "as many of each",
            "The i-th point of the one belongs to the i-th of the other.",
        ));
    }
    if moved < 3 {
        let (found, remedy) = (format!("{moved} pairs"), "Write { \"error\": … } where a matcher finds no more.");
        return Err(Error::new(ErrorCode::TooFewPoints, "correspondences", found, "at least 3", remedy));
    }
    let scale = match fields.get("scale").map(|scale| (scale.as_str(), scale)) {
        None | Some((Some("initial"), _)) => PairScale::Initial,
        Some((Some("bounded"), _)) => PairScale::Bounded,
        Some((Some("free"), _)) => PairScale::Free,
        Some((_, scale)) => {
            return Err(invalid("scale", json::found(Some(scale)), "\"initial\", \"bounded\" or \"free\""));
        }
    };
    let inlier_distance_m = fields.get("inlierDistanceM").map(|value| match non_negative("inlierDistanceM", value)? {
        0.0 => Err(invalid("inlierDistanceM", "0".into(), "a number above 0, metres")),
        distance => Ok(distance),
    });
    Ok(Pairs { moved_xyz, fixed_xyz, scale, inlier_distance_m: inlier_distance_m.transpose()? })
}

fn non_negative(name: &str, value: &Value) -> Result<f64> {
    let number = value.as_f64().filter(|number| number.is_finite() && *number >= 0.0);
    number.ok_or_else(|| invalid(name, json::found(Some(value)), "a number from 0"))
}

fn invalid(argument: &str, found: String, expected: impl Into<Text>) -> Error {
    Error::new(ErrorCode::CorruptFile, argument.to_owned(), found, expected, REMEDY)
}
