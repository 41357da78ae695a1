//! A set of scenes as case folders.

use std::fs;
use std::path::Path;

use serde_json::json;

use super::prior::Prior;
use super::set::SceneSet;
use crate::samples::case::unwritable;
use crate::samples::in_order::in_order;
use sim3align_geometry::error::{Error, ErrorCode, Result};

/// What says of a folder which set is in it.
const LABEL: &str = "set.json";

impl SceneSet {
    /// Writes every pair as `folder`/PRIOR/SCENE-OBJECT-FAMILY, on several threads; `progress` is told after each scene
    /// how many are done.
    ///
    /// A case folder appears whole, under its name, or not at all, and those that are there are left alone: a run that
    /// was stopped goes on where it was.
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
        in_order(threads, &scenes, |&scene| self.write_scene(scene, folder, priors), progress).map(drop)
    }

    fn write_scene(&self, index: usize, folder: &Path, priors: &[Prior]) -> Result<()> {
        let written = |prior: &Prior| {
            let entries = fs::read_dir(folder.join(prior.as_str())).into_iter().flatten().filter_map(|e| e.ok());
            entries.filter(|entry| entry.file_name().to_string_lossy().starts_with(&format!("{index:03}-"))).count()
        };
        // Which names a scene's folders have is known once it has been drawn.
        if priors.iter().all(|prior| written(prior) == self.pairs_of(index)) {
            return Ok(());
        }
        for pair in self.scene(index)?.pairs {
            for prior in priors {
                let name = pair.name();
                let (parent, path) = (folder.join(prior.as_str()), folder.join(prior.as_str()).join(&name));
                if !path.exists() {
                    let unfinished = parent.join(format!(".{name}"));
                    pair.case(*prior)?.write(&unfinished)?;
                    fs::rename(&unfinished, &path).map_err(|error| unwritable(&path, error))?;
                }
            }
        }
        Ok(())
    }

    /// Says in the folder which set is in it, unless it says so already.
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
