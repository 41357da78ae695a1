//! `profile`: aligns case folders with the native build, which `npm run profile` compares with WebAssembly.

use serde_json::{Map, Value as Json};
use sim3align::align::align_prepared;
use sim3align::align::search::Request;
use sim3align_lab::bench::benchmark::Clock;
use sim3align_lab::bench::option_text;
use sim3align_lab::case_folder::case::read_case;
use sim3align_lab::prelude::*;

use super::{Arguments, Command, Failure, usage};

pub const COMMAND: Command = Command {
    name: "profile",
    about: "aligns case folders natively, and prints times as JSON",
    usage: "\
Usage: sim3align-lab profile [--quality QUALITY] RUNS CASE...

Aligns each case folder RUNS times and prints JSON: { \"<folder>\": [result, …] }. QUALITY is one of `align`;
it and all other options have its defaults.",
    run,
};

fn results(folder: &str, runs: usize, options: &AlignOptions) -> Result<Vec<Json>, Error> {
    let case = read_case(folder.as_ref())?;
    (0..runs)
        .map(|_| {
            let mesh = PreparedMesh::borrowed(&case.mesh).with_colors(case.colors.clone());
            let request = Request::new(options.clone())?;
            let alignment = align_prepared(&case.observation, &mesh, request, &mut Clock::default())?;
            Ok(serde_json::to_value(alignment).unwrap_or_default())
        })
        .collect()
}

fn run(arguments: &mut Arguments) -> Result<(), Failure> {
    let options = option_text::with_quality(arguments.optional("quality")?).map_err(usage)?;
    let words = arguments.rest()?;
    let (runs, folders) = words.split_first().ok_or_else(|| usage("no number of runs"))?;
    let runs = runs.parse().map_err(|error| usage(format!("{runs:?}: {error}")))?;
    let mut all = Map::new();
    for folder in folders {
        let values = results(folder, runs, &options)
            .map_err(|error| Failure::Failed(format!("{folder}: {} {error}", error.code.as_str())))?;
        all.insert(folder.clone(), values.into());
    }
    println!("{}", Json::Object(all));
    Ok(())
}
