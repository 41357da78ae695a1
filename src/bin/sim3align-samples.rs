//! Writes generated cases with a known truth.

use std::path::PathBuf;
use std::process::ExitCode;

use lexopt::prelude::*;
use sim3align::error::Error;
use sim3align::samples::case::SampleCase;
use sim3align::samples::scenes::{DEPTH_SCALE, Prior, SCENES, SceneSet};
use sim3align::samples::shape::Kind;

const USAGE: &str = "\
Usage: sim3align-samples OUT_DIR [--kind KIND] [--seed N] [--depth FORMAT]
       sim3align-samples scenes OUT_DIR [--scenes N] [--set-seed S] [--prior P] [--threads N]

Writes a generated case folder: depth.npy, mask.png, camera.json, mesh.glb and, with the true pose, gt.json.

  --kind KIND     what to show: mug (default), hammer, spoon, or occluded, a teapot behind a mug
  --seed N        0 to 18446744073709551615, default 0; the same seed gives the same bytes
  --depth FORMAT  npy (default), or png: tenths of millimetres, a fifth of the bytes
  --help          this text

With `scenes`, writes cluttered scenes as case folders OUT_DIR/PRIOR/SCENE-OBJECT-FAMILY, with depth.png instead of
depth.npy and with meta.json. Folders that are there already are left alone: a run that was stopped goes on.
(For a single case in a folder of that name, write ./scenes.)

  --scenes N    how many, default 100, which are 338 pairs
  --set-seed S  default 0
  --prior P     what made the meshes: detailed, smooth or both (default)
  --threads N   default: all";

enum Command {
    Case { folder: PathBuf, kind: Kind, seed: u64, depth_scale: Option<f64> },
    Scenes { folder: PathBuf, set: SceneSet, priors: Vec<Prior>, threads: usize },
}

/// `None` where help is asked for; an error says what is wrong with the arguments.
fn parse(mut parser: lexopt::Parser) -> Result<Option<Command>, lexopt::Error> {
    let (mut folder, mut kind, mut seed, mut depth_scale) = (None, Kind::Mug, 0, None);
    let (mut is_scenes, mut scenes, mut set_seed, mut priors) = (false, SCENES, 0, Prior::ALL.to_vec());
    let mut threads = std::thread::available_parallelism().map_or(1, usize::from);
    let said = |error: Error| error.to_string();
    while let Some(argument) = parser.next()? {
        match argument {
            Long("help") | Short('h') => return Ok(None),
            Value(word) if !is_scenes && folder.is_none() && word == "scenes" => is_scenes = true,
            Value(path) if folder.is_none() => folder = Some(PathBuf::from(path)),
            Value(path) => return Err(format!("a second folder, {}", path.to_string_lossy()).into()),
            Long("kind") if !is_scenes => kind = Kind::from_name(&parser.value()?.string()?).map_err(said)?,
            Long("seed") if !is_scenes => seed = parser.value()?.parse()?,
            Long("depth") if !is_scenes => depth_scale = depth_format(&parser.value()?.string()?)?,
            Long("scenes") if is_scenes => scenes = parser.value()?.parse()?,
            Long("set-seed") if is_scenes => set_seed = parser.value()?.parse()?,
            Long("prior") if is_scenes => priors = Prior::several(&parser.value()?.string()?).map_err(said)?,
            Long("threads") if is_scenes => threads = parser.value()?.parse()?,
            _ => return Err(argument.unexpected()),
        }
    }
    let folder = folder.ok_or("no folder to write to")?;
    Ok(Some(match is_scenes {
        false => Command::Case { folder, kind, seed, depth_scale },
        true => Command::Scenes { folder, set: SceneSet::new(set_seed, scenes), priors, threads },
    }))
}

/// Metres per unit of a depth map in a format; `None` for floats.
fn depth_format(name: &str) -> Result<Option<f64>, lexopt::Error> {
    match name {
        "npy" => Ok(None),
        "png" => Ok(Some(DEPTH_SCALE)),
        _ => Err(format!("--depth {name}: npy or png is expected").into()),
    }
}

fn run(command: Command) -> Result<(), Error> {
    match command {
        Command::Case { folder, kind, seed, depth_scale } => SampleCase::new(kind, seed)?.write(&folder, depth_scale),
        Command::Scenes { folder, set, priors, threads } => {
            let all = set.scenes();
            set.write(&folder, &priors, threads, |done| {
                let end = if done == all { "\n" } else { "" };
                eprint!("\r{done} of {all} scenes {end}");
            })
        }
    }
}

fn main() -> ExitCode {
    let command = match parse(lexopt::Parser::from_env()) {
        Ok(Some(command)) => command,
        Ok(None) => {
            println!("{USAGE}");
            return ExitCode::SUCCESS;
        }
        Err(error) => {
            eprintln!("sim3align-samples: {error}\n\n{USAGE}");
            return ExitCode::from(2);
        }
    };
    match run(command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("sim3align-samples: {error}");
            ExitCode::FAILURE
        }
    }
}
