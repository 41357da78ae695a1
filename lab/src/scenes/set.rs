//! The set: how many objects each of its scenes has.

use std::fs;

use serde_json::json;

use super::prior::Prior;
use super::scene::ClutteredScene;
use crate::cases::streams::COUNT_STREAM;
use crate::files::{unwritable, write_files};
use crate::parallel::parallel_map;
use crate::prelude::*;

/// Default number of scenes of a set.
pub const SCENES: usize = 100;

/// Of 100 scenes, how many have four objects, and how many three or more; the others have two. That makes 338 pairs.
const FOUR: usize = 52;
const THREE_OR_MORE: usize = 86;
/// So many scenes, each time, have them as evenly as can be, in an order of their own.
const BLOCK: usize = 10;

/// Objects of the arranged scenes, in turn.
const ARRANGED: [usize; 8] = [4, 2, 6, 3, 8, 5, 12, 7];

/// File in the output folder that identifies the set.
const LABEL: &str = "set.json";

/// A set of cluttered scenes.
#[derive(Debug, Clone)]
pub struct SceneSet {
    seed: u64,
    /// Objects of each scene.
    objects: Vec<usize>,
    /// Whether objects also lean, hang and stand on each other.
    is_arranged: bool,
}

impl SceneSet {
    /// The set of a seed and a number of scenes. A larger set begins with the scenes of a smaller one.
    pub fn new(seed: u64, scenes: usize) -> Self {
        let blocks = scenes.div_ceil(BLOCK);
        let objects = (0..blocks).flat_map(|block| objects_of_block(seed, block)).take(scenes).collect();
        Self { seed, objects, is_arranged: false }
    }

    /// A set whose objects also lean, hang, stand on each other and on boards, and lie in piles: two to twelve in each
    /// scene. Those that are hardly seen have no mask. The depth map may show the table up to a centimetre too high or
    /// too low, or not at all.
    pub fn arranged(seed: u64, scenes: usize) -> Self {
        Self { seed, objects: (0..scenes).map(|scene| ARRANGED[scene % ARRANGED.len()]).collect(), is_arranged: true }
    }

    /// Number of scenes.
    pub fn scenes(&self) -> usize {
        self.objects.len()
    }

    /// Total number of pairs of an object and its generated mesh.
    pub fn pairs(&self) -> usize {
        self.objects.iter().sum()
    }

    /// Number of pairs of a scene; 0 if it does not exist.
    pub fn pairs_of(&self, scene: usize) -> usize {
        self.objects.get(scene).copied().unwrap_or_default()
    }

    /// The seed.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Scene `index`.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidArgument`] if the scene does not exist.
    pub fn scene(&self, index: usize) -> Result<ClutteredScene> {
        let Some(&objects) = self.objects.get(index) else {
            return Err(Error::new(
                ErrorCode::InvalidArgument,
                "index",
                index.to_string(),
                format!("a number below {}", self.objects.len()),
                "Make a set of more scenes.",
            ));
        };
        ClutteredScene::draw(self.seed, index, objects, self.is_arranged)
    }

    /// Writes every pair as `folder`/PRIOR/SCENE-OBJECT-FAMILY, on several threads; `progress` gets the number of
    /// completed scenes.
    ///
    /// Case folders are written atomically, and existing ones are kept, so that an interrupted run resumes.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidArgument`] for a folder that can't be written, or that holds another set.
    pub fn write(
        &self,
        folder: &Path,
        priors: &[Prior],
        threads: usize,
        progress: impl Fn(usize) + Sync,
    ) -> Result<()> {
        self.label(folder)?;
        let scenes: Vec<usize> = (0..self.scenes()).collect();
        parallel_map(threads, &scenes, |&scene| self.write_scene(scene, folder, priors), progress).map(drop)
    }

    fn write_scene(&self, index: usize, folder: &Path, priors: &[Prior]) -> Result<()> {
        let written = |prior: &Prior| {
            let entries = fs::read_dir(folder.join(prior.as_str())).into_iter().flatten().filter_map(|e| e.ok());
            entries.filter(|entry| entry.file_name().to_string_lossy().starts_with(&format!("{index:03}-"))).count()
        };
        // The names of the folders of a scene are only known after drawing it.
        if priors.iter().all(|prior| written(prior) == self.pairs_of(index)) {
            return Ok(());
        }
        for pair in self.scene(index)?.pairs {
            for prior in priors {
                let name = pair.name();
                let (parent, path) = (folder.join(prior.as_str()), folder.join(prior.as_str()).join(&name));
                if !path.exists() {
                    let unfinished = parent.join(format!(".{name}"));
                    write_files(&unfinished, &pair.files(*prior)?)?;
                    fs::rename(&unfinished, &path).map_err(|error| unwritable(&path, error))?;
                }
            }
        }
        Ok(())
    }

    /// Identifies the set in the folder, or checks that the folder belongs to this set.
    fn label(&self, folder: &Path) -> Result<()> {
        fs::create_dir_all(folder).map_err(|error| unwritable(folder, error))?;
        let path = folder.join(LABEL);
        let label = json!({ "setSeed": self.seed(), "scenes": self.scenes() });
        let found: Option<serde_json::Value> =
            fs::read(&path).ok().map(|bytes| serde_json::from_slice(&bytes).unwrap_or_default());
        match found {
            Some(found) if found == label => Ok(()),
            Some(found) => Err(Error::new(
                ErrorCode::InvalidArgument,
                path.display().to_string(),
                found.to_string(),
                label.to_string(),
                "Name another folder, or remove what is there.",
            )),
            None => fs::write(&path, format!("{label}\n")).map_err(|error| unwritable(&path, error)),
        }
    }
}

fn objects_of_block(seed: u64, block: usize) -> [usize; BLOCK] {
    let before = |block: usize, of_hundred: usize| (block * BLOCK * of_hundred + 50) / 100;
    let within = |of_hundred: usize| before(block + 1, of_hundred) - before(block, of_hundred);
    let (four, three_or_more) = (within(FOUR), within(THREE_OR_MORE));
    let mut objects = [2; BLOCK];
    objects.iter_mut().take(three_or_more).for_each(|n| *n = 3);
    objects.iter_mut().take(four).for_each(|n| *n = 4);
    // Fisher and Yates.
    let mut random = Random::new(mixed([seed, block as u64]), COUNT_STREAM);
    for last in (1..BLOCK).rev() {
        objects.swap(last, random.below(last + 1));
    }
    objects
}
