//! `monocular`: aligns objects with depth as depth models give it, and prints tables by what is wrong with it.

use serde_json::json;
use sim3align_lab::bench::benchmark::BenchCase;
use sim3align_lab::bench::option_text;
use sim3align_lab::bench::scene_bench::BenchScene;
use sim3align_lab::cases::case::EvaluationSet;
use sim3align_lab::cases::tier::CaseSet;
use sim3align_lab::files::listed;
use sim3align_lab::monocular::picture::Picture;
use sim3align_lab::monocular::reading::Treatment;
use sim3align_lab::monocular::record::Record;
use sim3align_lab::monocular::row::Row;
use sim3align_lab::monocular::runs::{Settings, Way, run as run_rows};
use sim3align_lab::monocular::table::report;
use sim3align_lab::parallel::parallel_map;
use sim3align_lab::prelude::*;
use sim3align_lab::scenes::{Prior, SceneSet};

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

/// The source of an image.
enum Source {
    Generated(usize),
    Cluttered(usize),
    Case(PathBuf),
    Scene(PathBuf),
}

/// Runs the command.
pub fn run(arguments: &mut Arguments) -> Result<(), Failure> {
    let (generated, cluttered): (usize, usize) = (arguments.value("generated", 0)?, arguments.value("cluttered", 0)?);
    let cases = folders(&arguments.paths("cases")?, "mesh")?;
    let scenes = folders(&arguments.paths("scenes")?, "objects")?;
    let settings = Settings {
        rows: arguments.list("rows")?.unwrap_or_else(|| Row::ALL.to_vec()),
        ways: arguments.list("ways")?.unwrap_or_else(|| Way::ALL.to_vec()),
        treatment: if arguments.flag("naive") { Treatment::Naive } else { Treatment::Estimated },
        options: option_text::with_quality(arguments.optional("quality")?).map_err(usage)?,
        seed: arguments.value("seed", 0)?,
    };
    let set_seed = arguments.value("set-seed", 0)?;
    let json: Option<PathBuf> = arguments.optional("json")?;
    let threads = arguments.threads("threads")?;
    arguments.end()?;
    let sources: Vec<Source> = (0..generated)
        .map(Source::Generated)
        .chain((0..cluttered).map(Source::Cluttered))
        .chain(cases.into_iter().map(Source::Case))
        .chain(scenes.into_iter().map(Source::Scene))
        .collect();
    if sources.is_empty() {
        return Err(usage("--generated, --cluttered, --cases or --scenes is expected"));
    }
    let set = EvaluationSet::new(set_seed).of(CaseSet::Monocular);
    let clutter = SceneSet::new(set_seed, cluttered);
    let records = parallel_map(
        threads,
        &sources,
        |source| {
            let picture = match source {
                Source::Generated(index) => Picture { has_steps: true, ..BenchCase::from(set.case(*index)?).into() },
                Source::Cluttered(index) => BenchScene::of_cluttered(&clutter.scene(*index)?, Prior::Detailed)?.into(),
                Source::Case(folder) => BenchCase::read(folder)?.into(),
                Source::Scene(folder) => BenchScene::read(folder)?.into(),
            };
            run_rows(&picture, &settings)
        },
        |done| print_progress(done, sources.len()),
    )?;
    let records: Vec<Record> = records.into_iter().flatten().collect();
    println!("{}", report(&records, &settings.rows, &settings.ways));
    let treatment = settings.treatment.as_str();
    let all = json!({ "treatment": treatment, "seed": settings.seed, "setSeed": set_seed, "records": records });
    match &json {
        Some(path) => write_file(path, format!("{}\n", all)),
        None => Ok(()),
    }
}

/// The folders themselves if they contain an entry that begins so, otherwise the folders in them that do.
fn folders(paths: &[PathBuf], stem: &str) -> Result<Vec<PathBuf>, Failure> {
    let has = |folder: &Path| {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        entries.into_iter().any(|entry| entry.file_name().to_string_lossy().starts_with(stem))
    };
    let mut found = Vec::new();
    for path in paths {
        if has(path) {
            found.push(path.clone());
        } else {
            found.extend(listed(path)?.into_iter().filter(|folder| has(folder)));
        }
    }
    Ok(found)
}
