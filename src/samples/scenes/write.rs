//! A set of scenes as case folders.

use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use serde_json::json;

use super::prior::Prior;
use super::set::SceneSet;
use crate::error::{Error, ErrorCode, Result};
use crate::samples::case::unwritable;

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
        let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let work = || -> Result<()> {
            loop {
                let scene = next.fetch_add(1, Ordering::Relaxed);
                if scene >= self.scenes() {
                    return Ok(());
                }
                if let Err(error) = self.write_scene(scene, folder, priors) {
                    // The others need not go on.
                    next.store(self.scenes(), Ordering::Relaxed);
                    return Err(error);
                }
                progress(done.fetch_add(1, Ordering::Relaxed) + 1);
            }
        };
        std::thread::scope(|scope| {
            let threads: Vec<_> = (0..threads.clamp(1, self.scenes().max(1))).map(|_| scope.spawn(work)).collect();
            threads.into_iter().try_for_each(|thread| {
                let died = || Error::new(ErrorCode::Internal, "thread", "one that died", "none", "Please report it.");
                thread.join().unwrap_or_else(|_| Err(died()))
            })
        })
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
