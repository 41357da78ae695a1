//! Makes the call of a file of choices.

use sim3align_lab::fuzz::target::{TARGETS, Target};

use super::super::Failure;
use super::arguments::Arguments;
use super::child;
use sim3align_lab::prelude::*;

/// Runs `--replay`.
pub fn run(path: &Path, arguments: &Arguments) -> Result<(), Failure> {
    let target = target_of(path)
        .ok_or_else(|| Failure::Failed(format!("{}: neither file nor folder names a target", path.display())))?;
    child::replay(target, path, &arguments.ceilings)
}

/// The target that the file's folder or the start of its name says; the longest such name.
fn target_of(path: &Path) -> Option<Target> {
    let name = path.file_name()?.to_str()?;
    let folder = path.parent().and_then(Path::file_name).and_then(|folder| folder.to_str());
    let fits = |target: &Target| folder == Some(target.name) || name.starts_with(&format!("{}-", target.name));
    TARGETS.into_iter().filter(fits).max_by_key(|target| target.name.len())
}
