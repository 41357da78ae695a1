//! `scenes`: writes cluttered scenes as case folders.

use sim3align_lab::prelude::*;
use sim3align_lab::scenes::{Prior, SCENES, SceneSet, write_bop};

use super::{Arguments, Command, Failure, print_progress, usage};

pub const COMMAND: Command = Command {
    name: "scenes",
    about: "writes cluttered scenes as case folders",
    usage: "\
Usage: sim3align-lab scenes OUT_DIR [--scenes N] [--set-seed S] [--prior P] [--bop] [--threads N]

Writes cluttered scenes as case folders OUT_DIR/PRIOR/SCENE-OBJECT-FAMILY: depth.png, mask.png, camera.json, mesh.glb,
gt.json and meta.json. Folders that exist are left alone: a run that was stopped goes on.

  --scenes N    how many, default 100, which are 338 pairs
  --set-seed S  default 0
  --prior P     what made the meshes: detailed, smooth or both (default)
  --bop         write one dataset in the layout of BOP instead, OUT_DIR/models and OUT_DIR/test: a scene is an image, and
                each object its own model, without the errors of a prior
  --threads N   default: all
  --help        this text",
    run,
};

fn run(arguments: &mut Arguments) -> Result<(), Failure> {
    let (scenes, set_seed) = (arguments.value("scenes", SCENES)?, arguments.value("set-seed", 0)?);
    let priors = Prior::several(&arguments.value("prior", "both".to_owned())?).map_err(usage)?;
    let (is_bop, threads) = (arguments.flag("bop"), arguments.threads("threads")?);
    let (folder, set) = (arguments.folder()?, SceneSet::new(set_seed, scenes));
    let progress = |done| print_progress(done, scenes);
    Ok(if is_bop {
        write_bop(&set, &folder, threads, progress)
    } else {
        set.write(&folder, &priors, threads, progress)
    }?)
}
