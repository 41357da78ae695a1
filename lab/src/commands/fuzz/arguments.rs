//! The arguments of `fuzz`.

use std::ops::Range;

use lexopt::prelude::*;
use sim3align_lab::fuzz::target::{Ceilings, TARGETS, Target};
use sim3align_lab::prelude::*;

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

pub struct Arguments {
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

/// `None` if help is requested.
pub fn parse(mut parser: lexopt::Parser) -> Result<Option<Arguments>, lexopt::Error> {
    let mut arguments = Arguments {
        mode: Mode::Search,
        minutes: 10.0,
        executions: None,
        seed: 0,
        targets: TARGETS.to_vec(),
        jobs: std::thread::available_parallelism().map_or(1, |count| count.get()),
        ceilings: Ceilings::default(),
        out: PathBuf::from("lab/findings"),
        trace: false,
    };
    let mut range = None;
    while let Some(argument) = parser.next()? {
        match argument {
            Long("help") | Short('h') => return Ok(None),
            Long("minutes") => arguments.minutes = parser.value()?.parse()?,
            Long("executions") => arguments.executions = Some(parser.value()?.parse()?),
            Long("seed") => arguments.seed = parser.value()?.parse()?,
            Long("jobs") => arguments.jobs = parser.value()?.parse::<usize>()?.max(1),
            Long("seconds") => arguments.ceilings.seconds = parser.value()?.parse()?,
            Long("megabytes") => arguments.ceilings.bytes = parser.value()?.parse::<usize>()? << 20,
            Long("out") => arguments.out = parser.value()?.into(),
            Long("replay") => arguments.mode = Mode::Replay(parser.value()?.into()),
            Long("trace") => arguments.trace = true,
            Long("range") => range = Some(to_range(&parser.value()?.string()?)?),
            Long("target") => {
                let names = parser.value()?.string()?;
                let found = names.split(',').map(|name| Target::of_name(name).ok_or(format!("--target {name}")));
                arguments.targets = found.collect::<Result<_, _>>()?;
            }
            _ => return Err(argument.unexpected()),
        }
    }
    if let Some(range) = range {
        let [target] = arguments.targets[..] else { return Err("--range needs one --target".into()) };
        arguments.mode = Mode::Range(target, range);
    }
    Ok(Some(arguments))
}

fn to_range(text: &str) -> Result<Range<u64>, lexopt::Error> {
    let ends = text.split_once("..").and_then(|(low, high)| Some(low.parse().ok()?..high.parse().ok()?));
    ends.ok_or_else(|| format!("--range {text}: A..B is expected").into())
}
