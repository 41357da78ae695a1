//! `together`: aligns the objects of scenes alone and together.

use sim3align_lab::bench::option_text;
use sim3align_lab::bench::scene_bench::{BenchScene, Outcome, SceneRecord, table};
use sim3align_lab::parallel::parallel_map;
use sim3align_lab::prelude::*;
use sim3align_lab::scenes::{Prior, SceneSet};

use super::{Arguments, Command, Failure, print_progress, usage, write_file};

pub const COMMAND: Command = Command {
    name: "together",
    about: "aligns the objects of scenes alone and together, and prints tables",
    usage: "\
Usage: sim3align-lab together [--scenes N] [--cases DIR...] [options]

Aligns every object of each scene alone and all of them together, and prints both next to the truth.

  --scenes N       N cluttered scenes; 100 are 338 pairs
  --arranged N     N scenes of two to twelve objects, which also lean, hang, stand on each other and on boards, and
                   lie in piles
  --from N         leaves out the scenes before this one
  --prior P        what made their meshes: detailed (default) or smooth
  --set-seed S     seed of the set, default 0
  --cases DIR...   scene folders: depth.*, camera.json, objects/NAME/{mask.*, mesh.*, gt.json}, plane.json
  --quality Q      of `align`
  --snap           puts objects exactly onto what they touch
  --objects        prints every object
  --json FILE      keeps all records
  --write DIR      writes the generated scenes as scene folders instead of aligning them
  --threads N      default: all
  --help           this text",
    run,
};

/// The source of a scene.
enum Source<'a> {
    Generated(&'a SceneSet, usize),
    Folder(PathBuf),
}

fn run(arguments: &mut Arguments) -> Result<(), Failure> {
    let (scenes, arranged): (usize, usize) = (arguments.value("scenes", 0)?, arguments.value("arranged", 0)?);
    let (from, set_seed) = (arguments.value("from", 0)?, arguments.value("set-seed", 0)?);
    let prior = arguments.value("prior", Prior::Detailed)?;
    let options = option_text::with_quality(arguments.optional("quality")?).map_err(usage)?;
    let (snap, prints_objects) = (arguments.flag("snap"), arguments.flag("objects"));
    let (cases, threads) = (arguments.paths("cases")?, arguments.threads("threads")?);
    let (json, folder): (Option<PathBuf>, Option<PathBuf>) =
        (arguments.optional("json")?, arguments.optional("write")?);
    arguments.end()?;
    if scenes + arranged == 0 && cases.is_empty() {
        return Err(usage("--scenes, --arranged or --cases is expected"));
    }
    let sets = [SceneSet::new(set_seed, scenes), SceneSet::arranged(set_seed, arranged)];
    let generated = sets.iter().flat_map(|set| (from..set.scenes()).map(move |index| Source::Generated(set, index)));
    let sources: Vec<Source> = cases.into_iter().map(Source::Folder).chain(generated).collect();
    if let Some(folder) = &folder {
        return write(&sources, prior, folder, threads);
    }
    let align = |source: &Source| {
        let scene = match source {
            Source::Folder(path) => BenchScene::read(path)?,
            Source::Generated(set, index) => BenchScene::of_cluttered(&set.scene(*index)?, prior)?,
        };
        scene.run(&options, snap)
    };
    let records = parallel_map(threads, &sources, align, |done| print_progress(done, sources.len()))?;
    if prints_objects {
        records.iter().for_each(print_objects);
    }
    println!("{}", table(&records));
    match &json {
        Some(path) => write_file(path, serde_json::to_string(&records)?),
        None => Ok(()),
    }
}

/// Writes the generated scenes as `folder`/SCENE, from 000; the arranged ones after the others.
fn write(sources: &[Source], prior: Prior, folder: &Path, threads: usize) -> Result<(), Failure> {
    let numbered: Vec<_> = sources.iter().enumerate().collect();
    let write = |(number, source): &(usize, &Source)| match source {
        Source::Folder(_) => Ok(()),
        Source::Generated(set, index) => set.scene(*index)?.write(prior, &folder.join(format!("{number:03}"))),
    };
    Ok(parallel_map(threads, &numbered, write, |_| {}).map(drop)?)
}

fn print_objects(scene: &SceneRecord) {
    println!("{}: support {:?}, errors {:?}", scene.name, scene.support, scene.plane_errors);
    for object in &scene.objects {
        let text = |outcome: &Outcome| match (&outcome.errors, &outcome.error) {
            (Some(errors), _) => format!(
                "size {:+5.1} % turn {:5.1}° place {:4.1} % tilt {:5.1}° gap {:+5.1} mm sure {:.2}",
                100.0 * outcome.scale.unwrap_or_default(),
                errors.rotation_error_deg,
                100.0 * errors.translation_error_relative,
                outcome.tilt_deg.unwrap_or(f64::NAN),
                1000.0 * outcome.gap_m.unwrap_or(f64::NAN),
                outcome.confidence
            ),
            (None, Some(error)) => error.clone(),
            (None, None) => format!("sure {:.2}", outcome.confidence),
        };
        let contact =
            object.contact.as_ref().map(|c| (c.rests_on, c.gap_m.map(|g| (1e4 * g).round() / 10.0), c.shared_volume));
        println!(
            "  {:24} alone    {}\n  {:24} together {} {contact:?}",
            object.name,
            text(&object.alone),
            "",
            text(&object.together)
        );
    }
}
