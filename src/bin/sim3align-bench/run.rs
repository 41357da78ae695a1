//! The cases, shared out among threads; what comes back is in their order.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use serde_json::json;
use sim3align::samples::benchmark::{BenchCase, Record, run_case};
use sim3align::samples::evaluation::case::EvaluationSet;
use sim3align::samples::evaluation::tier::{Class, Tier};
use sim3align::samples::imported::imported;

use crate::arguments::{Arguments, Row};
use crate::table;

/// Where a case comes from.
enum Source {
    Generated(usize),
    Folder(PathBuf),
}

pub fn run(arguments: &Arguments) -> Result<(), String> {
    let set = match &arguments.meshes {
        Some(folder) => EvaluationSet::with_meshes(arguments.set_seed, folder).map_err(|error| error.to_string())?,
        None => EvaluationSet::new(arguments.set_seed),
    };
    let sources = sources(arguments)?;
    if sources.is_empty() {
        return Err("no case left to run".into());
    }
    if let Some(folder) = &arguments.write {
        let written = in_order(arguments.threads, &sources, |source| match source {
            Source::Generated(index) => {
                let case = set.case(*index).map_err(|error| error.to_string())?;
                case.write(&folder.join(case.name())).map_err(|error| error.to_string())
            }
            Source::Folder(_) => Ok(()),
        });
        return written.into_iter().collect();
    }
    let begun = std::time::Instant::now();
    let records = in_order(arguments.threads, &sources, |source| {
        let case = load(source, &set)?;
        Ok(arguments.rows.iter().map(|row| record(row, &case)).collect())
    });
    let records: Vec<Vec<Record>> = records.into_iter().collect::<Result<_, String>>()?;
    eprintln!("{} cases in {:.1} s", records.len(), begun.elapsed().as_secs_f64());
    let names = arguments.rows.iter().map(|row| row.name.clone());
    let rows: Vec<(String, Vec<&Record>)> =
        names.enumerate().map(|(i, name)| (name, records.iter().map(|case| &case[i]).collect())).collect();
    print!("{}", table::report(&rows, arguments.failures));
    if let Some(path) = &arguments.json {
        let rows: Vec<_> = rows.iter().map(|(name, records)| json!({ "row": name, "records": records })).collect();
        let all = json!({ "setSeed": arguments.set_seed, "rows": rows });
        fs::write(path, format!("{all}\n")).map_err(|error| format!("{}: {error}", path.display()))?;
    }
    Ok(())
}

fn record(row: &Row, case: &BenchCase) -> Record {
    match &row.import {
        Some(folder) => imported(case, folder),
        None => run_case(case, &row.options, &row.search),
    }
}

fn load(source: &Source, set: &EvaluationSet) -> Result<BenchCase, String> {
    let case = match source {
        Source::Generated(index) => set.case(*index).map(BenchCase::from),
        Source::Folder(folder) => BenchCase::read(folder),
    };
    case.map_err(|error| error.to_string())
}

fn sources(arguments: &Arguments) -> Result<Vec<Source>, String> {
    let fits =
        |&index: &usize| arguments.tiers.contains(&Tier::of(index)) && arguments.classes.contains(&Class::of(index));
    let generated: Vec<usize> = match &arguments.only {
        Some(only) => only.clone(),
        None => (0..arguments.generated).filter(fits).collect(),
    };
    let mut sources: Vec<Source> = generated.into_iter().map(Source::Generated).collect();
    for folder in &arguments.cases {
        sources.extend(case_folders(folder)?.into_iter().map(Source::Folder));
    }
    Ok(sources)
}

/// The folder itself where it holds a camera file, else the case folders in it.
fn case_folders(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let is_case = |folder: &Path| folder.join("camera.json").is_file();
    if is_case(folder) {
        return Ok(vec![folder.into()]);
    }
    let entries = fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut folders: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    folders.retain(|folder| is_case(folder));
    folders.sort();
    Ok(folders)
}

/// What `work` makes of every item, on several threads, in the items' order.
fn in_order<T: Sync, R: Send>(threads: usize, items: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let done = AtomicUsize::new(0);
    let results: Vec<Mutex<Option<R>>> = items.iter().map(|_| Mutex::new(None)).collect();
    std::thread::scope(|scope| {
        for _ in 0..threads.min(items.len()) {
            scope.spawn(|| {
                loop {
                    let i = next.fetch_add(1, Ordering::Relaxed);
                    let (Some(item), Some(slot)) = (items.get(i), results.get(i)) else { break };
                    let result = work(item);
                    if let Ok(mut slot) = slot.lock() {
                        *slot = Some(result);
                    }
                    let done = done.fetch_add(1, Ordering::Relaxed) + 1;
                    if done.is_multiple_of(10) || done == items.len() {
                        eprint!("\r{done} of {} ", items.len());
                    }
                }
            });
        }
    });
    eprintln!();
    results.into_iter().filter_map(|slot| slot.into_inner().ok().flatten()).collect()
}
