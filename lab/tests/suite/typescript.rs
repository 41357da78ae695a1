//! TypeScript's options, results, codes and table of options are generated from the Rust declarations.
//! `UPDATE=1 cargo test --package sim3align-lab typescript` writes the files after a change.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use serde_json::{Value, json};
use sim3align::align::evaluate::{EvaluateOptions, Evaluation, EvaluationDiagnostics};
use sim3align::calibrate::calibration::{CalibrationUncertainty, DepthCalibration};
use sim3align::metrics::Metrics;
use sim3align::metrics::pose_error::PoseErrors;
use sim3align::metrics::symmetry::Symmetry;
use sim3align::options::scale::ScaleOption;
use sim3align::options::{Field, Options};
use sim3align::paper::options::{GuardMode, PaperOptions};
use sim3align::precise::options::{AlignOptions, ExtentAxis, Proportions, Quality, SearchScope};
use sim3align::progress::Stage;
use sim3align::register::options::{EstimateSim3Options, Icp, RegisterOptions};
use sim3align::register::report::{Registration, RegistrationDiagnostics};
use sim3align::report::{
    Alignment, Alternative, ColorReport, ColorVerdict, Counts, Diagnostics, Effort, PaperAlignment, PaperDiagnostics,
    PreciseDiagnostics, Preset, ScoreTerms, SearchCounts, Sim3, Stretch, Uncertainty, Warning, WarningCode,
};
use sim3align::scene::contact::Contact;
use sim3align::track::TrackOptions;
use sim3align::track::report::{CorrectedFrame, TrackState, TrackedFrame};
use sim3align::views::ViewsOptions;
use sim3align::views::report::{
    CameraPose, ViewPose, ViewRole, ViewsAlignment, ViewsDiagnostics, WorldFrame, WorldUncertainty,
};
use sim3align_runtime::error::ErrorCode;
use ts_rs::{Config, TS};

const HEADER: &str = "// Generated from the Rust declarations by lab/tests/suite/typescript.rs; not to be edited.\n\n";

/// The longest line of the package.
const LINE_WIDTH: usize = 120;

/// An option, as the tables of both packages have it.
struct Row {
    name: String,
    doc: String,
    /// The name of the kind in the table of options.
    kind: &'static str,
    /// The type in TypeScript.
    ts: String,
    /// The range, in words; empty where the type says it all.
    range: String,
    /// The rest of the entry: least and most value, choices.
    limits: Vec<(&'static str, Value)>,
    default: Value,
}

/// A call whose options are a table.
struct Call {
    /// Its name in the table of options.
    key: &'static str,
    /// The name of its options' type.
    interface: &'static str,
    doc: &'static str,
    /// The preset that its options name.
    preset: Option<&'static str>,
    rows: Vec<Row>,
}

fn call<T: Options>(key: &'static str, interface: &'static str, preset: Option<&'static str>) -> Call {
    let mut options = T::default();
    let docs: Vec<String> = T::FIELDS.iter().map(|(_, doc)| text(doc)).collect();
    let rows =
        options.named_fields().iter().zip(docs).map(|((name, field), doc)| row(name.clone(), doc, field)).collect();
    Call { key, interface, doc: T::DOC, preset, rows }
}

fn calls() -> [Call; 7] {
    [
        call::<AlignOptions>("align", "AlignOptions", Some("precise")),
        call::<PaperOptions>("paper", "PaperOptions", Some("paper")),
        call::<ViewsOptions>("alignViews", "ViewsOptions", None),
        call::<TrackOptions>("track", "TrackOptions", None),
        call::<EvaluateOptions>("evaluate", "EvaluateOptions", None),
        call::<RegisterOptions>("register", "RegisterOptions", None),
        call::<EstimateSim3Options>("estimateSim3", "EstimateSim3Options", None),
    ]
}

fn row(name: String, doc: String, field: &Field<'_>) -> Row {
    let between = |min: Value, max: Value| vec![("min", min), ("max", max)];
    let or_null = |ts: &str| format!("{ts} | null");
    let is_numeric = matches!(
        field,
        Field::Guard(_) | Field::Count(..) | Field::Number(..) | Field::OptionalNumber(..) | Field::Positive(_)
    );
    let (kind, ts, limits, default) = match field {
        Field::Count(value, range) => {
            ("integer", "number".into(), between(json!(range.start()), json!(range.end())), json!(value))
        }
        Field::Number(value, range) => {
            ("number", "number".into(), between(plain(*range.start()), plain(*range.end())), plain(**value))
        }
        Field::OptionalNumber(value, range) => {
            let limits = between(plain(*range.start()), plain(*range.end()));
            ("number", or_null("number"), limits, json!(value.map(plain)))
        }
        Field::Positive(value) => ("number", or_null("number"), vec![("above", json!(0))], json!(value.map(plain))),
        Field::Flag(value) => ("boolean", "boolean".into(), vec![], json!(value)),
        Field::Scale(value) => {
            assert_eq!(**value, ScaleOption::Free);
            ("scale", "ScaleOption".into(), vec![], json!("free"))
        }
        Field::Direction(value) => ("direction", or_null("Direction"), vec![], json!(value)),
        Field::Symmetry(value) => {
            let name = if **value == Symmetry::None { "none" } else { "auto" };
            ("symmetry", "SymmetryOption".into(), vec![], json!(name))
        }
        Field::Transform(value) => {
            assert!(value.is_none());
            ("transform", or_null("Sim3Like"), vec![], Value::Null)
        }
        Field::Guard(value) => {
            let bounds = value.map(|bounds| bounds.map(plain));
            ("guard", or_null("readonly [min: number, max: number]"), vec![], json!(bounds))
        }
        Field::Choice(choice) => {
            ("choice", choice.type_name().into(), vec![("choices", json!(choice.names()))], json!(choice.name()))
        }
    };
    let range = if is_numeric { field.expected() } else { String::new() };
    Row { name, doc, kind, ts, range, limits, default }
}

/// A number as JavaScript writes it: 5, not 5.0.
fn plain(x: f64) -> Value {
    if x.fract() == 0.0 { json!(x as i64) } else { json!(x) }
}

/// A doc comment as one paragraph.
fn text(doc: &str) -> String {
    doc.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The part up to the first full stop that ends a sentence.
fn first_sentence(doc: &str) -> &str {
    doc.split_once(". ").map_or(doc.trim_end_matches('.'), |(first, _)| first)
}

/// A doc comment, in lines of the package's length.
fn comment(indent: &str, doc: &str) -> String {
    let prefix = format!("{indent} * ");
    let mut lines = Vec::new();
    for paragraph in doc.split("\n\n") {
        let mut line = prefix.clone();
        for word in paragraph.split_whitespace() {
            if line.len() > prefix.len() && line.chars().count() + word.chars().count() > LINE_WIDTH - 2 {
                lines.push(std::mem::replace(&mut line, prefix.clone()).trim_end().to_owned());
            }
            line += &format!("{word} ");
        }
        lines.extend([line.trim_end().to_owned(), format!("{indent} *")]);
    }
    lines.pop();
    match &lines[..] {
        [line] if line.chars().count() + "/* */".len() <= LINE_WIDTH => {
            format!("{indent}/**{} */\n", &line[prefix.len() - 1..])
        }
        _ => format!("{indent}/**\n{}\n{indent} */\n", lines.join("\n")),
    }
}

/// The text of a doc comment that `ts_rs` wrote.
fn uncommented(comment: &str) -> String {
    let lines = comment.trim().trim_start_matches("/**").trim_end_matches("*/").trim().lines();
    lines.map(|line| line.trim_start_matches([' ', '*'])).collect::<Vec<_>>().join("\n")
}

/// A property of a type.
#[derive(PartialEq)]
struct Member {
    name: String,
    /// Its comment and its declaration.
    text: String,
}

/// The declarations of a file. A type names the earlier ones that have some of its members, and does not repeat these.
#[derive(Default)]
struct Types {
    declarations: Vec<String>,
    objects: Vec<(String, Vec<Member>)>,
    options: Vec<(String, Vec<Member>)>,
}

impl Types {
    /// A result as an object type, everything else as it is.
    fn add<T: TS>(&mut self) {
        let config = Config::default();
        let doc = T::docs().map(|doc| comment("", &uncommented(&doc))).unwrap_or_default();
        let declaration = T::decl(&config);
        let Some(body) = declaration.split_once("= { \n").and_then(|(_, body)| body.strip_suffix(", };")) else {
            return self.declarations.push(format!("{doc}export {declaration}\n"));
        };
        let name = T::name(&config);
        let mut members = members_of(body);
        let mut code = String::new();
        for (base, theirs) in self.objects.iter().rev() {
            if theirs.iter().all(|member| members.contains(member)) {
                let _ = write!(code, "{base} & ");
                members.retain(|member| !theirs.contains(member));
            }
        }
        let own: String = members.iter().map(|member| &*member.text).collect();
        self.declarations.push(format!("{doc}export type {name} = {code}{{\n{own}}};\n"));
        self.objects.push((name, members_of(body)));
    }

    /// Options as an interface.
    fn add_options(&mut self, call: &Call) {
        let preset = match call.preset {
            Some("precise") => {
                "  /** The default method: search by rendering. */\n  preset?: \"precise\" | undefined;\n"
            }
            Some(_) => "  /** The paper's method. */\n  preset: \"paper\";\n",
            None => "",
        };
        let member = |Row { name, doc, ts, range, default, .. }: &Row| {
            let range = if range.is_empty() { String::new() } else { format!(" Takes {range}.") };
            let comment = comment("  ", &format!("{doc}{range} Default `{default}`."));
            Member { name: name.clone(), text: format!("{comment}  {name}?: {ts} | undefined;\n") }
        };
        let all: Vec<Member> = call.rows.iter().map(member).collect();
        let mut bases = Vec::new();
        let mut inherited: Vec<&Member> = Vec::new();
        for (base, theirs) in &self.options {
            let shared = |member: &&Member| theirs.contains(member) && !inherited.contains(member);
            let taken: Vec<&Member> = all.iter().filter(shared).collect();
            let names: Vec<String> = taken.iter().map(|member| format!("\"{}\"", member.name)).collect();
            inherited.extend(taken);
            if !names.is_empty() {
                bases.push(format!("Pick<{base}, {}>", names.join(" | ")));
            }
        }
        let own: String = all.iter().filter(|member| !inherited.contains(member)).map(|member| &*member.text).collect();
        let mut extends = if bases.is_empty() { String::new() } else { format!(" extends {}", bases.join(", ")) };
        if "export interface  {".len() + call.interface.len() + extends.len() > LINE_WIDTH {
            extends = format!("\n  extends {}", bases.join(",\n    "));
        }
        let doc = comment("", call.doc);
        self.declarations.push(format!("{doc}export interface {}{extends} {{\n{preset}{own}}}\n", call.interface));
        self.options.push((call.interface.to_owned(), all));
    }
}

/// The members in the braces of a type that `ts_rs` declares.
fn members_of(body: &str) -> Vec<Member> {
    let member = |part: &str| {
        let (doc, code) = part.split_once("*/\n").unwrap();
        let (name, ts) = code.split_once(':').unwrap();
        let text = format!("{}  {name}:{ts};\n", comment("  ", &uncommented(doc)));
        Member { name: name.trim_end_matches('?').to_owned(), text }
    };
    body.split(", \n").map(member).collect()
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
    for call in calls() {
        types.add_options(&call);
    }
    types.add::<Stage>();
    types.declarations.push(
        "/** Milliseconds per stage, in the order in which the stages first ran, and their total. */\n\
         export type Timings = Partial<Record<Stage, number>> & { total: number };\n"
            .into(),
    );
    add! { types:
        ErrorCode, WarningCode, Warning, Sim3, Metrics, PoseErrors, SearchCounts,
        Counts, ScoreTerms, ColorReport, Alternative, Uncertainty, Stretch, EvaluationDiagnostics, Diagnostics,
        PaperDiagnostics, PreciseDiagnostics, PaperAlignment, Alignment, WorldFrame, ViewRole,
        WorldUncertainty, CameraPose, ViewPose, ViewsDiagnostics, ViewsAlignment, TrackState, CorrectedFrame,
        TrackedFrame, Evaluation, Contact, RegistrationDiagnostics, Registration, CalibrationUncertainty,
        DepthCalibration,
    }
    let imports =
        "import type { Direction, ScaleOption, Sim3Like, SymmetryOption } from \"../types/argument-types.js\";\n\n";
    HEADER.to_owned() + imports + &types.declarations.join("\n")
}

/// JSON with spaces after its commas.
fn spaced(value: &Value) -> String {
    value.to_string().replace(',', ", ")
}

/// The entry of an option in the table, one property per item.
fn properties(row: &Row) -> Vec<String> {
    let Row { name, doc, kind, ts, limits, default, .. } = row;
    let mut all = vec![format!("name: \"{name}\""), format!("kind: \"{kind}\"")];
    all.extend(limits.iter().map(|(limit, value)| format!("{limit}: {}", spaced(value))));
    all.push(format!("isNullable: {}", ts.ends_with("| null")));
    all.extend([format!("default: {}", spaced(default)), format!("summary: {}", json!(first_sentence(doc)))]);
    all
}

/// A row of the table of options: itself, or what differs from the row that calls share under its name.
fn entry(row: &Row, shared: Option<&Vec<String>>) -> String {
    let mut parts = properties(row);
    if let Some(shared) = shared {
        parts.retain(|property| !shared.contains(property));
        if parts.is_empty() {
            return row.name.clone();
        }
        parts.insert(0, format!("...{}", row.name));
    }
    format!("{{ {} }}", parts.join(", "))
}

/// The rows of `alignScene`: those of `align` for every object, and what the package does with the scene.
fn scene_rows() -> Vec<Row> {
    let [align, ..] = calls();
    let snap = Row {
        name: "snap".into(),
        doc: "Whether to move each object that touches something along the normal of the support, so that it touches exactly".into(),
        kind: "boolean",
        ts: "boolean".into(),
        range: String::new(),
        limits: vec![],
        default: json!(false),
    };
    align.rows.into_iter().filter(|row| row.name != "initial").chain([snap]).collect()
}

fn options() -> String {
    let mut tables: Vec<(&str, Vec<Row>)> = calls().into_iter().map(|call| (call.key, call.rows)).collect();
    tables.insert(2, ("alignScene", scene_rows()));
    let all: Vec<&Row> = tables.iter().flat_map(|(_, rows)| rows).collect();
    // Options that several calls have, each as the first of them has it.
    let mut shared = BTreeMap::new();
    for row in &all {
        if all.iter().filter(|other| other.name == row.name && other.kind == row.kind).count() > 1 {
            shared.entry(&*row.name).or_insert_with(|| properties(row));
        }
    }
    let constant = |(name, own): (&&str, &Vec<String>)| format!("const {name} = {{ {} }} as const;\n", own.join(", "));
    let constants: String = shared.iter().map(constant).collect();
    let table = |(key, rows): &(&str, Vec<Row>)| {
        let rows = rows.iter().map(|row| format!("    {},\n", entry(row, shared.get(&*row.name))));
        format!("  {key}: [\n{}  ],\n", rows.collect::<String>())
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
