//! Aligns case folders with the natively compiled core: what `npm run profile` compares WebAssembly with.

use std::process::ExitCode;
use std::time::Instant;

use serde_json::{Map, Value};
use sim3align::align::align;
use sim3align::align::options::{AlignOptions, Quality};
use sim3align::align::progress::{Host, Stage};
use sim3align::error::Result;
use sim3align::formats::case::read_case;

const USAGE: &str = "\
Usage: sim3align-native [--quality QUALITY] RUNS CASE...

Aligns each case folder RUNS times and prints JSON: { \"<folder>\": [result, …] }. QUALITY is fast, balanced (default) or
best; all other options are the defaults.";

struct Clock(Instant);

impl Host for Clock {
    fn now_ms(&mut self) -> f64 {
        self.0.elapsed().as_secs_f64() * 1000.0
    }

    fn progress(&mut self, _stage: Stage, _fraction: f64) {}
}

fn results(folder: &str, runs: usize, options: &AlignOptions) -> Result<Vec<Value>> {
    let case = read_case(folder.as_ref())?;
    (0..runs)
        .map(|_| {
            let mut clock = Clock(Instant::now());
            let alignment = align(&case.observation, &case.mesh, options, &mut clock)?;
            Ok(serde_json::to_value(alignment).unwrap_or_default())
        })
        .collect()
}

/// Options, runs and folders; `None` where the arguments are not as [`USAGE`] has them.
fn parse(arguments: impl Iterator<Item = String>) -> Option<(AlignOptions, usize, Vec<String>)> {
    let mut arguments = arguments.peekable();
    let mut options = AlignOptions::default();
    if arguments.next_if_eq("--quality").is_some() {
        options.quality = match arguments.next()?.as_str() {
            "fast" => Quality::Fast,
            "balanced" => Quality::Balanced,
            "best" => Quality::Best,
            _ => return None,
        };
    }
    let runs = arguments.next()?.parse().ok()?;
    Some((options, runs, arguments.collect()))
}

fn main() -> ExitCode {
    let Some((options, runs, folders)) = parse(std::env::args().skip(1)) else {
        eprintln!("{USAGE}");
        return ExitCode::from(2);
    };
    let mut all = Map::new();
    for folder in folders {
        match results(&folder, runs, &options) {
            Ok(values) => all.insert(folder, values.into()),
            Err(error) => {
                eprintln!("{folder}: {} {error}", error.code.as_str());
                return ExitCode::FAILURE;
            }
        };
    }
    println!("{}", Value::Object(all));
    ExitCode::SUCCESS
}
