//! Command line of `registration run`.

use sim3align_lab::prelude::*;

use super::super::{Arguments, Failure, usage};
use super::method::Method;

pub const USAGE: &str = "\
Usage: sim3align-lab registration write rooms|lidar OUT [--seed S] [--scenes N]
       sim3align-lab registration run --data PATH [options]

write: pairs of decreasing overlap with a known transform: rooms in 3DMatch's layout, streets in KITTI's
  --seed S           default 0
  --scenes N         rooms or drives, default 4

run: registers pairs and prints a Markdown table of recall and errors
  --data PATH        3DMatch: <scene>/cloud_bin_<i>.ply with <scene>-evaluation/gt.log, <scene>/gt.log or
                     benchmarks/<name>/<scene>/gt.log; KITTI: sequences/<SS>/velodyne, calib.txt and poses/<SS>.txt
  --protocol P       3dmatch, kitti or auto (default)
  --benchmark NAME   which of benchmarks/<name>: 3DMatch or 3DLoMatch; needed where there are several
  --method M         register (default), or NAME=import:DIR: DIR/<id>.json from another program; may be repeated
  --option K=V       an option of register() by its JavaScript name; may be repeated
  --every N          the first and every N-th after it; default 1
  --measure-overlap  measures the overlap where it is not listed, for the table's bins
  --records FILE     one JSON line for each pair and method; those that are there are not run again
  --json FILE        everything about every pair
  --pairs-json FILE  writes [{ id, source, target, voxelSizeM }] for other programs, and runs nothing
  --threads N        default: all
  --help             this text";

pub struct Settings {
    pub data: PathBuf,
    /// Whether the data is KITTI's, and not 3DMatch's; `None` asks the data.
    pub is_kitti: Option<bool>,
    pub benchmark: Option<String>,
    pub methods: Vec<Method>,
    pub every: usize,
    pub measure_overlap: bool,
    pub records: Option<PathBuf>,
    pub json: Option<PathBuf>,
    pub pairs_json: Option<PathBuf>,
    pub threads: usize,
}

impl Settings {
    pub fn parse(arguments: &mut Arguments) -> Result<Self, Failure> {
        let (mut methods, options) = (arguments.all("method")?, arguments.all("option")?);
        if methods.is_empty() {
            methods.push("register".into());
        }
        let settings = Self {
            data: arguments.optional("data")?.ok_or_else(|| usage("run needs --data"))?,
            is_kitti: match arguments.value("protocol", "auto".to_owned())?.as_str() {
                "auto" => None,
                "3dmatch" => Some(false),
                "kitti" => Some(true),
                _ => return Err(usage("--protocol is 3dmatch, kitti or auto")),
            },
            benchmark: arguments.optional("benchmark")?,
            methods: methods
                .iter()
                .map(|name| Method::from_name(name, &options))
                .collect::<Result<_, _>>()
                .map_err(usage)?,
            every: arguments.value("every", 1)?.max(1),
            measure_overlap: arguments.flag("measure-overlap"),
            records: arguments.optional("records")?,
            json: arguments.optional("json")?,
            pairs_json: arguments.optional("pairs-json")?,
            threads: arguments.threads("threads")?,
        };
        arguments.end()?;
        Ok(settings)
    }
}
