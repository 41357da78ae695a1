//! `outlines`: measures where mask, depth and photo show the outlines of objects.

use sim3align_lab::cases::case::EvaluationSet;
use sim3align_lab::cases::tier::CaseSet;
use sim3align_lab::outlines::{GroupBy, ObjectOutlines, OutlineView, table};
use sim3align_lab::parallel::parallel_map;
use sim3align_lab::prelude::*;

use super::{Arguments, Command, Failure, print_progress, usage};

pub const COMMAND: Command = Command {
    name: "outlines",
    about: "compares the outlines of mask, depth and photo with the true ones, and prints tables",
    usage: "\
Usage: sim3align-lab outlines [--cases DIR...] [--generated N] [options]

Compares the outlines in mask, depth and photo with the outline at the true pose, and prints Markdown tables of their
offsets, of mixed pixels and of the noise of the depth, by group. Real cases are grouped by the part of the folder's name
before the first dash.

  --cases DIR...        case folders, scene folders, folders with frames, or folders of these
  --group 'NAME=A,B…'   one group NAME of the groups A, B…; may be repeated
  --generated N         cases 0 to N − 1 of a generated set
  --set SET             the generated set, see `bench`
  --set-seed S          its seed, default 0
  --by PROPERTY         groups generated cases by class (default), tier, depth or mask
  --objects             prints every object
  --threads N           default: all
  --help                this text",
    run,
};

struct Settings {
    cases: Vec<PathBuf>,
    groups: Vec<(String, Vec<String>)>,
    generated: usize,
    set: CaseSet,
    set_seed: u64,
    by: GroupBy,
    threads: usize,
}

fn run(arguments: &mut Arguments) -> Result<(), Failure> {
    let group = |text: String| {
        let (name, members) = text.split_once('=').ok_or_else(|| usage("--group without = after its name"))?;
        Ok((name.into(), members.split(',').map(str::to_owned).collect()))
    };
    let settings = Settings {
        cases: arguments.paths("cases")?,
        groups: arguments.all("group")?.into_iter().map(group).collect::<Result<_, Failure>>()?,
        generated: arguments.value("generated", 0)?,
        set: arguments.value("set", CaseSet::General)?,
        set_seed: arguments.value("set-seed", 0)?,
        by: arguments.value("by", GroupBy::Class)?,
        threads: arguments.threads("threads")?,
    };
    let prints_objects = arguments.flag("objects");
    arguments.end()?;
    if settings.cases.is_empty() && settings.generated == 0 {
        return Err(usage("--cases or --generated is expected"));
    }
    let objects = measured(&settings)?;
    if prints_objects {
        println!("{}", table::by_object(&objects));
    }
    print!("{}", table::report(&objects));
    Ok(())
}

/// The measured objects, in the order of the arguments, real ones first.
fn measured(settings: &Settings) -> Result<Vec<ObjectOutlines>> {
    let mut real = Vec::new();
    for folder in &settings.cases {
        real.extend(OutlineView::read(folder)?);
    }
    for view in &mut real {
        if let Some((name, _)) = settings.groups.iter().find(|(_, members)| members.contains(&view.group)) {
            view.group.clone_from(name);
        }
    }
    let mut objects = parallel_map(settings.threads, &real, |view| Ok(ObjectOutlines::of(view)), |_| {})?;
    let set = EvaluationSet::new(settings.set_seed).of(settings.set);
    let indices: Vec<usize> = (0..settings.generated).collect();
    let of = |index: &usize| -> Result<Option<ObjectOutlines>> {
        Ok(ObjectOutlines::of(&OutlineView::generated(set.case(*index)?, settings.by)))
    };
    objects.extend(parallel_map(settings.threads, &indices, of, |done| print_progress(done, indices.len()))?);
    let left_out = objects.iter().filter(|object| object.is_none()).count();
    if left_out > 0 {
        eprintln!("{left_out} objects whose outlines show too little");
    }
    Ok(objects.into_iter().flatten().collect())
}
