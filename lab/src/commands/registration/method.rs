//! The registration methods of the benchmark.

use std::time::Instant;

use sim3align::options::Options;
use sim3align::register::options::RegisterOptions;
use sim3align::register::register;
use sim3align_lab::bench::imported::{CLOUDS, Outcome, answer_in};
use sim3align_lab::bench::option_text;
use sim3align_lab::bench::records::RecordKey;
use sim3align_lab::clouds::cloud_file::flat;
use sim3align_lab::clouds::pair::Pair;
use sim3align_lab::prelude::*;

/// Default inlier distance for imported correspondences, in voxels of the pair.
const INLIER_VOXELS: f64 = 1.5;

/// A registration method.
pub enum Method {
    /// `register`, with the scale fixed at 1 by default.
    Register { options: Box<RegisterOptions>, assignments: Vec<String> },
    /// Transforms of another program, with a name for the tables.
    Import { name: String, folder: PathBuf },
}

/// A transform or an error, and the run time.
pub struct Answer {
    pub target_from_source: Result<Similarity, String>,
    pub seconds: Option<f64>,
}

impl Method {
    /// `register`, `import:DIR` or `NAME=import:DIR`.
    pub fn from_name(text: &str, assignments: &[String]) -> Result<Self, String> {
        if let Some((before, folder)) = text.split_once("import:") {
            let folder = PathBuf::from(folder);
            let own_name = folder.file_name().map_or("import".into(), |name| name.to_string_lossy().into_owned());
            let name = if before.is_empty() { own_name } else { before.trim_end_matches('=').to_owned() };
            return Ok(Self::Import { name, folder });
        }
        if text != "register" {
            return Err(format!("--method {text}: expected register or NAME=import:DIR"));
        }
        let mut options = RegisterOptions { scale: ScaleOption::Fixed(1.0), ..RegisterOptions::default() };
        for assignment in assignments {
            let (name, value) = assignment.split_once('=').ok_or_else(|| format!("--option {assignment}: no ="))?;
            option_text::assign(&mut options, name, value)
                .ok_or_else(|| format!("--option {assignment}: not an option"))??;
        }
        options.validate().map_err(|error| error.to_string())?;
        Ok(Self::Register { options: Box::new(options), assignments: assignments.to_vec() })
    }

    /// Name in the tables.
    pub fn name(&self) -> &str {
        match self {
            Self::Register { .. } => "register",
            Self::Import { name, .. } => name,
        }
    }

    /// The key of its record of a pair; `None` for imported answers, which are read again.
    pub fn key(&self, pair: &Pair) -> Option<RecordKey> {
        let Self::Register { assignments, .. } = self else { return None };
        Some(RecordKey { row: self.name().into(), options: assignments.join(" "), case: pair.id.clone() })
    }

    /// Registers a pair.
    pub fn run(&self, pair: &Pair, source: &[Vec3], target: &[Vec3]) -> Answer {
        match self {
            Self::Register { options, .. } => {
                let (source, target) = (flat(source), flat(target));
                let begun = Instant::now();
                let found = register(&source, &target, options, &mut Silent);
                let seconds = Some(begun.elapsed().as_secs_f64());
                let pose = found.and_then(|found| Similarity::from_column_major(&found.target_from_source.matrix));
                Answer { target_from_source: pose.map_err(|error| error.to_string()), seconds }
            }
            Self::Import { folder, .. } => imported(pair, folder),
        }
    }
}

/// The result of another program.
fn imported(pair: &Pair, folder: &Path) -> Answer {
    let (outcome, seconds) = match answer_in(folder, &pair.id, &CLOUDS) {
        Ok(answer) => (Ok(answer.outcome), answer.seconds),
        Err(error) => (Err(error), None),
    };
    let pose = outcome.and_then(|outcome| match outcome {
        Outcome::Pose(pose) => Ok(pose),
        Outcome::Failure(message) => Err(format!("the method's own error: {message}")),
        Outcome::Pairs(pairs) => {
            let distance = pairs.inlier_distance_m.unwrap_or(INLIER_VOXELS * pair.voxel_size_m);
            let found = pairs.estimate(ScaleOption::Fixed(1.0), distance);
            let pose = found.and_then(|found| Similarity::from_column_major(&found.target_from_source.matrix));
            pose.map_err(|error| error.to_string())
        }
    });
    Answer { target_from_source: pose, seconds }
}
