//! `case`: writes a generated case folder with the true pose.

use lexopt::prelude::*;
use sim3align_lab::samples::case::SampleCase;
use sim3align_lab::samples::shape::Kind;
use sim3align_lab::samples::table::TableScene;
use sim3align_lab::scenes::DEPTH_SCALE;

use super::{Failure, parsed};
use sim3align_lab::prelude::*;

const USAGE: &str = "\
Usage: sim3align-lab case OUT_DIR [--kind KIND] [--seed N] [--depth FORMAT]

Writes a generated case folder: depth.npy, mask.png, camera.json, mesh.glb and, with the true pose, gt.json.

  --kind KIND     what to show: mug (default), hammer, spoon, or occluded, a teapot behind a mug; or table, a scene of
                  three coloured objects with a photo: depth.png, camera.json, rgb.png and objects/NAME/
  --seed N        0 to 18446744073709551615, default 0; the same seed gives the same bytes
  --depth FORMAT  npy (default), or png: tenths of millimetres, a fifth of the bytes
  --help          this text";

/// The kind of the scene.
const TABLE: &str = "table";

struct Arguments {
    folder: PathBuf,
    /// `None` is the table.
    kind: Option<Kind>,
    seed: u64,
    depth_scale: Option<f64>,
}

/// `None` if help is requested.
fn parse(mut parser: lexopt::Parser) -> Result<Option<Arguments>, lexopt::Error> {
    let (mut folder, mut kind, mut seed, mut depth_scale) = (None, Some(Kind::Mug), 0, None);
    let message = |error: Error| error.to_string();
    while let Some(argument) = parser.next()? {
        match argument {
            Long("help") | Short('h') => return Ok(None),
            Value(path) if folder.is_none() => folder = Some(PathBuf::from(path)),
            Value(path) => return Err(format!("a second folder, {}", path.to_string_lossy()).into()),
            Long("kind") => {
                let name = parser.value()?.string()?;
                kind = if name == TABLE { None } else { Some(Kind::from_name(&name).map_err(message)?) };
            }
            Long("seed") => seed = parser.value()?.parse()?,
            Long("depth") => depth_scale = depth_format(&parser.value()?.string()?)?,
            _ => return Err(argument.unexpected()),
        }
    }
    let folder = folder.ok_or("no folder to write to")?;
    Ok(Some(Arguments { folder, kind, seed, depth_scale }))
}

/// Metres per unit of a depth format; `None` for floats.
fn depth_format(name: &str) -> Result<Option<f64>, lexopt::Error> {
    match name {
        "npy" => Ok(None),
        "png" => Ok(Some(DEPTH_SCALE)),
        _ => Err(format!("--depth {name}: npy or png is expected").into()),
    }
}

/// Runs the command.
pub fn main(arguments: lexopt::Parser) -> Result<(), Failure> {
    let Arguments { folder, kind, seed, depth_scale } = parsed(arguments, parse, USAGE)?;
    match kind {
        Some(kind) => SampleCase::new(kind, seed).and_then(|case| case.write(&folder, depth_scale)),
        None => TableScene::new(seed).and_then(|scene| scene.write(&folder)),
    }
    .map_err(|error| Failure::Failed(error.to_string()))
}
