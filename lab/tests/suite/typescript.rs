//! The TypeScript package's declarations of options, results and codes, its defaults and its table of options are
//! generated from the Rust declarations.
//!
//! `UPDATE=1 cargo test --features types typescript` writes the files after a change.

use std::fmt::Write;

use serde_json::{Value, json};
use sim3align::align::evaluate::{EvaluateOptions, Evaluation, EvaluationDiagnostics};
use sim3align::metrics::Metrics;
use sim3align::metrics::bop::BopErrors;
use sim3align::metrics::layout::LayoutErrors;
use sim3align::metrics::pose_error::PoseErrors;
use sim3align::options::{Field, Options};
use sim3align::paper::options::GuardMode;
use sim3align::precise::options::{ExtentAxis, SearchScope};
use sim3align::progress::Stage;
use sim3align::register::options::Icp;
use sim3align::register::options::{EstimateSim3Options, RegisterOptions};
use sim3align::register::report::{Registration, RegistrationDiagnostics};
use sim3align::report::{
    Alignment, Alternative, Counts, Diagnostics, PaperAlignment, PaperDiagnostics, PreciseDiagnostics, ScoreTerms,
    SearchCounts, Sim3, Uncertainty, Warning, WarningCode,
};
use sim3align::report::{ColorReport, ColorVerdict, Effort, Preset};
use sim3align::scene::contact::Contact;
use sim3align::track::options::TrackOptions;
use sim3align::track::report::{CorrectedFrame, TrackState, TrackedFrame};
use sim3align::views::options::ViewsOptions;
use sim3align::views::report::{
    CameraPose, ViewPose, ViewRole, ViewsAlignment, ViewsDiagnostics, WorldFrame, WorldUncertainty,
};
use sim3align_lab::prelude::*;
use ts_rs::{Config, TS};

const HEADER: &str = "// Generated from the Rust declarations by tests/suite/typescript.rs; do not edit.\n\n";

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
    /// What else the table says: least and most value, choices.
    limits: Vec<(&'static str, Value)>,
    default: Value,
}

fn rows<T: Options>() -> Vec<Row> {
    let mut options = T::default();
    let docs: Vec<String> = T::FIELDS.iter().map(|(_, doc)| text(doc)).collect();
    options.named_fields().iter().zip(docs).map(|((name, field), doc)| row(name.clone(), doc, field)).collect()
}

fn row(name: String, doc: String, field: &Field<'_>) -> Row {
    let between = |min: Value, max: Value| vec![("min", min), ("max", max)];
    let or_null = |ts: &str| format!("{ts} | null");
    let (kind, ts, limits, default) = match field {
        Field::Count(value, range) => {
            ("integer", "number".into(), between(json!(range.start()), json!(range.end())), json!(value))
        }
        Field::Number(value, range) => {
            ("number", "number".into(), between(plain(*range.start()), plain(*range.end())), plain(**value))
        }
        Field::OptionalNumber(value, range) => {
            let limits = between(plain(*range.start()), plain(*range.end()));
            ("number", or_null("number"), limits, value.map_or(Value::Null, plain))
        }
        Field::Positive(value) => {
            ("number", or_null("number"), vec![("above", json!(0))], value.map_or(Value::Null, plain))
        }
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
            let default = value.map_or(Value::Null, |bounds| json!(bounds.map(plain)));
            ("guard", "readonly [min: number, max: number] | null".into(), vec![], default)
        }
        Field::Choice(choice) => {
            ("choice", choice.type_name().into(), vec![("choices", json!(choice.names()))], json!(choice.name()))
        }
    };
    let range = match field {
        Field::Count(..) | Field::Number(..) | Field::OptionalNumber(..) | Field::Positive(_) | Field::Guard(_) => {
            field.expected()
        }
        _ => String::new(),
    };
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

fn comment(out: &mut String, indent: &str, text: &str) {
    let _ = writeln!(out, "{indent}/**");
    let mut line = String::new();
    for word in text.split(' ') {
        if !line.is_empty() && line.chars().count() + word.chars().count() + indent.len() + 4 > 118 {
            let _ = writeln!(out, "{indent} * {line}");
            line.clear();
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line.push_str(word);
    }
    let _ = writeln!(out, "{indent} * {line}\n{indent} */");
}

/// Options as an interface; `preset` is the property that tells the presets apart.
fn interface<T: Options>(name: &str, preset: &str) -> String {
    let mut out = String::new();
    comment(&mut out, "", &text(T::DOC));
    let _ = writeln!(out, "export interface {name} {{\n{preset}");
    for Row { name, doc, ts, range, default, .. } in rows::<T>() {
        let range = if range.is_empty() { range } else { format!(" Takes {range}.") };
        comment(&mut out, "  ", &format!("{doc}{range} Default `{default}`."));
        let _ = writeln!(out, "  {name}?: {ts} | undefined;");
    }
    out.replace("{\n\n", "{\n") + "}\n"
}

fn declaration<T: TS>(config: &Config) -> String {
    format!("{}export {}\n", T::docs().unwrap_or_default(), T::decl(config))
}

/// The options of a call in all their forms.
struct Call {
    /// The interface, and the constant with the defaults.
    interface: String,
    defaults: String,
    /// The rows of the table of options, under the name of the call.
    table: String,
    summaries: Vec<String>,
}

/// The options of a call. `property` is the property of the interface that tells the presets apart.
fn call<T: Options>(name: &str, ts: &str, described: &str, preset: Option<&str>, property: &str) -> Call {
    let constant = ts.strip_suffix("Options").unwrap_or(ts);
    let words = constant.char_indices().flat_map(|(i, c)| [(i > 0 && c.is_uppercase()).then_some('_'), Some(c)]);
    let constant = words.flatten().collect::<String>().to_uppercase();
    Call {
        interface: interface::<T>(ts, property),
        defaults: defaults::<T>(&format!("{constant}_DEFAULTS"), &format!("Defaults of {described}."), ts, preset),
        table: table::<T>(name),
        summaries: rows::<T>().iter().map(|row| first_sentence(&row.doc).to_owned()).collect(),
    }
}

fn calls() -> [Call; 7] {
    let precise = "  /** The default method: search by rendering. */\n  preset?: \"precise\" | undefined;\n";
    let paper = "  /** The paper's method. */\n  preset: \"paper\";\n";
    let of_paper = "`align` with `preset: \"paper\"`";
    [
        call::<AlignOptions>("align", "AlignOptions", "`align`", Some("precise"), precise),
        call::<PaperOptions>("paper", "PaperOptions", of_paper, Some("paper"), paper),
        call::<ViewsOptions>("alignViews", "ViewsOptions", "`alignViews`", None, ""),
        call::<TrackOptions>("track", "TrackOptions", "`track`", None, ""),
        call::<EvaluateOptions>("evaluate", "EvaluateOptions", "`evaluate`", None, ""),
        call::<RegisterOptions>("register", "RegisterOptions", "`register`", None, ""),
        call::<EstimateSim3Options>("estimateSim3", "EstimateSim3Options", "`estimateSim3`", None, ""),
    ]
}

fn types() -> String {
    let config = Config::default();
    let declarations = [
        declaration::<Preset>(&config),
        declaration::<ColorVerdict>(&config),
        declaration::<Quality>(&config),
        declaration::<Effort>(&config),
        declaration::<SearchScope>(&config),
        declaration::<ExtentAxis>(&config),
        declaration::<GuardMode>(&config),
        declaration::<Icp>(&config),
        calls().map(|call| call.interface).join("\n"),
        declaration::<Stage>(&config),
        "/** Milliseconds per stage, in the order in which the stages first ran, and their total. */\n\
         export type Timings = Partial<Record<Stage, number>> & { total: number };\n"
            .into(),
        declaration::<ErrorCode>(&config),
        declaration::<WarningCode>(&config),
        declaration::<Warning>(&config),
        declaration::<Sim3>(&config),
        declaration::<Metrics>(&config),
        declaration::<PoseErrors>(&config),
        declaration::<LayoutErrors>(&config),
        declaration::<BopErrors>(&config),
        declaration::<Counts>(&config),
        declaration::<SearchCounts>(&config),
        declaration::<ScoreTerms>(&config),
        declaration::<ColorReport>(&config),
        declaration::<Alternative>(&config),
        declaration::<Uncertainty>(&config),
        declaration::<Diagnostics>(&config),
        declaration::<PaperDiagnostics>(&config),
        declaration::<PreciseDiagnostics>(&config),
        declaration::<Alignment>(&config),
        declaration::<PaperAlignment>(&config),
        declaration::<WorldFrame>(&config),
        declaration::<ViewRole>(&config),
        declaration::<WorldUncertainty>(&config),
        declaration::<CameraPose>(&config),
        declaration::<ViewPose>(&config),
        declaration::<ViewsDiagnostics>(&config),
        declaration::<ViewsAlignment>(&config),
        declaration::<TrackState>(&config),
        declaration::<TrackedFrame>(&config),
        declaration::<CorrectedFrame>(&config),
        declaration::<EvaluationDiagnostics>(&config),
        declaration::<Evaluation>(&config),
        declaration::<Contact>(&config),
        declaration::<RegistrationDiagnostics>(&config),
        declaration::<Registration>(&config),
    ];
    let imports = "import type { Direction, ScaleOption, Sim3Like, SymmetryOption } from \"../argument-types.js\";\n\n";
    HEADER.to_owned() + imports + &declarations.join("\n")
}

fn defaults<T: Options>(name: &str, doc: &str, ts: &str, preset: Option<&str>) -> String {
    let mut out = format!("/** {doc} */\nexport const {name} = {{\n");
    if let Some(preset) = preset {
        let _ = writeln!(out, "  preset: \"{preset}\",");
    }
    for Row { name, default, .. } in rows::<T>() {
        let _ = writeln!(out, "  {name}: {},", spaced(&default));
    }
    let _ = writeln!(out, "}} as const satisfies {ts};");
    out
}

/// JSON with spaces after its commas.
fn spaced(value: &Value) -> String {
    value.to_string().replace(',', ", ")
}

fn table<T: Options>(name: &str) -> String {
    let mut out = format!("  {name}: [\n");
    for Row { name, doc, kind, ts, limits, default, .. } in rows::<T>() {
        let nullable = ts.ends_with("| null");
        let _ = write!(out, "    {{\n      name: \"{name}\",\n      kind: \"{kind}\",\n");
        for (limit, value) in limits {
            let _ = writeln!(out, "      {limit}: {},", spaced(&value));
        }
        let _ = writeln!(out, "      isNullable: {nullable},\n      default: {},", spaced(&default));
        let _ = writeln!(out, "      summary: {},\n    }},", json!(first_sentence(&doc)));
    }
    out + "  ],\n"
}

fn options() -> String {
    let imports = "import type { OptionRow } from \"../options.js\";\nimport type {\n  AlignOptions,\n  EstimateSim3Options,\n  \
        EvaluateOptions,\n  PaperOptions,\n  RegisterOptions,\n  TrackOptions,\n  ViewsOptions,\n} from \"./types.js\";\n\n";
    let (constants, tables): (Vec<String>, Vec<String>) =
        calls().into_iter().map(|call| (call.defaults, call.table)).unzip();
    format!(
        "{HEADER}{imports}{}\n/** Every option with its kind, range, default and a one-line description. */\n\
         export const OPTIONS = {{\n{}}} as const satisfies Readonly<Record<string, readonly OptionRow[]>>;\n",
        constants.join("\n"),
        tables.concat()
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

#[test]
fn every_option_is_described_on_one_line() {
    for summary in calls().into_iter().flat_map(|call| call.summaries) {
        assert!((10..=130).contains(&summary.chars().count()), "{summary}");
    }
}
