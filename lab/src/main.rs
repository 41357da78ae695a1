//! `sim3align-lab bench`: runs rows of calls over generated cases and case folders.

use std::process::ExitCode;

use clap::Parser;
use sim3align_lab::bench::calls::{registered, run as run_row};
use sim3align_lab::bench::records::{Record, RecordFile};
use sim3align_lab::bench::result::ResultRow;
use sim3align_lab::bench::row::Row;
use sim3align_lab::bench::table::report;
use sim3align_lab::case::Case;
use sim3align_lab::case_folder::read::{FolderKind, case_folders, read};
use sim3align_lab::clouds::{Pair, VOXEL_SIZE_M, pairs};
use sim3align_lab::parallel::parallel_map;
use sim3align_lab::prelude::*;
use sim3align_lab::sets::Set;

/// Benchmarks of sim3align over generated cases and case folders.
#[derive(Parser)]
#[command(name = "sim3align-lab")]
enum Program {
    /// Runs rows over cases with a known truth, and prints a table of success and errors
    Bench(Arguments),
}

#[derive(clap::Args)]
struct Arguments {
    /// A generated set: general, sensors, colors, scenes or videos
    #[arg(long)]
    set: Option<Set>,
    /// Number of generated cases
    #[arg(long, default_value_t = 24)]
    count: usize,
    /// Index of the first generated case
    #[arg(long, default_value_t = 0)]
    from: usize,
    /// Seed of the generated cases
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Frames of each generated video
    #[arg(long, default_value_t = 60)]
    frames: usize,
    /// Case folders, scene folders, folders with frames, or folders of these
    #[arg(long, num_args = 1..)]
    cases: Vec<PathBuf>,
    /// So many generated rooms, of which pairs of scans are registered
    #[arg(long, default_value_t = 0)]
    rooms: usize,
    /// Takes the first pair of scans of all rooms and every N-th after it
    #[arg(long, default_value_t = 1)]
    every: usize,
    /// A row of the table, 'NAME: option=value …': options by their JavaScript names, preset, call (align, scene, views,
    /// track), color, cameras, views, masks, initial, model, surplus, misfit; the rows of the set by default
    #[arg(long = "row")]
    rows: Vec<String>,
    /// A row with the answers of another program, DIR/CASE.json (docs/importing-results.md)
    #[arg(long = "import", value_name = "NAME=DIR")]
    imports: Vec<String>,
    /// Keeps one JSON line for each result; cases that the file has are not run again
    #[arg(long)]
    json: Option<PathBuf>,
    /// Writes the generated cases as folders, and aligns nothing
    #[arg(long)]
    write: Option<PathBuf>,
    /// With --write: a folder for each object of a scene
    #[arg(long)]
    split: bool,
    /// All by default
    #[arg(long)]
    threads: Option<usize>,
}

/// The source of the cases of a table.
enum Source {
    Generated(Set, usize),
    Folder(PathBuf, FolderKind),
    Pair(Box<Pair>),
}

impl Source {
    /// Unique name within a run.
    fn id(&self) -> String {
        match self {
            Self::Generated(set, index) => format!("{}-{index:04}", set.as_str()),
            Self::Folder(folder, _) => folder.display().to_string(),
            Self::Pair(pair) => pair.name.clone(),
        }
    }

    fn set(&self) -> &'static str {
        match self {
            Self::Generated(set, _) => set.as_str(),
            Self::Folder(..) => "given",
            Self::Pair(_) => "rooms",
        }
    }

    /// The rows by default.
    fn rows(&self) -> &'static [&'static str] {
        match self {
            Self::Generated(set, _) => set.rows(),
            Self::Folder(_, FolderKind::Case) => Set::General.rows(),
            Self::Folder(_, FolderKind::Scene) => Set::Scenes.rows(),
            Self::Folder(_, FolderKind::Frames) => {
                &["known cameras: call=views", "unknown cameras: call=views cameras=false"]
            }
            Self::Pair(_) => &["register:"],
        }
    }

    fn case(&self, arguments: &Arguments) -> Result<Option<Case>> {
        match self {
            Self::Generated(set, index) => set.case(arguments.seed, *index, arguments.frames).map(Some),
            Self::Folder(folder, _) => read(folder).map(Some),
            Self::Pair(_) => Ok(None),
        }
    }

    fn run(&self, rows: &[Row], arguments: &Arguments) -> Result<Vec<Record>> {
        let case = self.case(arguments)?;
        let results = |row: &Row| match (self, &case) {
            (Self::Pair(pair), _) => vec![registered(pair, row)],
            (_, Some(case)) => run_row(case, row),
            (_, None) => Vec::new(),
        };
        let record = |row: &Row, result| Record::new(row, &self.id(), ResultRow { set: self.set().into(), ..result });
        Ok(rows.iter().flat_map(|row| results(row).into_iter().map(|result| record(row, result))).collect())
    }

    fn write(&self, arguments: &Arguments, folder: &Path) -> Result<()> {
        if let Self::Pair(pair) = self {
            return pair.write(folder);
        }
        if let Some(case) = self.case(arguments)? {
            let cases = if arguments.split { case.split() } else { vec![case] };
            cases.iter().try_for_each(|case| case.write(&folder.join(&case.name)))?;
        }
        Ok(())
    }
}

fn main() -> ExitCode {
    let Program::Bench(arguments) = Program::parse();
    match bench(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("sim3align-lab: {message}");
            ExitCode::FAILURE
        }
    }
}

fn bench(arguments: &Arguments) -> Result<(), String> {
    let sources = sources(arguments).map_err(in_words)?;
    if sources.is_empty() {
        return Err("found no case: pass --set, --cases or --rooms".into());
    }
    let threads = arguments.threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
    let progress = |done: usize| {
        if done.is_multiple_of(10) || done == sources.len() {
            eprint!("\r{done} of {} {}", sources.len(), if done == sources.len() { "\n" } else { "" });
        }
    };
    if let Some(folder) = &arguments.write {
        parallel_map(threads, &sources, |source| source.write(arguments, folder), progress).map_err(in_words)?;
        return write_list(&sources, folder);
    }
    let given = given_rows(arguments)?;
    let file = arguments.json.as_deref().map(RecordFile::open).transpose().map_err(in_words)?;
    let work = |source: &Source| -> Result<Vec<Record>, String> {
        let mut rows = match given.as_slice() {
            [] => source.rows().iter().map(|text| Row::parse(text)).collect::<Result<Vec<_>, _>>()?,
            rows => rows.to_vec(),
        };
        rows.retain(|row| file.as_ref().is_none_or(|file| !file.has(row, &source.id())));
        if rows.is_empty() {
            return Ok(Vec::new());
        }
        let made = source.run(&rows, arguments).map_err(in_words)?;
        file.as_ref().map_or(Ok(()), |file| file.add(&made)).map_err(in_words)?;
        Ok(made)
    };
    let made = parallel_map(threads, &sources, work, progress)?.into_iter().flatten();
    let records: Vec<Record> = file.iter().flat_map(|file| file.before.clone()).chain(made).collect();
    print!("{}", report(&records));
    Ok(())
}

fn in_words(error: Error) -> String {
    format!("{} {error}", error.code.as_str())
}

fn sources(arguments: &Arguments) -> Result<Vec<Source>> {
    let mut sources = Vec::new();
    for folder in &arguments.cases {
        let kind = |path: PathBuf| FolderKind::of(&path).map(|kind| Source::Folder(path, kind));
        sources.extend(case_folders(folder)?.into_iter().filter_map(kind));
    }
    if let Some(set) = arguments.set {
        sources.extend((arguments.from..arguments.from + arguments.count).map(|index| Source::Generated(set, index)));
    }
    let mut scans = Vec::new();
    for room in 0..arguments.rooms {
        scans.extend(pairs(arguments.seed, room)?);
    }
    sources.extend(scans.into_iter().step_by(arguments.every.max(1)).map(|pair| Source::Pair(Box::new(pair))));
    Ok(sources)
}

fn given_rows(arguments: &Arguments) -> Result<Vec<Row>, String> {
    let rows = arguments.rows.iter().map(|text| Row::parse(text));
    let imported = arguments.imports.iter().map(|text| {
        let (name, folder) = text.split_once('=').ok_or("--import without NAME= before its folder")?;
        Row::imported(name, folder.as_ref())
    });
    rows.chain(imported).collect()
}

/// Writes the list of pairs for other programs, if there are any: `[{ id, source, target, voxelSizeM }]`.
fn write_list(sources: &[Source], folder: &Path) -> Result<(), String> {
    let folder = std::path::absolute(folder).map_err(|error| error.to_string())?;
    let entry = |source: &Source| {
        let Source::Pair(pair) = source else { return None };
        let cloud = |name: &str| folder.join(&pair.name).join(name);
        let (source, target) = (cloud("source.ply"), cloud("target.ply"));
        Some(serde_json::json!({ "id": pair.name, "source": source, "target": target, "voxelSizeM": VOXEL_SIZE_M }))
    };
    let list: Vec<_> = sources.iter().filter_map(entry).collect();
    if list.is_empty() {
        return Ok(());
    }
    std::fs::write(folder.join("pairs.json"), serde_json::json!(list).to_string()).map_err(|error| error.to_string())
}
