//! Aligns case folders with the natively compiled core: what `npm run profile` compares WebAssembly with.

use std::process::ExitCode;
use std::time::Instant;

use serde_json::{Map, Value};
use sim3align::align::align;
use sim3align::align::options::AlignOptions;
use sim3align::align::progress::{Host, Stage};
use sim3align::error::Result;
use sim3align::formats::case::read_case;

const USAGE: &str = "\
Usage: sim3align-native RUNS CASE...

Aligns each case folder RUNS times with default options and prints JSON: { \"<folder>\": [result, …] }.";

struct Clock(Instant);

impl Host for Clock {
    fn now_ms(&mut self) -> f64 {
        self.0.elapsed().as_secs_f64() * 1000.0
    }

    fn progress(&mut self, _stage: Stage, _fraction: f64) {}
}

fn results(folder: &str, runs: usize) -> Result<Vec<Value>> {
    let case = read_case(folder.as_ref())?;
    (0..runs)
        .map(|_| {
            let mut clock = Clock(Instant::now());
            let alignment = align(&case.observation, &case.mesh, &AlignOptions::default(), &mut clock)?;
            Ok(serde_json::to_value(alignment).unwrap_or_default())
        })
        .collect()
}

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let Some(runs) = arguments.next().and_then(|runs| runs.parse().ok()) else {
        eprintln!("{USAGE}");
        return ExitCode::from(2);
    };
    let mut all = Map::new();
    for folder in arguments {
        match results(&folder, runs) {
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
