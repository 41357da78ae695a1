//! `outlines`: measures where mask, depth and photo show the outlines of objects.

use lexopt::prelude::*;
use sim3align_geometry::error::Result as GeometryResult;
use sim3align_lab::cases::case::EvaluationSet;
use sim3align_lab::cases::tier::CaseSet;
use sim3align_lab::outlines::{GroupBy, ObjectOutlines, OutlineView, table};
use sim3align_lab::parallel::parallel_map;

use super::{Failure, parsed};
use sim3align_lab::prelude::*;

const USAGE: &str = "\
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
  --help                this text";

struct Arguments {
    cases: Vec<PathBuf>,
    groups: Vec<(String, Vec<String>)>,
    generated: usize,
    set: CaseSet,
    set_seed: u64,
    by: GroupBy,
    objects: bool,
    threads: usize,
}

/// `None` if help is requested.
fn parse(mut parser: lexopt::Parser) -> Result<Option<Arguments>, lexopt::Error> {
    let mut arguments = Arguments {
        cases: Vec::new(),
        groups: Vec::new(),
        generated: 0,
        set: CaseSet::General,
        set_seed: 0,
        by: GroupBy::Class,
        objects: false,
        threads: std::thread::available_parallelism().map_or(1, usize::from),
    };
    while let Some(argument) = parser.next()? {
        match argument {
            Long("help") | Short('h') => return Ok(None),
            Long("cases") => arguments.cases.extend(parser.values()?.map(PathBuf::from)),
            Long("group") => {
                let text = parser.value()?.string()?;
                let (name, members) = text.split_once('=').ok_or("--group without = after its name")?;
                arguments.groups.push((name.into(), members.split(',').map(str::to_owned).collect()));
            }
            Long("generated") => arguments.generated = parser.value()?.parse()?,
            Long("set") => {
                let name = parser.value()?.string()?;
                arguments.set = CaseSet::from_name(&name).map_err(|error: Error| error.to_string())?;
            }
            Long("set-seed") => arguments.set_seed = parser.value()?.parse()?,
            Long("by") => {
                let name = parser.value()?.string()?;
                arguments.by = GroupBy::from_name(&name).ok_or("--by: class, tier, depth or mask is expected")?;
            }
            Long("objects") => arguments.objects = true,
            Long("threads") => arguments.threads = parser.value()?.parse()?,
            _ => return Err(argument.unexpected()),
        }
    }
    if arguments.cases.is_empty() && arguments.generated == 0 {
        return Err("--cases or --generated is expected".into());
    }
    Ok(Some(arguments))
}

/// Runs the command.
pub fn main(parser: lexopt::Parser) -> Result<(), Failure> {
    let arguments = parsed(parser, parse, USAGE)?;
    let objects = measured(&arguments).map_err(|error| Failure::Failed(error.to_string()))?;
    if arguments.objects {
        println!("{}", table::by_object(&objects));
    }
    print!("{}", table::report(&objects));
    Ok(())
}

/// The measured objects, in the order of the arguments, real ones first.
fn measured(arguments: &Arguments) -> GeometryResult<Vec<ObjectOutlines>> {
    let mut real = Vec::new();
    for folder in &arguments.cases {
        real.extend(OutlineView::read(folder)?);
    }
    for view in &mut real {
        if let Some((name, _)) = arguments.groups.iter().find(|(_, members)| members.contains(&view.group)) {
            view.group.clone_from(name);
        }
    }
    let mut objects = parallel_map(arguments.threads, &real, |view| Ok(ObjectOutlines::of(view)), |_| {})?;
    let set = EvaluationSet::new(arguments.set_seed).of(arguments.set);
    let indices: Vec<usize> = (0..arguments.generated).collect();
    let of = |index: &usize| -> GeometryResult<Option<ObjectOutlines>> {
        Ok(ObjectOutlines::of(&OutlineView::generated(set.case(*index)?, arguments.by)))
    };
    objects.extend(parallel_map(arguments.threads, &indices, of, |done| {
        if done.is_multiple_of(10) || done == indices.len() {
            eprint!("\r{done} of {} ", indices.len());
        }
    })?);
    let left_out = objects.iter().filter(|object| object.is_none()).count();
    if left_out > 0 {
        eprintln!("{left_out} objects whose outlines show too little");
    }
    Ok(objects.into_iter().flatten().collect())
}
