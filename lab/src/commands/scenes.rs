//! `scenes`: writes cluttered scenes as case folders.

use lexopt::prelude::*;
use sim3align_lab::scenes::{Prior, SCENES, SceneSet, write_bop};

use super::{Failure, parsed};
use sim3align_lab::prelude::*;

const USAGE: &str = "\
Usage: sim3align-lab scenes OUT_DIR [--scenes N] [--set-seed S] [--prior P] [--bop] [--threads N]

Writes cluttered scenes as case folders OUT_DIR/PRIOR/SCENE-OBJECT-FAMILY: depth.png, mask.png, camera.json, mesh.glb,
gt.json and meta.json. Folders that exist are left alone: a run that was stopped goes on.

  --scenes N    how many, default 100, which are 338 pairs
  --set-seed S  default 0
  --prior P     what made the meshes: detailed, smooth or both (default)
  --bop         write one dataset in the layout of BOP instead, OUT_DIR/models and OUT_DIR/test: a scene is an image, and
                each object its own model, without the errors of a prior
  --threads N   default: all
  --help        this text";

struct Arguments {
    folder: PathBuf,
    set: SceneSet,
    priors: Vec<Prior>,
    is_bop: bool,
    threads: usize,
}

/// `None` if help is requested.
fn parse(mut parser: lexopt::Parser) -> Result<Option<Arguments>, lexopt::Error> {
    let (mut folder, mut scenes, mut set_seed, mut priors) = (None, SCENES, 0, Prior::ALL.to_vec());
    let mut is_bop = false;
    let mut threads = std::thread::available_parallelism().map_or(1, usize::from);
    while let Some(argument) = parser.next()? {
        match argument {
            Long("help") | Short('h') => return Ok(None),
            Value(path) if folder.is_none() => folder = Some(PathBuf::from(path)),
            Value(path) => return Err(format!("a second folder, {}", path.to_string_lossy()).into()),
            Long("scenes") => scenes = parser.value()?.parse()?,
            Long("set-seed") => set_seed = parser.value()?.parse()?,
            Long("prior") => {
                priors = Prior::several(&parser.value()?.string()?).map_err(|error: Error| error.to_string())?;
            }
            Long("bop") => is_bop = true,
            Long("threads") => threads = parser.value()?.parse()?,
            _ => return Err(argument.unexpected()),
        }
    }
    let folder = folder.ok_or("no folder to write to")?;
    Ok(Some(Arguments { folder, set: SceneSet::new(set_seed, scenes), priors, is_bop, threads }))
}

/// Runs the command.
pub fn main(arguments: lexopt::Parser) -> Result<(), Failure> {
    let Arguments { folder, set, priors, is_bop, threads } = parsed(arguments, parse, USAGE)?;
    let all = set.scenes();
    let progress = |done| {
        let end = if done == all { "\n" } else { "" };
        eprint!("\r{done} of {all} scenes {end}");
    };
    let written = if is_bop {
        write_bop(&set, &folder, threads, progress)
    } else {
        set.write(&folder, &priors, threads, progress)
    };
    written.map_err(|error| Failure::Failed(error.to_string()))
}
