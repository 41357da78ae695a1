//! TypeScript's options, results, codes and table of options are generated from the Rust declarations.
//! `UPDATE=1 cargo test --package sim3align-lab typescript` writes the files after a change.

use std::collections::BTreeMap;
use std::fmt::{Display, Write};
use std::ops::RangeInclusive;
use std::path::Path;

use serde_json::json;
use sim3align::align::evaluate::{EvaluateOptions, Evaluation, EvaluationDiagnostics};
use sim3align::calibrate::calibration::{CalibrationUncertainty, DepthCalibration};
use sim3align::metrics::Metrics;
use sim3align::metrics::pose_error::PoseErrors;
use sim3align::metrics::symmetry::Symmetry;
use sim3align::options::scale::ScaleOption;
use sim3align::options::{Field, Options};
use sim3align::paper::options::{GuardMode, PaperOptions};
use sim3align::precise::options::*;
use sim3align::progress::Stage;
use sim3align::register::options::{EstimateSim3Options, Icp, RegisterOptions};
use sim3align::register::report::*;
use sim3align::report::*;
use sim3align::scene::contact::Contact;
use sim3align::track::TrackOptions;
use sim3align::track::report::*;
use sim3align::views::ViewsOptions;
use sim3align::views::report::*;
use sim3align_runtime::error::ErrorCode;
use ts_rs::{Config, TS};

const HEADER: &str = "// Generated from the Rust declarations by lab/tests/suite/typescript.rs; not to be edited.\n\n";

/// The longest line of the package.
const LINE_WIDTH: usize = 120;

/// An option.
struct Row {
    name: String,
    /// Its comment and its declaration in an interface.
    member: String,
    /// Its entry in the table of options: name, kind and the rest.
    properties: Vec<String>,
}

/// A call whose options are a table.
struct Call {
    /// Its name in the table of options.
    key: &'static str,
    /// The name of its options' type.
    interface: &'static str,
    doc: &'static str,
    /// The declaration of the preset that its options name.
    preset: &'static str,
    rows: Vec<Row>,
}

fn call<T: Options>(key: &'static str, interface: &'static str, preset: &'static str) -> Call {
    let mut options = T::default();
    let rows = options.named_fields().into_iter().zip(T::DOCS).map(|((name, field), doc)| row(&name, doc, &field));
    Call { key, interface, doc: T::DOC, preset, rows: rows.collect() }
}

fn calls() -> [Call; 7] {
    let precise = "  /** The default method: search by rendering. */\n  preset?: \"precise\" | undefined;\n";
    [
        call::<AlignOptions>("align", "AlignOptions", precise),
        call::<PaperOptions>("paper", "PaperOptions", "  /** The paper's method. */\n  preset: \"paper\";\n"),
        call::<ViewsOptions>("alignViews", "ViewsOptions", ""),
        call::<TrackOptions>("track", "TrackOptions", ""),
        call::<EvaluateOptions>("evaluate", "EvaluateOptions", ""),
        call::<RegisterOptions>("register", "RegisterOptions", ""),
        call::<EstimateSim3Options>("estimateSim3", "EstimateSim3Options", ""),
    ]
}

fn between<T: Display>(range: &RangeInclusive<T>) -> Vec<String> {
    vec![format!("min: {}", range.start()), format!("max: {}", range.end())]
}

fn row(name: &str, doc: &str, field: &Field<'_>) -> Row {
    let (kind, ts, limits, default) = match field {
        Field::Count(value, range) => ("integer", "number", between(range), json!(value)),
        Field::Number(value, range) => ("number", "number", between(range), json!(value)),
        Field::OptionalNumber(value, range) => ("number", "number | null", between(range), json!(value)),
        Field::Positive(value) => ("number", "number | null", vec!["above: 0".into()], json!(value)),
        Field::Flag(value) => ("boolean", "boolean", vec![], json!(value)),
        Field::Scale(ScaleOption::Free) => ("scale", "ScaleOption", vec![], json!("free")),
        Field::Direction(value) => ("direction", "Direction | null", vec![], json!(value)),
        Field::Symmetry(Symmetry::Auto) => ("symmetry", "SymmetryOption", vec![], json!("auto")),
        Field::Transform(None) => ("transform", "Sim3Like | null", vec![], json!(null)),
        Field::Guard(value) => ("guard", "readonly [min: number, max: number] | null", vec![], json!(value)),
        Field::Choice(choice) => {
            ("choice", choice.type_name(), vec![format!("choices: {:?}", choice.names())], json!(choice.name()))
        }
        Field::Scale(_) | Field::Symmetry(_) | Field::Transform(_) => panic!("{name}: a default without a name"),
    };
    // JavaScript writes 5, not 5.0.
    let default = default.to_string();
    let default = default.strip_suffix(".0").unwrap_or(&default);
    let range = match kind {
        "integer" | "number" | "guard" => format!("Takes {}. ", field.expected()),
        _ => String::new(),
    };
    let member = comment("  ", &format!("{doc} {range}Default `{default}`."));

    let doc = doc.split_whitespace().collect::<Vec<_>>().join(" ");
    let first_sentence = doc.split_once(". ").map_or(doc.trim_end_matches('.'), |(first, _)| first);
    let mut properties = vec![format!("name: \"{name}\""), format!("kind: \"{kind}\"")];
    properties.extend(limits);
    properties.push(format!("isNullable: {}", ts.ends_with("| null")));
    properties.push(format!("default: {}", default.replace(',', ", ")));
    properties.push(format!("summary: {}", json!(first_sentence)));
    Row { name: name.into(), member: format!("{member}  {name}?: {ts} | undefined;\n"), properties }
}

/// A doc comment, also one that `ts_rs` wrote, in lines of the package's length.
fn comment(indent: &str, doc: &str) -> String {
    let width = LINE_WIDTH - "* */".len() - indent.len() - 1;
    let text: Vec<&str> = doc.lines().map(|line| line.trim_start_matches([' ', '/', '*'])).collect();
    let mut lines = Vec::new();
    for paragraph in text.join("\n").trim().split("\n\n") {
        let mut line = String::new();
        for word in paragraph.split_whitespace() {
            if line.chars().count() + word.chars().count() > width {
                lines.push(std::mem::take(&mut line));
            }
            line += &format!(" {word}");
        }
        lines.extend([line, String::new()]);
    }
    lines.pop();
    match &lines[..] {
        [line] if indent.len() + "/** */".len() + line.chars().count() < LINE_WIDTH => {
            format!("{indent}/**{line} */\n")
        }
        _ => format!("{indent}/**\n{indent} *{}\n{indent} */\n", lines.join(&format!("\n{indent} *"))),
    }
}

/// Options as interfaces. An interface picks what earlier ones have as well.
fn interfaces() -> String {
    let mut code = String::new();
    let calls = calls();
    for (i, Call { interface, doc, preset, rows, .. }) in calls.iter().enumerate() {
        let mut own: Vec<&Row> = rows.iter().collect();
        let mut bases = Vec::new();
        for base in &calls[..i] {
            let is_shared = |row: &&Row| base.rows.iter().any(|other| other.member == row.member);
            let (shared, others): (Vec<&Row>, Vec<&Row>) = own.into_iter().partition(is_shared);
            let names: Vec<String> = shared.iter().map(|row| format!("\"{}\"", row.name)).collect();
            if !names.is_empty() {
                bases.push(format!("Pick<{}, {}>", base.interface, names.join(" | ")));
            }
            own = others;
        }
        let mut extends = if bases.is_empty() { String::new() } else { format!(" extends {}", bases.join(", ")) };
        if "export interface  {".len() + interface.len() + extends.len() > LINE_WIDTH {
            extends = format!("\n  extends {}", bases.join(",\n    "));
        }
        let own: String = own.iter().map(|row| &*row.member).collect();
        let _ = write!(code, "{}export interface {interface}{extends} {{\n{preset}{own}}}\n\n", comment("", doc));
    }
    code
}

/// The declarations of types, and the members of those that are objects. A type names the earlier ones that have some of its
/// members, and does not repeat these.
#[derive(Default)]
struct Types {
    code: String,
    objects: Vec<(String, Vec<String>)>,
}

impl Types {
    /// A result as an object type, everything else as it is.
    fn add<T: TS>(&mut self) {
        let config = Config::default();
        let mut declaration = T::decl(&config);
        if let Some(body) = declaration.split_once("= { \n").and_then(|(_, body)| body.strip_suffix(", };")) {
            let member = |part: &str| {
                let (doc, code) = part.split_once("*/\n").unwrap();
                format!("{}  {code};\n", comment("  ", doc))
            };
            let all: Vec<String> = body.split(", \n").map(member).collect();
            let mut own = all.clone();
            declaration = format!("type {} = ", T::name(&config));
            for (base, theirs) in self.objects.iter().rev() {
                if theirs.iter().all(|member| own.contains(member)) {
                    declaration += &format!("{base} & ");
                    own.retain(|member| !theirs.contains(member));
                }
            }
            declaration += &format!("{{\n{}}};", own.concat());
            self.objects.push((T::name(&config), all));
        }
        let doc = T::docs().map(|doc| comment("", &doc)).unwrap_or_default();
        let _ = write!(self.code, "{doc}export {declaration}\n\n");
    }
}

/// Adds declarations in their order.
macro_rules! add {
    ($types:ident: $($name:ty),* $(,)?) => {
        $($types.add::<$name>();)*
    };
}

fn types() -> String {
    let mut types = Types::default();
    add! { types:
        Preset, ColorVerdict, Quality, Effort, SearchScope, ExtentAxis, Proportions, GuardMode, Icp,
    }
    types.code += &interfaces();
    types.add::<Stage>();
    types.code += "/** Milliseconds per stage, in the order in which the stages first ran, and their total. */\n\
        export type Timings = Partial<Record<Stage, number>> & { total: number };\n\n";
    add! { types:
        ErrorCode, WarningCode, Warning, Sim3, Metrics, PoseErrors, SearchCounts,
        Counts, ScoreTerms, ColorReport, Alternative, FoundSymmetry, Uncertainty, Stretch, EvaluationDiagnostics, Diagnostics,
        PaperDiagnostics, PreciseDiagnostics, PaperAlignment, Alignment, WorldFrame, ViewRole,
        WorldUncertainty, CameraPose, ViewPose, ViewsDiagnostics, ViewsAlignment, TrackState, CorrectedFrame,
        TrackedFrame, Evaluation, Contact, RegistrationDiagnostics, Registration, CalibrationUncertainty,
        DepthCalibration,
    }
    let imports =
        "import type { Direction, ScaleOption, Sim3Like, SymmetryOption } from \"../types/argument-types.js\";\n\n";
    format!("{HEADER}{imports}{}\n", types.code.trim_end())
}

/// The rows of `alignScene`: those of `align` for every object, and what the package does with the scene.
fn scene_rows() -> Vec<Row> {
    let [align, ..] = calls();
    let snap = "Whether to move each object that touches something along the normal of the support, so that it touches exactly.";
    let snap = row("snap", snap, &Field::Flag(&mut false));
    align.rows.into_iter().filter(|row| row.name != "initial").chain([snap]).collect()
}

fn options() -> String {
    let mut tables: Vec<(&str, Vec<Row>)> = calls().into_iter().map(|call| (call.key, call.rows)).collect();
    tables.insert(2, ("alignScene", scene_rows()));
    let all: Vec<&Row> = tables.iter().flat_map(|(_, rows)| rows).collect();
    // Options of the same name and kind that several calls have, each as the first of them has it.
    let mut shared = BTreeMap::new();
    for row in &all {
        if all.iter().filter(|other| other.properties[..2] == row.properties[..2]).count() > 1 {
            shared.entry(&*row.name).or_insert(&row.properties);
        }
    }
    let constant = |(name, own): (&&str, &&Vec<String>)| format!("const {name} = {{ {} }} as const;\n", own.join(", "));
    let constants: String = shared.iter().map(constant).collect();
    // A row itself, or what differs from the shared one.
    let entry = |row: &Row| {
        let Some(first) = shared.get(&*row.name) else { return format!("{{ {} }}", row.properties.join(", ")) };
        let other = row.properties.iter().filter(|property| !first.contains(property));
        let other: String = other.map(|property| format!(", {property}")).collect();
        if other.is_empty() { row.name.clone() } else { format!("{{ ...{}{other} }}", row.name) }
    };
    let table = |(key, rows): &(&str, Vec<Row>)| {
        let rows: String = rows.iter().map(|row| format!("    {},\n", entry(row))).collect();
        format!("  {key}: [\n{rows}  ],\n")
    };
    // A call, because bundlers keep an unused object with spreads.
    format!(
        "{HEADER}import type {{ OptionRow }} from \"../types/options.js\";\n\n{constants}\n\
         /** Every option of every call, with its kind, range, default and a one-line description. */\n\
         export const OPTIONS: Readonly<Record<{}, readonly OptionRow[]>> = /* @__PURE__ */ (() => ({{\n{}}}))();\n",
        tables.iter().map(|(key, _)| format!("\"{key}\"")).collect::<Vec<_>>().join(" | "),
        tables.iter().map(table).collect::<String>(),
    )
}

#[test]
fn generated_files_are_those_of_the_rust_declarations() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../pkg-config/src/generated");
    for (file, generated) in [("types.ts", types()), ("options.ts", options())] {
        let path = folder.join(file);
        if std::env::var_os("UPDATE").is_some() {
            std::fs::create_dir_all(&folder).unwrap();
            std::fs::write(&path, &generated).unwrap();
        }
        let committed = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(committed == generated, "{} is out of date: run this test with UPDATE=1", path.display());
    }
}
