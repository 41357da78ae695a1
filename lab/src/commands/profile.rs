//! `profile`: aligns case folders with the native build, which `npm run profile` compares with WebAssembly.

use serde_json::{Map, Value as Json, json};
use sim3align::align::align_prepared;
use sim3align::align::search::Request;
use sim3align::counts::{self, Counts};
use sim3align::progress::{Host, Stage};
use sim3align_lab::bench::options::Row;
use sim3align_lab::case_folder::read::read;
use sim3align_lab::cost::Meter;
use sim3align_lab::prelude::*;

use super::{Failure, usage};

/// Aligns each case folder, and prints JSON: { "<folder>": [result, …] }. Times are those of the CPU. `work` of a result
/// has its counts by stage.
#[derive(clap::Args)]
pub struct Arguments {
    /// A quality of `align`; all other options have their defaults
    #[arg(long, default_value = "auto")]
    quality: String,
    /// How many times each case is aligned
    runs: usize,
    /// Case folders
    #[arg(required = true)]
    cases: Vec<String>,
}

/// A host whose clock is the CPU time, and that counts the work of each stage.
struct Profiler {
    meter: Meter,
    running: Option<Stage>,
    before: Counts,
    work: Vec<(Stage, Counts)>,
}

impl Profiler {
    fn start() -> Self {
        Self { meter: Meter::start(), running: None, before: counts::so_far(), work: Vec::new() }
    }

    /// The counts by stage, as JSON.
    fn work(&self) -> Json {
        self.work.iter().map(|(stage, counts)| (stage.as_str().to_owned(), json!(counts))).collect::<Map<_, _>>().into()
    }
}

impl Host for Profiler {
    fn now_ms(&mut self) -> f64 {
        self.meter.milliseconds()
    }

    fn progress(&mut self, stage: Stage, _fraction: f64) {
        let now = counts::so_far();
        let since = now.since(&core::mem::replace(&mut self.before, now));
        let ended = self.running.replace(stage).unwrap_or(stage);
        match self.work.iter_mut().find(|(known, _)| *known == ended) {
            Some((_, sum)) => *sum = sum.and(&since),
            None => self.work.push((ended, since)),
        }
    }
}

fn results(folder: &str, runs: usize, options: &AlignOptions) -> Result<Vec<Json>> {
    let case = read(folder.as_ref())?;
    let (observation, mesh) = (case.frames[0].observation(0, true)?, &case.objects[0]);
    (0..runs)
        .map(|_| {
            let request = Request::new(options.clone())?;
            let mut profiler = Profiler::start();
            let alignment = align_prepared(&observation, &mesh.prepared(true), request, &mut profiler)?;
            let mut result = serde_json::to_value(alignment).unwrap_or_default();
            result["work"] = profiler.work();
            Ok(result)
        })
        .collect()
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let row = Row::parse(&format!("profile: quality={}", arguments.quality)).map_err(usage)?;
    let mut all = Map::new();
    for folder in &arguments.cases {
        let values = results(folder, arguments.runs, &row.precise)
            .map_err(|error| Failure::Failed(format!("{folder}: {} {error}", error.code.as_str())))?;
        all.insert(folder.clone(), values.into());
    }
    println!("{}", Json::Object(all));
    Ok(())
}
