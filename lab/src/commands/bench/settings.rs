//! Command line of `bench`.

use sim3align::align::method;
use sim3align::options::{Choice, Options};
use sim3align::precise::searched::recipe::SearchSettings;
use sim3align::report::{Effort, Preset};
use sim3align_lab::baselines::Baseline;
use sim3align_lab::bench::benchmark::override_setting;
use sim3align_lab::bench::option_text;
use sim3align_lab::bench::records::RecordKey;
use sim3align_lab::cases::case::CASES;
use sim3align_lab::cases::surplus::Surplus;
use sim3align_lab::cases::tier::{CaseSet, Class, Tier};
use sim3align_lab::prelude::*;
use sim3align_lab::scenes::Prior;

use super::super::{Arguments, Failure, usage};

pub const USAGE: &str = "\
Usage: sim3align-lab bench [--generated N] [--scenes N] [--cases DIR...] [options]

Aligns cases with a known truth and prints Markdown tables: success, errors, metrics, what
warnings come with, failures.

Cases
  --generated N      cases 0 to N − 1 of the generated set; 240 where no --cases or --scenes is given either
  --misfits N        cases 0 to N − 1 with the mesh of the next case: no pose is right
  --scenes N         all pairs of a set of N cluttered scenes; 100 scenes are 338 pairs
  --prior P          what made the meshes of the scenes: detailed (default), smooth or both
  --set SET          the generated set: general (default); sensors, with effects of depth sensors and predicted
                     masks; colors, with photos and coloured meshes; or dilated, the general set with masks that are too
                     large or too small all around and with exact edges of depth; monocular runs the command of that
                     name instead, with its options and tables
  --set-seed S       seed of the generated set and of the scenes, default 0
  --meshes DIR       show the GLB files of a folder in a third of the generated cases
  --cases DIR...     case folders, or folders of case folders
  --surplus KIND     add parts to the generated meshes that are not of the object: floaters, shell, plate, fused-plate
  --no-color         leave out photos and the colours of meshes
  --tier T,…         only these: easy, medium, hard
  --class C,…        only these: plain, occluded, border-cut, tiny, thin, missing-part, extra-part, ragged-mask,
                     warped, sparse-sensor, ambiguous; of the set sensors: wide-shadow, holes, mask-of-readings,
                     split-mask, quantised, predicted-mask, active-stereo, structured-light, time-of-flight,
                     predicted-depth, network-mask, annotated-mask; of the set colors: printed, blotted, printed-shape,
                     one-color, wrong-colors, grey-photo
  --only I,…         only these indices of the generated set (--generated is not needed)

Method
  --preset P         same as --option preset=P
  --seed N           same as --option seed=N
  --option K=V       an option of align() by its JavaScript name; null, and min,max for guard; may be repeated
  --row 'NAME: K=V K=V…'
                     one more row of the tables, with these options on top of the others; may be repeated;
                     method=M is another method: fgr, gicp, icp-point-to-plane, icp-point-to-point, ransac, teaser,
                     quatro; color=false leaves out photos and the colours of meshes; surplus=keep takes all parts
                     of a mesh for the object's
  --import NAME=DIR  one more row: another program's answers, DIR/CASE.json (docs/importing-results.md); may be
                     repeated; without --row these are the only rows

Running
  --threads N        default: all
  --json FILE        everything about every case, for other tables
  --records FILE     the same, added one JSON line at a time; what the file has already is not run again. Instead of
                     tables, prints what is done
  --write DIR        write the cases of the generated set as case folders, and align nothing
  --picture FILE     a PNG of the first case's depth with the outlines of mask, truth and, with --matrix, a pose
  --matrix N,N,…     the pose: camera from mesh, 16 numbers column by column; without it the true pose
  --failures N       failures listed at most a row, default 40
  --help             this text";

/// A set of options that all cases are run with.
#[derive(Clone, Default)]
pub struct Row {
    /// Its name in the tables.
    pub name: String,
    /// The preset that [`Method::Align`] runs.
    pub preset: Preset,
    /// Its options under `precise`.
    pub precise: AlignOptions,
    /// Its options under `paper`, and those of baselines.
    pub paper: PaperOptions,
    pub search: Vec<(String, f64)>,
    pub method: Method,
    /// Whether photos and the colours of meshes are left out.
    pub is_shape_alone: bool,
    /// Whether surplus parts of the mesh count as the object's.
    pub keeps_surplus: bool,
    /// All assignments, as written.
    pub assignments: Vec<String>,
}

/// The method that computes the poses of a row.
#[derive(Clone, Default)]
pub enum Method {
    /// `align`.
    #[default]
    Align,
    /// Another method of this crate.
    Baseline(Baseline),
    /// Another program; the folder holds its results.
    Import(PathBuf),
}

impl Row {
    /// The preset with its options.
    pub fn preset_options(&self) -> method::Method {
        match self.preset {
            Preset::Precise => self.precise.clone().into(),
            Preset::Paper => self.paper.clone().into(),
        }
    }

    /// Whether a baseline keeps the initial scale: the paper's method does by default, TEASER only where it is asked to.
    pub fn locks_scale(&self) -> bool {
        self.assignments.iter().any(|assignment| assignment == "lockScale=true")
    }

    /// The key of a record of this row.
    pub fn key(&self, case: String) -> RecordKey {
        RecordKey { row: self.name.clone(), options: self.assignments.join(" "), case }
    }
}

/// The parsed command line.
pub struct Settings {
    pub generated: usize,
    pub misfits: usize,
    pub scenes: usize,
    pub priors: Vec<Prior>,
    pub set: CaseSet,
    pub set_seed: u64,
    pub meshes: Option<PathBuf>,
    pub cases: Vec<PathBuf>,
    pub surplus: Option<Surplus>,
    pub color: bool,
    pub tiers: Option<Vec<Tier>>,
    pub classes: Option<Vec<Class>>,
    pub only: Option<Vec<usize>>,
    pub rows: Vec<Row>,
    pub threads: usize,
    pub json: Option<PathBuf>,
    pub records: Option<PathBuf>,
    pub write: Option<PathBuf>,
    pub picture: Option<PathBuf>,
    pub matrix: Option<Vec<f64>>,
    pub failures: usize,
}

impl Settings {
    pub fn parse(arguments: &mut Arguments) -> Result<Self, Failure> {
        let generated = arguments.optional("generated")?;
        let mut settings = Self {
            generated: 0,
            misfits: arguments.value("misfits", 0)?,
            scenes: arguments.value("scenes", 0)?,
            priors: Prior::several(&arguments.value("prior", Prior::Detailed.as_str().to_owned())?).map_err(usage)?,
            set: arguments.value("set", CaseSet::General)?,
            set_seed: arguments.value("set-seed", 0)?,
            meshes: arguments.optional("meshes")?,
            cases: arguments.paths("cases")?,
            surplus: arguments.optional("surplus")?,
            color: !arguments.flag("no-color"),
            tiers: arguments.list("tier")?,
            classes: arguments.list("class")?,
            only: arguments.list("only")?,
            rows: rows(arguments)?,
            threads: arguments.threads("threads")?,
            json: arguments.optional("json")?,
            records: arguments.optional("records")?,
            write: arguments.optional("write")?,
            picture: arguments.optional("picture")?,
            matrix: arguments.list("matrix")?,
            failures: arguments.value("failures", 40)?,
        };
        arguments.end()?;
        let anything_else =
            !settings.cases.is_empty() || settings.only.is_some() || settings.scenes + settings.misfits > 0;
        settings.generated = generated.unwrap_or(if anything_else { 0 } else { CASES });
        Ok(settings)
    }
}

/// The rows of the tables: those of `--row` and of `--import`; without any, one with the common options.
fn rows(arguments: &mut Arguments) -> Result<Vec<Row>, Failure> {
    let mut base = Row::default();
    for name in ["preset", "seed"] {
        for value in arguments.all(name)? {
            assign(&mut base, &format!("{name}={value}")).map_err(usage)?;
        }
    }
    for assignment in arguments.all("option")? {
        assign(&mut base, &assignment).map_err(usage)?;
    }
    let mut rows = Vec::new();
    for text in arguments.all("row")? {
        let (name, assignments) = text.split_once(':').ok_or_else(|| usage("--row without a colon after its name"))?;
        let mut row = Row { name: name.trim().into(), ..base.clone() };
        for assignment in assignments.split_whitespace() {
            assign(&mut row, assignment).map_err(usage)?;
        }
        rows.push(row);
    }
    for text in arguments.all("import")? {
        let (name, folder) = text.split_once('=').ok_or_else(|| usage("--import without NAME= before its folder"))?;
        if !Path::new(folder).is_dir() {
            return Err(usage(format!("--import {text}: found no folder {folder}")));
        }
        rows.push(Row { name: name.into(), method: Method::Import(folder.into()), ..Row::default() });
    }
    if rows.is_empty() {
        let name = match &base.method {
            Method::Baseline(baseline) => baseline.as_str().into(),
            _ => base.preset.as_str().into(),
        };
        rows.push(Row { name, ..base });
    }
    Ok(rows)
}

/// Sets an option from `name=value`, one of the search's settings from `search.name=number`, or the method.
fn assign(row: &mut Row, assignment: &str) -> Result<(), String> {
    let Row { preset, precise, paper, search, method, is_shape_alone, keeps_surplus, assignments, .. } = row;
    assignments.push(assignment.to_owned());
    let (name, value) = assignment.split_once('=').ok_or_else(|| format!("{assignment:?} is no NAME=VALUE"))?;
    if name == "method" {
        let unknown = |_| format!("no method {value}; there are {}", Baseline::names().join(", "));
        *method = Method::Baseline(Baseline::from_name(value).map_err(unknown)?);
        return Ok(());
    }
    if name == "color" {
        let color: bool = value.parse().map_err(|_| format!("color: found {value:?}, expected true or false"))?;
        *is_shape_alone = !color;
        return Ok(());
    }
    if name == "surplus" {
        *keeps_surplus = match value {
            "keep" => true,
            "leave-out" => false,
            _ => return Err(format!("surplus: found {value:?}, expected keep or leave-out")),
        };
        return Ok(());
    }
    if let Some(setting) = name.strip_prefix("search.") {
        let value = value.parse().map_err(|_| format!("{name}: found {value:?}, expected a number"))?;
        if !override_setting(&mut SearchSettings::from(Effort::default()), setting, value) {
            return Err(format!("the search has no setting {setting}"));
        }
        search.push((setting.to_owned(), value));
        return Ok(());
    }
    if name == "preset" {
        return if preset.set(value) { Ok(()) } else { Err(format!("no preset {value}; there are precise and paper")) };
    }
    // An option that both presets have is set for both, so that rows of either can build on it.
    let set = [option_text::assign(precise, name, value), option_text::assign(paper, name, value)];
    let known = || [AlignOptions::names(), PaperOptions::names()].concat().join(", ");
    set.into_iter().flatten().reduce(Result::and).ok_or_else(|| format!("no option {name}; there are {}", known()))?
}
