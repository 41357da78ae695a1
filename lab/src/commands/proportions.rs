//! `proportions`: aligns meshes whose proportions are wrong by a known amount, and prints how far they are put right.

use sim3align::precise::options::Proportions;
use sim3align_lab::bench::option_text;
use sim3align_lab::bench::proportions::{Record, record_of_views, records, table};
use sim3align_lab::parallel::parallel_map;
use sim3align_lab::prelude::*;
use sim3align_lab::sequences::rig::RigSet;

use super::pictures::Pictures;
use super::{Arguments, Command, Failure, print_progress, usage};

pub const COMMAND: Command = Command {
    name: "proportions",
    about: "aligns meshes of wrong proportions, and prints how far they are put right",
    usage: "\
Usage: sim3align-lab proportions [--generated N] [--cases DIR...] [--scenes DIR...] [options]

Stretches each mesh by a known amount along its axes, aligns it, and prints the errors of its lengths in metres, as they
are and in the proportions found.

  --generated N      cases 0 to N − 1 of the generated set, with exact depth
  --cluttered N      N generated scenes of two to four objects on a table
  --cases DIR...     case folders, or folders of case folders
  --scenes DIR...    scene folders, or folders of scene folders
  --rigs N           N generated rigs of two to eight cameras with known poses, all views together
  --freedom F        axes (default) or full
  --stretch E        largest logarithm of a stretch, default 0.06
  --quality Q        of `align`
  --set-seed S       seed of the generated sets and of the stretches, default 0
  --threads N        default: all
  --help             this text",
    run,
};

fn run(arguments: &mut Arguments) -> Result<(), Failure> {
    let pictures = Pictures::of(arguments)?;
    let freedom = match arguments.value("freedom", "axes".to_owned())?.as_str() {
        "axes" => Proportions::Axes,
        "full" => Proportions::Full,
        other => return Err(usage(format!("--freedom {other:?}: axes or full is expected"))),
    };
    let most: f64 = arguments.value("stretch", 0.06)?;
    let options = option_text::with_quality(arguments.optional("quality")?).map_err(usage)?;
    let options = AlignOptions { proportions: freedom, metrics: false, ..options };
    let threads = arguments.threads("threads")?;
    let rigs: Vec<usize> = (0..arguments.value("rigs", 0)?).collect();
    arguments.end()?;
    let pictures = if rigs.is_empty() { pictures.some()? } else { pictures };
    let set = RigSet { seed: pictures.seed, views: None, is_printed: false, is_small: false };
    let of_rig = |index: &usize| record_of_views(&set.case(*index)?, pictures.seed, most, freedom);
    let of_views = parallel_map(threads, &rigs, of_rig, |done| print_progress(done, rigs.len()))?;
    let records = parallel_map(
        threads,
        &pictures.sources,
        |source| records(&pictures.picture(source)?, pictures.seed, most, &options),
        |done| print_progress(done, pictures.sources.len()),
    )?;
    let records: Vec<Record> = records.into_iter().flatten().chain(of_views.into_iter().flatten()).collect();
    println!("{} objects\n\n{}", records.len(), table(&records));
    Ok(())
}
