//! Command line of `registration`.

use lexopt::prelude::*;

use super::method::Method;
use sim3align_lab::prelude::*;

pub const USAGE: &str = "\
Usage: sim3align-lab registration write rooms|lidar|objects OUT [--seed S] [--scenes N]
       sim3align-lab registration run --data PATH [options]

write: pairs of decreasing overlap with a known transform: rooms in 3DMatch's layout, streets in KITTI's,
       objects and cluttered scenes that contain them in 3DMatch's, in decimetres
  --seed S           default 0
  --scenes N         rooms, drives or cluttered scenes, default 4

run: registers pairs and prints a Markdown table of recall and errors
  --data PATH        3DMatch: <scene>/cloud_bin_<i>.ply with <scene>-evaluation/gt.log, <scene>/gt.log or
                     benchmarks/<name>/<scene>/gt.log; KITTI: sequences/<SS>/velodyne, calib.txt and poses/<SS>.txt
  --protocol P       3dmatch, kitti or auto (default)
  --benchmark NAME   which of benchmarks/<name>: 3DMatch or 3DLoMatch; needed where there are several
  --method M         register (default), fgr, gicp, icp-point-to-plane, icp-point-to-point, ransac, teaser, quatro, or
                     NAME=import:DIR: DIR/<id>.json from another program; may be repeated
  --option K=V       an option of register() by its JavaScript name; may be repeated
  --only TEXT        only pairs whose id contains this
  --every N          of these, the first and every N-th after it; default 1
  --measure-overlap  measures the overlap where it is not listed, for the table's bins
  --moved SEED       moves each source by a random rigid transform first, each target by another, so that no method
                     can use where the sensor stood; 0 (default) moves nothing
  --scaled SEED      scales each source by a random factor from 0.1 to 10 first; needs --option scale=free for register.
                     0 (default) scales nothing
  --records FILE     one JSON line for each pair and method; those that are there are not run again
  --json FILE        everything about every pair
  --pairs-json FILE  writes [{ id, source, target, voxelSizeM }] for other programs, and runs nothing
  --threads N        default: all
  --help             this text";

pub enum Command {
    Write { kind: Kind, out: PathBuf, seed: u64, scenes: u32 },
    Run(Box<Run>),
}

#[derive(Clone, Copy)]
pub enum Kind {
    Rooms,
    Lidar,
    Objects,
}

#[derive(Clone, Copy)]
pub enum Protocol {
    Auto,
    ThreeDMatch,
    Kitti,
}

pub struct Run {
    pub data: PathBuf,
    pub protocol: Protocol,
    pub benchmark: Option<String>,
    pub methods: Vec<Method>,
    pub only: Option<String>,
    pub every: usize,
    pub measure_overlap: bool,
    pub moved: u64,
    pub scaled: u64,
    pub records: Option<PathBuf>,
    pub json: Option<PathBuf>,
    pub pairs_json: Option<PathBuf>,
    pub threads: usize,
}

impl Command {
    /// `None` if help is requested.
    pub fn parse(mut parser: lexopt::Parser) -> Result<Option<Self>, lexopt::Error> {
        match parser.next()? {
            Some(Value(word)) if word == "write" => write(parser),
            Some(Value(word)) if word == "run" => run(parser),
            Some(Long("help") | Short('h')) | None => Ok(None),
            Some(other) => Err(other.unexpected()),
        }
    }
}

fn write(mut parser: lexopt::Parser) -> Result<Option<Command>, lexopt::Error> {
    let (mut seed, mut scenes, mut words) = (0, 4, Vec::new());
    while let Some(argument) = parser.next()? {
        match argument {
            Long("seed") => seed = parser.value()?.parse()?,
            Long("scenes") => scenes = parser.value()?.parse()?,
            Long("help") | Short('h') => return Ok(None),
            Value(word) if words.len() < 2 => words.push(word),
            other => return Err(other.unexpected()),
        }
    }
    let [kind, out] = words.as_slice() else { return Err("write needs rooms, lidar or objects, and a folder".into()) };
    let kind = match kind.to_str() {
        Some("rooms") => Kind::Rooms,
        Some("lidar") => Kind::Lidar,
        Some("objects") => Kind::Objects,
        _ => return Err("write knows rooms, lidar and objects".into()),
    };
    Ok(Some(Command::Write { kind, out: out.into(), seed, scenes }))
}

fn run(mut parser: lexopt::Parser) -> Result<Option<Command>, lexopt::Error> {
    let (mut data, mut methods, mut options) = (None, Vec::new(), Vec::new());
    let mut run = Run {
        data: PathBuf::new(),
        protocol: Protocol::Auto,
        benchmark: None,
        methods: Vec::new(),
        only: None,
        every: 1,
        measure_overlap: false,
        moved: 0,
        scaled: 0,
        records: None,
        json: None,
        pairs_json: None,
        threads: std::thread::available_parallelism().map_or(1, usize::from),
    };
    while let Some(argument) = parser.next()? {
        match argument {
            Long("data") => data = Some(parser.value()?.into()),
            Long("protocol") => {
                run.protocol = match parser.value()?.string()?.as_str() {
                    "auto" => Protocol::Auto,
                    "3dmatch" => Protocol::ThreeDMatch,
                    "kitti" => Protocol::Kitti,
                    _ => return Err("--protocol is 3dmatch, kitti or auto".into()),
                }
            }
            Long("benchmark") => run.benchmark = Some(parser.value()?.string()?),
            Long("method") => methods.push(parser.value()?.string()?),
            Long("option") => options.push(parser.value()?.string()?),
            Long("only") => run.only = Some(parser.value()?.string()?),
            Long("every") => run.every = parser.value()?.parse::<usize>()?.max(1),
            Long("measure-overlap") => run.measure_overlap = true,
            Long("moved") => run.moved = parser.value()?.parse()?,
            Long("scaled") => run.scaled = parser.value()?.parse()?,
            Long("records") => run.records = Some(parser.value()?.into()),
            Long("json") => run.json = Some(parser.value()?.into()),
            Long("pairs-json") => run.pairs_json = Some(parser.value()?.into()),
            Long("threads") => run.threads = parser.value()?.parse::<usize>()?.max(1),
            Long("help") | Short('h') => return Ok(None),
            other => return Err(other.unexpected()),
        }
    }
    run.data = data.ok_or("run needs --data")?;
    if methods.is_empty() {
        methods.push("register".into());
    }
    run.methods = methods.iter().map(|name| Method::from_name(name, &options)).collect::<Result<_, _>>()?;
    Ok(Some(Command::Run(Box::new(run))))
}
