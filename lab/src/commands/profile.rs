//! `profile`: aligns case folders with the native build, which `npm run profile` compares with WebAssembly.

use std::time::Instant;

use lexopt::prelude::*;
use serde_json::{Map, Value as Json};
use sim3align::align::align_prepared;
use sim3align::align::search::Request;
use sim3align::precise::drawn::prepared_mesh::PreparedMesh;
use sim3align::precise::options::AlignOptions;
use sim3align::progress::{Host, Stage};
use sim3align_geometry::error::Error;
use sim3align_lab::bench::option_text;
use sim3align_lab::case_folder::case::read_case;

use super::{Failure, parsed};

const USAGE: &str = "\
Usage: sim3align-lab profile [--quality QUALITY] RUNS CASE...

Aligns each case folder RUNS times and prints JSON: { \"<folder>\": [result, …] }. QUALITY is one of `align`;
it and all other options have its defaults.";

struct Clock(Instant);

impl Host for Clock {
    fn now_ms(&mut self) -> f64 {
        self.0.elapsed().as_secs_f64() * 1000.0
    }

    fn progress(&mut self, _stage: Stage, _fraction: f64) {}
}

fn results(folder: &str, runs: usize, options: &AlignOptions) -> Result<Vec<Json>, Error> {
    let case = read_case(folder.as_ref())?;
    (0..runs)
        .map(|_| {
            let mut clock = Clock(Instant::now());
            let mesh = PreparedMesh::borrowed(&case.mesh).with_colors(case.colors.clone());
            let request = Request::new(options.clone())?;
            let alignment = align_prepared(&case.observation, &mesh, request, &mut clock)?;
            Ok(serde_json::to_value(alignment).unwrap_or_default())
        })
        .collect()
}

struct Arguments {
    options: AlignOptions,
    runs: usize,
    folders: Vec<String>,
}

/// `None` if help is requested.
fn parse(mut parser: lexopt::Parser) -> Result<Option<Arguments>, lexopt::Error> {
    let (mut options, mut runs, mut folders) = (AlignOptions::default(), None, Vec::new());
    while let Some(argument) = parser.next()? {
        match argument {
            Long("help") | Short('h') => return Ok(None),
            Long("quality") => {
                option_text::assign(&mut options, "quality", &parser.value()?.string()?).transpose()?;
            }
            Value(count) if runs.is_none() => runs = Some(count.parse()?),
            Value(folder) => folders.push(folder.string()?),
            _ => return Err(argument.unexpected()),
        }
    }
    let runs = runs.ok_or("no number of runs")?;
    Ok(Some(Arguments { options, runs, folders }))
}

/// Runs the command.
pub fn main(arguments: lexopt::Parser) -> Result<(), Failure> {
    let Arguments { options, runs, folders } = parsed(arguments, parse, USAGE)?;
    let mut all = Map::new();
    for folder in folders {
        let values = results(&folder, runs, &options)
            .map_err(|error| Failure::Failed(format!("{folder}: {} {error}", error.code.as_str())))?;
        all.insert(folder, values.into());
    }
    println!("{}", Json::Object(all));
    Ok(())
}
