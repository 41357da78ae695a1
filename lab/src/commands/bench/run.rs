//! Runs the cases on several threads; results are in the order of the cases.

use std::sync::{Arc, Mutex, PoisonError};

use serde::de::IgnoredAny;
use serde_json::json;
use sim3align_lab::baselines::align::align_baseline;
use sim3align_lab::bench::benchmark::{BenchCase, Record, run_method, run_prepared};
use sim3align_lab::bench::imported::imported;
use sim3align_lab::bench::overlay::picture;
use sim3align_lab::bench::records::{RecordFile, RecordKey};
use sim3align_lab::cases::case::EvaluationSet;
use sim3align_lab::cases::surplus::Surplus;
use sim3align_lab::cases::tier::{CaseSet, Tier};
use sim3align_lab::files::listed;
use sim3align_lab::parallel::parallel_map;
use sim3align_lab::scenes::{ClutteredScene, Prior, SceneSet};

use super::super::{Failure, print_progress, write_file};
use super::settings::{Method, Row, Settings};
use super::table;
use sim3align_lab::prelude::*;

/// The source of a case.
pub enum Source {
    Generated(CaseSet, usize),
    /// A case of a generated set with the mesh of the next one.
    Misfit(CaseSet, usize),
    Scene {
        scene: usize,
        pair: usize,
        prior: Prior,
    },
    Folder(PathBuf),
}

impl Source {
    /// Unique name of the case within a run.
    fn id(&self) -> String {
        match self {
            Self::Generated(CaseSet::General, index) => format!("generated-{index:04}"),
            Self::Generated(set, index) => format!("{}-{index:04}", set.as_str()),
            Self::Misfit(CaseSet::General, index) => format!("misfit-{index:04}"),
            Self::Misfit(set, index) => format!("misfit-{}-{index:04}", set.as_str()),
            Self::Scene { scene, pair, prior } => format!("scene-{scene:03}-{pair}-{}", prior.as_str()),
            Self::Folder(folder) => folder.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        }
    }
}

/// A set of scenes that caches the last scene, because its pairs are consecutive.
struct Scenes {
    set: SceneSet,
    last: Mutex<Option<Arc<ClutteredScene>>>,
}

impl Scenes {
    fn new(set: SceneSet) -> Self {
        Self { set, last: Mutex::new(None) }
    }

    /// All pairs, ordered by scene.
    fn sources(&self, priors: &[Prior]) -> Vec<Source> {
        let mut sources = Vec::new();
        for scene in 0..self.set.scenes() {
            for pair in 0..self.set.pairs_of(scene) {
                sources.extend(priors.iter().map(|&prior| Source::Scene { scene, pair, prior }));
            }
        }
        sources
    }

    fn case(&self, scene: usize, pair: usize, prior: Prior) -> Result<BenchCase> {
        self.scene(scene)?.pairs[pair].case(prior)
    }

    /// Holds the lock while drawing: waiting threads usually need the same scene.
    fn scene(&self, index: usize) -> Result<Arc<ClutteredScene>> {
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        match last.as_ref().filter(|scene| scene.index == index) {
            Some(scene) => Ok(scene.clone()),
            None => Ok(last.insert(Arc::new(self.set.scene(index)?)).clone()),
        }
    }
}

pub fn run(settings: &Settings) -> Result<(), Failure> {
    let set = match &settings.meshes {
        Some(folder) => EvaluationSet::with_meshes(settings.set_seed, folder)?,
        None => EvaluationSet::new(settings.set_seed),
    };
    let set = set.of(settings.set);
    let scenes = Scenes::new(SceneSet::new(settings.set_seed, settings.scenes));
    let sources = sources(settings, &scenes)?;
    if sources.is_empty() {
        return Err("no case left to run".into());
    }
    if let Some(folder) = &settings.write {
        return map_with_progress(settings.threads, &sources, |source| match source {
            Source::Generated(_, index) => {
                let case = set.case(*index)?;
                Ok(case.write(&folder.join(case.name()))?)
            }
            Source::Misfit(..) | Source::Scene { .. } | Source::Folder(_) => Ok(()),
        })
        .map(drop);
    }
    let load = |source: &Source| {
        let case = load(source, &set, &scenes, settings.surplus)?;
        Ok(if settings.color { case } else { case.without_color() })
    };
    if let (Some(path), Some(source)) = (&settings.picture, sources.first()) {
        return draw(&load(source)?, settings.matrix.as_deref(), path);
    }
    if let Some(path) = &settings.records {
        return go_on(settings, &sources, &load, path);
    }
    let begun = std::time::Instant::now();
    let records: Vec<Vec<Record>> = map_with_progress(settings.threads, &sources, |source| {
        let case = load(source)?;
        Ok(settings.rows.iter().map(|row| run_row(&case, row)).collect())
    })?;
    eprintln!("{} cases in {:.1} s", records.len(), begun.elapsed().as_secs_f64());
    let names = settings.rows.iter().map(|row| row.name.clone());
    let rows: Vec<(String, Vec<&Record>)> =
        names.enumerate().map(|(i, name)| (name, records.iter().map(|case| &case[i]).collect())).collect();
    print!("{}", table::report(&rows, settings.failures));
    if let Some(path) = &settings.json {
        let rows: Vec<_> = rows.iter().map(|(name, records)| json!({ "row": name, "records": records })).collect();
        let all = json!({ "set": settings.set.as_str(), "setSeed": settings.set_seed, "rows": rows });
        write_file(path, format!("{all}\n"))?;
    }
    Ok(())
}

/// Adds missing records to a file, and prints each as a line of JSON on standard output.
fn go_on(
    settings: &Settings,
    sources: &[Source],
    load: &(dyn Fn(&Source) -> Result<BenchCase> + Sync),
    path: &Path,
) -> Result<(), Failure> {
    let file = RecordFile::<IgnoredAny>::open(path)?;
    let missing = |source: &Source| -> Vec<(&Row, RecordKey)> {
        let keyed = settings.rows.iter().map(|row| (row, row.key(source.id())));
        keyed.filter(|(_, key)| !file.has(key)).collect()
    };
    let total = sources.len() * settings.rows.len();
    let left: usize = sources.iter().map(|source| missing(source).len()).sum();
    println!("{}", json!({ "total": total, "done": total - left }));
    map_with_progress(settings.threads, sources, |source| {
        let missing = missing(source);
        if missing.is_empty() {
            return Ok(());
        }
        let case = load(source)?;
        for (row, key) in missing {
            let record = run_row(&case, row);
            file.add(&key, &record)?;
            println!("{}", json!({ "row": key.row, "case": key.case, "seconds": record.seconds }));
        }
        Ok(())
    })
    .map(drop)
}

fn draw(case: &BenchCase, matrix: Option<&[f64]>, path: &Path) -> Result<(), Failure> {
    let pose = match matrix {
        Some(matrix) => {
            let numbers = <&[f64; 16]>::try_from(matrix).map_err(|_| "--matrix: expected 16 numbers")?;
            Some(Similarity::from_column_major(numbers)?)
        }
        None => case.truth.as_ref().map(|truth| truth.camera_from_mesh),
    };
    let pose = pose.ok_or("the case has no true pose: pass --matrix")?;
    write_file(path, picture(case, &pose)?)
}

fn run_row(case: &BenchCase, row: &Row) -> Record {
    let shape = row.is_shape_alone.then(|| case.clone().without_color());
    let case = shape.as_ref().unwrap_or(case);
    match &row.method {
        Method::Align => {
            let (options, search) = (row.preset_options(), &row.search);
            match row.keeps_surplus {
                true => run_prepared(case, &options, search, |mesh| PreparedMesh::as_given(mesh)),
                false => run_prepared(case, &options, search, |mesh| PreparedMesh::borrowed(mesh)),
            }
        }
        Method::Baseline(baseline) => run_method(case, |observation, mesh, host| {
            align_baseline(observation, mesh, *baseline, &row.paper, row.locks_scale(), host).map(Into::into)
        }),
        Method::Import(folder) => imported(case, folder),
    }
}

fn load(source: &Source, set: &EvaluationSet, scenes: &Scenes, surplus: Option<Surplus>) -> Result<BenchCase> {
    match source {
        Source::Generated(_, index) => {
            let case = set.case(*index)?;
            let mesh_from_object = case.camera_from_mesh.inverse().compose(&case.camera_from_object);
            let added = |kind: Surplus| kind.added_to(&case.mesh, &mesh_from_object, *index as u64);
            let given = surplus.map(added).transpose()?;
            Ok(BenchCase { given, ..BenchCase::from(case) })
        }
        Source::Misfit(_, index) => set.case(index + 1).and_then(|other| {
            let case = BenchCase::from(set.case(*index)?);
            let name = format!("misfit-{}", case.name);
            Ok(BenchCase { name, class: "misfit".into(), mesh: other.mesh, colors: None, ..case })
        }),
        Source::Scene { scene, pair, prior } => scenes.case(*scene, *pair, *prior),
        Source::Folder(folder) => BenchCase::read(folder),
    }
}

fn sources(settings: &Settings, scenes: &Scenes) -> Result<Vec<Source>, Failure> {
    let fits = |&index: &usize| {
        settings.tiers.as_ref().is_none_or(|tiers| tiers.contains(&Tier::of(index)))
            && settings.classes.as_ref().is_none_or(|classes| classes.contains(&settings.set.class(index)))
    };
    let generated: Vec<usize> = match &settings.only {
        Some(only) => only.clone(),
        None => (0..settings.generated).filter(fits).collect(),
    };
    let of_set = |index| Source::Generated(settings.set, index);
    let mut sources: Vec<Source> = generated.into_iter().map(of_set).collect();
    sources.extend((0..settings.misfits).map(|index| Source::Misfit(settings.set, index)));
    sources.extend(scenes.sources(&settings.priors));
    for folder in &settings.cases {
        sources.extend(case_folders(folder)?.into_iter().map(Source::Folder));
    }
    Ok(sources)
}

/// The folder itself if it contains a camera file, otherwise the case folders in it.
fn case_folders(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let is_case = |folder: &Path| folder.join("camera.json").is_file();
    if is_case(folder) {
        return Ok(vec![folder.into()]);
    }
    let mut folders = listed(folder)?;
    folders.retain(|folder| is_case(folder));
    Ok(folders)
}

/// Maps items in parallel, and reports progress on standard error.
fn map_with_progress<T: Sync, R: Send>(
    threads: usize,
    items: &[T],
    work: impl Fn(&T) -> Result<R, Failure> + Sync,
) -> Result<Vec<R>, Failure> {
    parallel_map(threads, items, work, |done| print_progress(done, items.len()))
}
