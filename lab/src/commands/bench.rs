//! `bench`: runs rows of calls over generated cases and case folders, and prints tables of the results.

use serde::de::IgnoredAny;
use sim3align_lab::bench::calls::run as run_row;
use sim3align_lab::bench::options::Row;
use sim3align_lab::bench::records::{RecordFile, RecordKey};
use sim3align_lab::bench::result::ResultRow;
use sim3align_lab::bench::table::report;
use sim3align_lab::case::Case;
use sim3align_lab::case_folder::read::{FolderKind, case_folders, read};
use sim3align_lab::parallel::parallel_map;
use sim3align_lab::prelude::*;
use sim3align_lab::sets::Set;

use super::{Failure, print_progress, thread_count, usage};

/// Runs rows over cases with a known truth, and prints Markdown tables of success, errors, metrics, warnings and failures.
#[derive(clap::Args)]
pub struct Arguments {
    /// A generated set: general, sensors, colors, surplus, misfits, monocular, scenes, arranged, clutter, clutter-smooth,
    /// placements, views or videos
    #[arg(long)]
    set: Option<Set>,
    /// Number of generated cases
    #[arg(long, default_value_t = 24)]
    count: usize,
    /// Index of the first generated case
    #[arg(long, default_value_t = 0)]
    from: usize,
    /// Seed of the generated set
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Frames of each generated video
    #[arg(long, default_value_t = 60)]
    frames: usize,
    /// Case folders, scene folders, folders with frames, or folders of these
    #[arg(long, num_args = 1..)]
    cases: Vec<PathBuf>,
    /// A row of the table, 'NAME: option=value …': options of align by their JavaScript names, preset, call (align, scene,
    /// views, track, placement), color, initial, up, cameras, views, masks, model; the rows of the set by default
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
    /// Number of failures that are listed for each row
    #[arg(long, default_value_t = 20)]
    failures: usize,
    /// All by default
    #[arg(long)]
    threads: Option<usize>,
}

/// The source of a case.
enum Source {
    Generated(Set, usize),
    Folder(PathBuf, FolderKind),
}

impl Source {
    /// Unique name within a run.
    fn id(&self) -> String {
        match self {
            Self::Generated(set, index) => format!("{}-{index:04}", set.as_str()),
            Self::Folder(folder, _) => folder.display().to_string(),
        }
    }

    fn set(&self) -> &'static str {
        match self {
            Self::Generated(set, _) => set.as_str(),
            Self::Folder(..) => "given",
        }
    }

    /// The rows by default: for folders, those of the generated set of their kind.
    fn rows(&self) -> &'static [&'static str] {
        match self {
            Self::Generated(set, _) => set.rows(),
            Self::Folder(_, FolderKind::Case) => Set::General.rows(),
            Self::Folder(_, FolderKind::Scene) => Set::Scenes.rows(),
            Self::Folder(_, FolderKind::Frames) => Set::Views.rows(),
        }
    }

    fn case(&self, arguments: &Arguments) -> Result<Case> {
        match self {
            Self::Generated(set, index) => set.case(arguments.seed, *index, arguments.frames),
            Self::Folder(folder, _) => read(folder),
        }
    }
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let sources = sources(arguments)?;
    let threads = thread_count(arguments.threads);
    let progress = |done| print_progress(done, sources.len());
    if let Some(folder) = &arguments.write {
        return Ok(parallel_map(threads, &sources, |source| write(source, arguments, folder), progress).map(drop)?);
    }
    let given = given_rows(arguments).map_err(usage)?;
    let rows_of = |source: &Source| -> Result<Vec<Row>, String> {
        if given.is_empty() { source.rows().iter().map(|text| Row::parse(text)).collect() } else { Ok(given.clone()) }
    };
    let file = arguments.json.as_deref().map(RecordFile::<IgnoredAny>::open).transpose()?;
    let work = |source: &Source| -> Result<Vec<(String, Vec<ResultRow>)>, Failure> {
        let key = |row: &Row| RecordKey { row: row.name.clone(), options: row.text.clone(), case: source.id() };
        let mut rows = rows_of(source)?;
        rows.retain(|row| file.as_ref().is_none_or(|file| !file.has(&key(row))));
        if rows.is_empty() {
            return Ok(Vec::new());
        }
        let case = source.case(arguments)?;
        let mut all = Vec::new();
        for row in &rows {
            let mut results = run_row(&case, row);
            results.iter_mut().for_each(|result| result.set = source.set().into());
            file.as_ref().map_or(Ok(()), |file| file.add_all(&key(row), &results))?;
            all.push((row.name.clone(), results));
        }
        Ok(all)
    };
    let found = parallel_map(threads, &sources, work, progress)?.into_iter().flatten();
    let all: Vec<(String, Vec<ResultRow>)> = match &arguments.json {
        Some(path) => {
            let kept = RecordFile::<ResultRow>::records(path)?;
            kept.into_iter().map(|(key, result)| (key.row, vec![result])).collect()
        }
        None => found.collect(),
    };
    let mut rows: Vec<(String, Vec<ResultRow>)> = Vec::new();
    for (name, results) in all {
        match rows.iter_mut().find(|(known, _)| *known == name) {
            Some((_, list)) => list.extend(results),
            None => rows.push((name, results)),
        }
    }
    // Threads end in any order.
    rows.iter_mut().for_each(|(_, results)| results.sort_by(|a, b| a.name.cmp(&b.name)));
    print!("{}", report(&rows, arguments.failures));
    Ok(())
}

fn sources(arguments: &Arguments) -> Result<Vec<Source>, Failure> {
    let mut sources = Vec::new();
    for folder in &arguments.cases {
        let kind = |path: PathBuf| FolderKind::of(&path).map(|kind| Source::Folder(path, kind));
        sources.extend(case_folders(folder)?.into_iter().filter_map(kind));
    }
    if let Some(set) = arguments.set {
        sources.extend((arguments.from..arguments.from + arguments.count).map(|index| Source::Generated(set, index)));
    }
    if sources.is_empty() { Err(usage("found no case: pass --set or --cases")) } else { Ok(sources) }
}

fn given_rows(arguments: &Arguments) -> Result<Vec<Row>, String> {
    let rows = arguments.rows.iter().map(|text| Row::parse(text));
    let imported = arguments.imports.iter().map(|text| {
        let (name, folder) = text.split_once('=').ok_or("--import without NAME= before its folder")?;
        Row::imported(name, folder.as_ref())
    });
    rows.chain(imported).collect()
}

fn write(source: &Source, arguments: &Arguments, folder: &Path) -> Result<()> {
    let case = source.case(arguments)?;
    let is_split = matches!(source, Source::Generated(set, _) if set.is_of_objects());
    let cases = if is_split { case.split() } else { vec![case] };
    cases.iter().try_for_each(|case| case.write(&folder.join(&case.name)))
}
