//! `together`: aligns the objects of scenes alone and together.

use lexopt::prelude::*;
use sim3align::precise::options::AlignOptions;
use sim3align_lab::bench::option_text;
use sim3align_lab::bench::scene_bench::{BenchScene, SceneRecord, table};
use sim3align_lab::parallel::parallel_map;
use sim3align_lab::scenes::{Prior, SceneSet};

use super::{Failure, parsed};
use sim3align_lab::prelude::*;

const USAGE: &str = "\
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
  --help           this text";

/// The source of a scene.
enum Source<'a> {
    Generated(&'a SceneSet, usize),
    Folder(PathBuf),
}

struct Arguments {
    scenes: usize,
    arranged: usize,
    from: usize,
    prior: Prior,
    set_seed: u64,
    cases: Vec<PathBuf>,
    options: AlignOptions,
    snap: bool,
    objects: bool,
    json: Option<PathBuf>,
    write: Option<PathBuf>,
    threads: usize,
}

/// `None` if help is requested.
fn parse(mut parser: lexopt::Parser) -> Result<Option<Arguments>, lexopt::Error> {
    let mut arguments = Arguments {
        scenes: 0,
        arranged: 0,
        from: 0,
        prior: Prior::Detailed,
        set_seed: 0,
        cases: Vec::new(),
        options: AlignOptions::default(),
        snap: false,
        objects: false,
        json: None,
        write: None,
        threads: std::thread::available_parallelism().map_or(1, usize::from),
    };
    while let Some(argument) = parser.next()? {
        match argument {
            Long("help") | Short('h') => return Ok(None),
            Long("scenes") => arguments.scenes = parser.value()?.parse()?,
            Long("arranged") => arguments.arranged = parser.value()?.parse()?,
            Long("from") => arguments.from = parser.value()?.parse()?,
            Long("prior") => {
                let name = parser.value()?.string()?;
                arguments.prior = Prior::from_name(&name).map_err(|error: Error| error.to_string())?;
            }
            Long("set-seed") => arguments.set_seed = parser.value()?.parse()?,
            Long("cases") => arguments.cases.extend(parser.values()?.map(PathBuf::from)),
            Long("quality") => {
                option_text::assign(&mut arguments.options, "quality", &parser.value()?.string()?).transpose()?;
            }
            Long("snap") => arguments.snap = true,
            Long("objects") => arguments.objects = true,
            Long("json") => arguments.json = Some(parser.value()?.into()),
            Long("write") => arguments.write = Some(parser.value()?.into()),
            Long("threads") => arguments.threads = parser.value()?.parse()?,
            _ => return Err(argument.unexpected()),
        }
    }
    if arguments.scenes + arguments.arranged == 0 && arguments.cases.is_empty() {
        return Err("--scenes, --arranged or --cases is expected".into());
    }
    Ok(Some(arguments))
}

/// Runs the command.
pub fn main(parser: lexopt::Parser) -> Result<(), Failure> {
    let arguments = parsed(parser, parse, USAGE)?;
    let set = SceneSet::new(arguments.set_seed, arguments.scenes);
    let arranged = SceneSet::arranged(arguments.set_seed, arguments.arranged);
    let generated = [(&set, arguments.scenes), (&arranged, arguments.arranged)]
        .into_iter()
        .flat_map(|(set, count)| (arguments.from..count).map(move |index| Source::Generated(set, index)));
    let sources: Vec<Source> = arguments.cases.iter().cloned().map(Source::Folder).chain(generated).collect();
    if let Some(folder) = &arguments.write {
        return write(&sources, arguments.prior, folder, arguments.threads);
    }
    let run = |source: &Source| {
        let scene = match source {
            Source::Folder(path) => BenchScene::read(path)?,
            Source::Generated(set, index) => BenchScene::of_cluttered(&set.scene(*index)?, arguments.prior)?,
        };
        scene.run(&arguments.options, arguments.snap)
    };
    let count = sources.len();
    let records = parallel_map(arguments.threads, &sources, run, |done| {
        eprint!("\r{done} of {count} scenes {}", if done == count { "\n" } else { "" });
    });
    let records = records.map_err(|error: Error| Failure::Failed(error.to_string()))?;
    if arguments.objects {
        records.iter().for_each(print_objects);
    }
    println!("{}", table(&records));
    if let Some(path) = &arguments.json {
        let text = serde_json::to_string(&records).map_err(|error| Failure::Failed(error.to_string()))?;
        std::fs::write(path, text).map_err(|error| Failure::Failed(error.to_string()))?;
    }
    Ok(())
}

/// Writes the generated scenes as `folder`/SCENE, from 000; the arranged ones after the others.
fn write(sources: &[Source], prior: Prior, folder: &Path, threads: usize) -> Result<(), Failure> {
    let numbered: Vec<_> = sources.iter().enumerate().collect();
    let write = |(number, source): &(usize, &Source)| match source {
        Source::Folder(_) => Ok(()),
        Source::Generated(set, index) => set.scene(*index)?.write(prior, &folder.join(format!("{number:03}"))),
    };
    let written = parallel_map(threads, &numbered, write, |_| {});
    written.map(drop).map_err(|error: Error| Failure::Failed(error.to_string()))
}

fn print_objects(scene: &SceneRecord) {
    println!("{}: support {:?}, errors {:?}", scene.name, scene.support, scene.plane_errors);
    for object in &scene.objects {
        let text = |outcome: &sim3align_lab::bench::scene_bench::Outcome| match (&outcome.errors, &outcome.error) {
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
