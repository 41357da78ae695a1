//! Command line of `fuzz`.

use std::ops::Range;

use sim3align_lab::fuzz::target::{Ceilings, TARGETS, Target};
use sim3align_lab::prelude::*;

use super::super::{Arguments, Failure, usage};

pub const USAGE: &str = "\
Usage: sim3align-lab fuzz [options]
       sim3align-lab fuzz --replay FILE

Calls readers, align, alignViews, trackers, evaluate, register and estimateSim3 with inputs drawn from a seed, in
processes of their own. A fault is a panic, an abort, an error without code or words, a result that is not finite, or a
call with default options beyond a ceiling. The choices that lead to it are made as few as possible, and kept in a file.

  --minutes N        how long, default 10
  --executions N     instead of a time: so many calls of each target, readers 1000 times as many
  --seed N           0 to 4294967295, default 0
  --target T,…       only these: readers, align, align-large, views, track, evaluate,
                     register, estimate-sim3
  --jobs N           processes at a time, default: all processors
  --seconds S        ceiling of a call's computing time, default 6
  --megabytes M      ceiling of a call's memory, default 512
  --out DIR          folder for the choices of faults, default lab/findings
  --replay FILE      makes the call of such a file, TARGET-*.txt or TARGET/*.txt, and prints what happens
  --range A..B       makes calls A to B of one target in this process; what the command does in each of its processes
  --trace            with --range, prints the number of each call before it is made
  --help             this text";

/// The mode of the command.
pub enum Mode {
    /// Searches until the time is over.
    Search,
    /// Makes a range of calls in this process.
    Range(Target, Range<u64>),
    /// Makes the call of a file.
    Replay(PathBuf),
}

pub struct Settings {
    pub mode: Mode,
    pub minutes: f64,
    pub executions: Option<u64>,
    pub seed: u32,
    pub targets: Vec<Target>,
    pub jobs: usize,
    pub ceilings: Ceilings,
    pub out: PathBuf,
    /// Whether a range of calls prints each number.
    pub trace: bool,
}

impl Settings {
    pub fn parse(arguments: &mut Arguments) -> Result<Self, Failure> {
        let usual = Ceilings::default();
        let mut settings = Self {
            mode: arguments.optional("replay")?.map_or(Mode::Search, Mode::Replay),
            minutes: arguments.value("minutes", 10.0)?,
            executions: arguments.optional("executions")?,
            seed: arguments.value("seed", 0)?,
            targets: arguments.list("target")?.unwrap_or_else(|| TARGETS.to_vec()),
            jobs: arguments.threads("jobs")?,
            ceilings: Ceilings {
                seconds: arguments.value("seconds", usual.seconds)?,
                bytes: arguments.value("megabytes", usual.bytes >> 20)? << 20,
            },
            out: arguments.value("out", "lab/findings".into())?,
            trace: arguments.flag("trace"),
        };
        if let Some(range) = arguments.optional::<String>("range")? {
            let [target] = settings.targets[..] else { return Err(usage("--range needs one --target")) };
            let ends = range.split_once("..").and_then(|(low, high)| Some(low.parse().ok()?..high.parse().ok()?));
            let ends = ends.ok_or_else(|| usage(format!("--range {range}: A..B is expected")))?;
            settings.mode = Mode::Range(target, ends);
        }
        arguments.end()?;
        Ok(settings)
    }
}
