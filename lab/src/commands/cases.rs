//! `case`: writes a generated case folder with the true pose.

use sim3align_lab::prelude::*;
use sim3align_lab::samples::case::SampleCase;
use sim3align_lab::samples::shape::Kind;
use sim3align_lab::samples::table::TableScene;
use sim3align_lab::scenes::DEPTH_SCALE;

use super::{Arguments, Command, Failure, usage};

pub const COMMAND: Command = Command {
    name: "case",
    about: "writes one generated case folder",
    usage: "\
Usage: sim3align-lab case OUT_DIR [--kind KIND] [--seed N] [--depth FORMAT]

Writes a generated case folder: depth.npy, mask.png, camera.json, mesh.glb and, with the true pose, gt.json.

  --kind KIND     what to show: mug (default), hammer, spoon, or occluded, a teapot behind a mug; or table, a scene of
                  three coloured objects with a photo: depth.png, camera.json, rgb.png and objects/NAME/
  --seed N        0 to 18446744073709551615, default 0; the same seed gives the same bytes
  --depth FORMAT  npy (default), or png: tenths of millimetres, a fifth of the bytes
  --help          this text",
    run,
};

/// The kind of the scene.
const TABLE: &str = "table";

fn run(arguments: &mut Arguments) -> Result<(), Failure> {
    let kind = arguments.value("kind", Kind::Mug.as_str().to_owned())?;
    let seed = arguments.value("seed", 0)?;
    let depth_scale = match arguments.value("depth", "npy".to_owned())?.as_str() {
        "npy" => None,
        "png" => Some(DEPTH_SCALE),
        other => return Err(usage(format!("--depth {other}: npy or png is expected"))),
    };
    let folder = arguments.folder()?;
    if kind == TABLE {
        return Ok(TableScene::new(seed)?.write(&folder)?);
    }
    let kind = Kind::from_name(&kind).map_err(usage)?;
    Ok(SampleCase::new(kind, seed)?.write(&folder, depth_scale)?)
}
