//! Scene folders: the objects of a scene together.

use super::prior::Prior;
use super::scene::ClutteredScene;
use crate::files::write_files;
use crate::prelude::*;

/// The files that the objects of a scene share.
const SHARED: [&str; 2] = ["depth.png", "camera.json"];

impl ClutteredScene {
    /// Writes the scene as `depth.png`, `camera.json` and `objects/NAME/` with `mask.png`, `mesh.glb` and `gt.json`.
    ///
    /// # Errors
    /// Those of [`super::ScenePair::files`], and [`ErrorCode::InvalidArgument`] if a file cannot be written.
    pub fn write(&self, prior: Prior, folder: &Path) -> Result<()> {
        for pair in &self.pairs {
            let files = pair.files(prior)?.into_iter();
            let (shared, own): (Vec<_>, Vec<_>) = files.partition(|(name, _)| SHARED.contains(name));
            write_files(folder, &shared)?;
            write_files(&folder.join("objects").join(pair.name()), &own)?;
        }
        Ok(())
    }
}
