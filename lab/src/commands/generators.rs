//! `generators`: compares where generators put their meshes with where alignments put them.

use sim3align_lab::bench::case_line::CaseLine;
use sim3align_lab::bench::generators::{PlacedScene, ROWS, Record, table};
use sim3align_lab::bench::option_text;
use sim3align_lab::bench::scene_bench::BenchScene;
use sim3align_lab::files::listed;
use sim3align_lab::parallel::parallel_map;
use sim3align_lab::prelude::*;
use sim3align_lab::scenes::{Prior, SceneSet};

use super::{Arguments, Command, Failure, print_progress, usage, write_lines};

pub const COMMAND: Command = Command {
    name: "generators",
    about: "compares the layout of generated meshes with their alignment, and prints a table",
    usage: "\
Usage: sim3align-lab generators [--cases DIR...] [--scenes N] [options]

Aligns the objects of scenes, and prints a table of the errors of their poses and of their layout: as the generator put
them, after point-to-point ICP from there, and aligned: each alone and all together, without and with the generator's
placement as `initial`, and alone with an up direction that is 5° off; and how the aligned mesh in the proportions found
agrees with the image. Objects without gt.json are left out.

  --cases DIR...     scene folders, or folders of scene folders; objects/NAME/initial.json (or sam3d.json) is the placement:
                     scale, rotation as three rows, translation in metres, OpenCV camera from mesh
  --scenes N         N generated cluttered scenes, with placements that are off as those of SAM 3D Objects are
  --prior P          what made their meshes: detailed (default) or smooth
  --set-seed S       seed of the set, default 0
  --objects          prints every object
  --quality Q        of `align`
  --json FILE        keeps the errors of every object
  --threads N        default: all
  --help             this text",
    run,
};

/// The source of a scene.
enum Source<'a> {
    Folder(PathBuf),
    Generated(&'a SceneSet, usize),
}

fn run(arguments: &mut Arguments) -> Result<(), Failure> {
    let scenes: usize = arguments.value("scenes", 0)?;
    let (set_seed, prior) = (arguments.value("set-seed", 0)?, arguments.value("prior", Prior::Detailed)?);
    let mut sources = Vec::new();
    for path in arguments.paths("cases")? {
        match path.join("objects").is_dir() {
            true => sources.push(Source::Folder(path)),
            false => {
                let folders = listed(&path)?.into_iter().filter(|folder| folder.join("objects").is_dir());
                sources.extend(folders.map(Source::Folder));
            }
        }
    }
    let set = SceneSet::new(set_seed, scenes);
    sources.extend((0..scenes).map(|index| Source::Generated(&set, index)));
    let prints_objects = arguments.flag("objects");
    let options = option_text::with_quality(arguments.optional("quality")?).map_err(usage)?;
    let (json, threads): (Option<PathBuf>, usize) = (arguments.optional("json")?, arguments.threads("threads")?);
    arguments.end()?;
    if sources.is_empty() {
        return Err(usage("--cases with scene folders, or --scenes, is expected"));
    }
    let placed = |source: &Source| match source {
        Source::Folder(folder) => PlacedScene::read(folder),
        Source::Generated(set, index) => {
            let scene = BenchScene::of_cluttered(&set.scene(*index)?, prior)?;
            PlacedScene::simulated(scene, [set_seed, *index as u64])
        }
    };
    let found = parallel_map(
        threads,
        &sources,
        |source| placed(source)?.records(&options),
        |done| {
            print_progress(done, sources.len());
        },
    )?;
    let all: Vec<(String, Record)> = found.into_iter().flatten().collect();
    if prints_objects {
        for (name, record) in &all {
            for (row, evaluation) in ROWS.iter().zip(record).take(ROWS.len() - 1) {
                let Some(errors) = evaluation.as_ref().and_then(|evaluation| evaluation.errors) else { continue };
                let [scale, place] = [errors.scale_error, errors.translation_error_relative].map(|x| 100.0 * x);
                println!(
                    "{name:20} {row:20} size {scale:5.1} % turn {:6.1}° place {place:5.1} %",
                    errors.rotation_error_deg
                );
            }
        }
        println!();
    }
    println!("{} objects\n\n{}", all.len(), table(&all));
    let lines = all.iter().flat_map(|(name, record)| {
        ROWS.iter().zip(record).take(ROWS.len() - 1).map(move |(row, evaluation)| {
            let errors = evaluation.as_ref().and_then(|evaluation| evaluation.errors.as_ref());
            CaseLine::new(row, name.clone(), errors, None, None)
        })
    });
    write_lines(json, lines)
}
