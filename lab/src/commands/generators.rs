//! `generators`: compares where generators put their meshes with where alignments put them.

use sim3align_lab::bench::generators::{ROWS, Record, records, table};
use sim3align_lab::bench::option_text;
use sim3align_lab::files::listed;
use sim3align_lab::parallel::parallel_map;
use sim3align_lab::prelude::*;

use super::{Arguments, Command, Failure, print_progress, usage};

pub const COMMAND: Command = Command {
    name: "generators",
    about: "compares the layout of generated meshes with their alignment, and prints a table",
    usage: "\
Usage: sim3align-lab generators --cases DIR... [options]

Aligns the objects of scene folders, each alone, and prints a table of the errors of their poses and of their layout: as
the generator put them (objects/NAME/sam3d.json: scale, rotation as three rows, translation in metres, OpenCV camera from
mesh), after point-to-point ICP from there, and aligned; and how the aligned mesh in the proportions found agrees with the
image. Objects without gt.json are left out.

  --cases DIR...     scene folders, or folders of scene folders
  --objects          prints every object
  --quality Q        of `align`
  --threads N        default: all
  --help             this text",
    run,
};

fn run(arguments: &mut Arguments) -> Result<(), Failure> {
    let mut folders = Vec::new();
    for path in arguments.paths("cases")? {
        match path.join("objects").is_dir() {
            true => folders.push(path),
            false => folders.extend(listed(&path)?.into_iter().filter(|folder| folder.join("objects").is_dir())),
        }
    }
    let prints_objects = arguments.flag("objects");
    let options = option_text::with_quality(arguments.optional("quality")?).map_err(usage)?;
    let threads = arguments.threads("threads")?;
    arguments.end()?;
    if folders.is_empty() {
        return Err(usage("--cases with scene folders is expected"));
    }
    let found = parallel_map(
        threads,
        &folders,
        |folder| records(folder, &options),
        |done| {
            print_progress(done, folders.len());
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
    Ok(())
}
