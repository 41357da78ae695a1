//! Images with objects of known pose, as commands name them: generated, and from folders.

use sim3align_lab::bench::benchmark::BenchCase;
use sim3align_lab::bench::scene_bench::BenchScene;
use sim3align_lab::cases::case::EvaluationSet;
use sim3align_lab::cases::tier::CaseSet;
use sim3align_lab::files::listed;
use sim3align_lab::monocular::picture::Picture;
use sim3align_lab::prelude::*;
use sim3align_lab::scenes::{Prior, SceneSet};

use super::{Arguments, Failure, usage};

/// The source of an image.
pub enum Source {
    Generated(usize),
    Cluttered(usize),
    Case(PathBuf),
    Scene(PathBuf),
}

/// The images that the arguments `--generated`, `--cluttered`, `--cases`, `--scenes` and `--set-seed` name.
pub struct Pictures {
    /// Their sources.
    pub sources: Vec<Source>,
    /// The seed of those that are generated.
    pub seed: u64,
    set: EvaluationSet,
    clutter: SceneSet,
}

impl Pictures {
    /// Takes the arguments.
    pub fn of(arguments: &mut Arguments) -> Result<Self, Failure> {
        let (generated, cluttered): (usize, usize) =
            (arguments.value("generated", 0)?, arguments.value("cluttered", 0)?);
        let cases = folders(&arguments.paths("cases")?, "mesh")?;
        let scenes = folders(&arguments.paths("scenes")?, "objects")?;
        let seed = arguments.value("set-seed", 0)?;
        let sources: Vec<Source> = (0..generated)
            .map(Source::Generated)
            .chain((0..cluttered).map(Source::Cluttered))
            .chain(cases.into_iter().map(Source::Case))
            .chain(scenes.into_iter().map(Source::Scene))
            .collect();
        let set = EvaluationSet::new(seed).of(CaseSet::Monocular);
        Ok(Self { sources, seed, set, clutter: SceneSet::new(seed, cluttered) })
    }

    /// The images, of which there has to be one.
    pub fn some(self) -> Result<Self, Failure> {
        if self.sources.is_empty() {
            return Err(usage("--generated, --cluttered, --cases or --scenes is expected"));
        }
        Ok(self)
    }

    /// The image of a source.
    ///
    /// # Errors
    /// Those of the readers.
    pub fn picture(&self, source: &Source) -> Result<Picture> {
        Ok(match source {
            Source::Generated(index) => Picture { has_steps: true, ..BenchCase::from(self.set.case(*index)?).into() },
            Source::Cluttered(index) => BenchScene::of_cluttered(&self.clutter.scene(*index)?, Prior::Detailed)?.into(),
            Source::Case(folder) => BenchCase::read(folder)?.into(),
            Source::Scene(folder) => BenchScene::read(folder)?.into(),
        })
    }
}

/// The folders themselves if they contain an entry that begins so, otherwise the folders in them that do.
fn folders(paths: &[PathBuf], stem: &str) -> Result<Vec<PathBuf>, Failure> {
    let has = |folder: &Path| {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        entries.into_iter().any(|entry| entry.file_name().to_string_lossy().starts_with(stem))
    };
    let mut found = Vec::new();
    for path in paths {
        if has(path) {
            found.push(path.clone());
        } else {
            found.extend(listed(path)?.into_iter().filter(|folder| has(folder)));
        }
    }
    Ok(found)
}
