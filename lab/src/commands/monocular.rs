//! `monocular`: aligns objects with depth as depth models give it, and prints tables by what is wrong with it.

use serde_json::json;
use sim3align_lab::bench::option_text;
use sim3align_lab::monocular::reading::Treatment;
use sim3align_lab::monocular::record::{JudgedRecord, Record};
use sim3align_lab::monocular::row::Row;
use sim3align_lab::monocular::runs::{Settings, Way, run as run_rows};
use sim3align_lab::monocular::table::report;
use sim3align_lab::parallel::parallel_map;
use sim3align_lab::prelude::*;

use super::pictures::Pictures;
use super::{Arguments, Command, Failure, print_progress, usage, write_file};

pub const COMMAND: Command = Command {
    name: "monocular",
    about: "aligns objects with the depth of depth models, and prints tables",
    usage: "\
Usage: sim3align-lab monocular [--generated N] [--cases DIR...] [--scenes DIR...] [options]

Turns depth with a known truth into what a depth model gives, aligns with it, and prints a table by what the model
gets wrong. The objects of a scene are aligned each alone, and all together.

  --generated N      cases 0 to N − 1 of the generated set
  --cluttered N      N generated scenes of two to four objects on a table
  --cases DIR...     case folders, or folders of case folders
  --scenes DIR...    scene folders, or folders of scene folders
  --rows R,…         only these: filled, scaled, scale-invariant, shifted, shifted-metric, disparity, disparity-8,
                     disparity-guessed, bent, blurred, blurred-disparity, mild, focal-wrong, focal-unknown,
                     disparity-focal-unknown
  --ways W,…         only these, of scenes: alone, together, one-length (together, with the length of one object)
  --naive            assumes what is unknown instead of estimating it: no shift, near and far guessed, the focal length
                     as it is given or of 60° across
  --seed S           seed of the errors of the maps, default 0
  --set-seed S       seed of the generated set and of the generated scenes, default 0
  --quality Q        of `align`
  --json FILE        keeps all records
  --threads N        default: all
  --help             this text",
    run,
};

/// Runs the command.
pub fn run(arguments: &mut Arguments) -> Result<(), Failure> {
    let pictures = Pictures::of(arguments)?.some()?;
    let settings = Settings {
        rows: arguments.list("rows")?.unwrap_or_else(|| Row::ALL.to_vec()),
        ways: arguments.list("ways")?.unwrap_or_else(|| Way::ALL.to_vec()),
        treatment: if arguments.flag("naive") { Treatment::Naive } else { Treatment::Estimated },
        options: option_text::with_quality(arguments.optional("quality")?).map_err(usage)?,
        seed: arguments.value("seed", 0)?,
    };
    let json: Option<PathBuf> = arguments.optional("json")?;
    let threads = arguments.threads("threads")?;
    arguments.end()?;
    let records = parallel_map(
        threads,
        &pictures.sources,
        |source| run_rows(&pictures.picture(source)?, &settings),
        |done| print_progress(done, pictures.sources.len()),
    )?;
    let records: Vec<Record> = records.into_iter().flatten().collect();
    println!("{}", report(&records, &settings.rows, &settings.ways));
    let treatment = settings.treatment.as_str();
    let judged: Vec<JudgedRecord> = records.iter().map(JudgedRecord::from).collect();
    let all = json!({ "treatment": treatment, "seed": settings.seed, "setSeed": pictures.seed, "records": judged });
    match &json {
        Some(path) => write_file(path, format!("{}\n", all)),
        None => Ok(()),
    }
}
