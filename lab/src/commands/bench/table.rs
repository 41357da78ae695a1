//! Markdown tables of `bench`.

use std::fmt::Write;

use sim3align::metrics::Metrics;
use sim3align::metrics::layout::LayoutErrors;
use sim3align::metrics::pose_error::PoseErrors;
use sim3align_lab::bench::benchmark::{LOOSE, Record, STRICT};
use sim3align_lab::bench::statistics::{cell, mean, median};
use sim3align_lab::bench::warning_tally::WarningTally;

/// A column with a metric.
struct Column {
    name: &'static str,
    digits: usize,
    value: fn(&Metrics) -> Option<f64>,
}

const METRICS: &[Column] = &[
    Column { name: "IoU", digits: 3, value: |m| m.iou },
    Column { name: "boundary F", digits: 3, value: |m| m.boundary_f },
    Column { name: "drift px", digits: 1, value: |m| m.center_drift_px },
    Column { name: "Chamfer mm", digits: 1, value: |m| m.chamfer_mm },
    Column { name: "uniChamfer mm", digits: 1, value: |m| m.uni_chamfer_mm },
    Column { name: "fitness", digits: 3, value: |m| m.fitness },
    Column { name: "normals", digits: 3, value: |m| m.normal_consistency },
    Column { name: "depth MAE mm", digits: 1, value: |m| m.depth_mae_mm },
];

/// All tables of all rows; a row is a set of options with the records of all cases.
pub fn report(rows: &[(String, Vec<&Record>)], failures: usize) -> String {
    let mut out = String::new();
    let Some((_, first)) = rows.first() else { return out };
    let mut groups: Vec<(String, Vec<usize>)> = vec![("all".into(), (0..first.len()).collect())];
    groups.extend(grouped(first, |record| record.tier.clone()));
    groups.extend(grouped(first, |record| record.class.clone()));
    groups.extend(grouped(first, |record| format!("{}, {}", record.tier, record.class)));
    header(&mut out, "cases", &["row", "n", "strict", "loose", "scale %", "rotation °", "translation %"]);
    for (group, members) in &groups {
        for (name, records) in rows {
            line(&mut out, group, name, &members.iter().map(|&i| records[i]).collect::<Vec<_>>());
        }
        truth_line(&mut out, group, &members.iter().map(|&i| first[i]).collect::<Vec<_>>());
    }
    let _ = writeln!(
        out,
        "\nStrict: scale within 5 %, rotation within 10° up to symmetry, translation (of the middle of the mesh's box) within 5 % of its diagonal; loose: 10 %, 20°, 10 %. Errors and seconds are medians, metrics means over the answered cases; *truth* is the true pose's own row."
    );
    layout(&mut out, &groups, rows);
    warnings(&mut out, rows);
    for (name, records) in rows {
        list_failures(&mut out, name, records, failures);
    }
    out
}

/// The table of layout metrics. An unanswered case overlaps nothing, is turned by half, and is not found.
fn layout(out: &mut String, groups: &[(String, Vec<usize>)], rows: &[(String, Vec<&Record>)]) {
    let known = |record: &&Record| record.truth_metrics.is_some();
    if !rows.iter().any(|(_, records)| records.iter().any(known)) {
        return;
    }
    let _ = writeln!(out, "\n| layout | row | n | 3D IoU | ICP-Rot ° | ADD-S | ADD-S@0.1 | 20 cm, 20°, 20 % |");
    let _ = writeln!(out, "|---|---|---|---|---|---|---|---|");
    for (group, members) in groups {
        for (name, records) in rows {
            let records: Vec<&Record> = members.iter().map(|&i| records[i]).filter(known).collect();
            let column = |missing: Option<f64>, of: fn(&LayoutErrors) -> f64| {
                let value = |record: &&Record| record.layout.as_ref().map(of).or(missing);
                mean(&records.iter().filter_map(value).collect::<Vec<_>>())
            };
            let share = |of| column(Some(0.0), of).map(|share| 100.0 * share);
            let _ = writeln!(
                out,
                "| {group} | {name} | {} | {} | {} | {} | {} % | {} % |",
                records.len(),
                cell(column(Some(0.0), |l| l.box_iou), 3),
                cell(column(Some(180.0), |l| l.icp_rotation_deg), 1),
                cell(column(None, |l| l.add_s_relative), 4),
                cell(share(|l| f64::from(l.is_found)), 1),
                cell(share(|l| f64::from(l.is_cad_aligned)), 1),
            );
        }
    }
    let _ = writeln!(
        out,
        "\n3D IoU of oriented boxes, ICP-Rot and ADD-S relative to the diameter are means, ADD-S over the answered cases; ADD-S@0.1 and the rule of 20 cm, 20° and 20 % are shares."
    );
}

/// The table of warnings: whether the poses that they come with are wrong.
fn warnings(out: &mut String, rows: &[(String, Vec<&Record>)]) {
    let lines: Vec<(&str, WarningTally)> = rows
        .iter()
        .flat_map(|(name, records)| WarningTally::of(records).into_iter().map(|tally| (name.as_str(), tally)))
        .collect();
    if lines.is_empty() {
        return;
    }
    let _ = writeln!(out, "\n| warning | row | given | pose wrong | of those without it |");
    let _ = writeln!(out, "|---|---|---|---|---|");
    for (name, WarningTally { code, with, without }) in lines {
        let code = serde_json::to_string(&code).unwrap_or_default();
        let percent = cell(with.wrong_percent(), 0);
        let _ = writeln!(
            out,
            "| `{}` | {name} | {} | {} ({percent} %) | {} % |",
            code.trim_matches('"'),
            with.poses,
            with.wrong,
            cell(without.wrong_percent(), 0)
        );
    }
    let _ = writeln!(out, "\nOf the answered cases of known truth; a pose beyond the strict tolerance is wrong.");
}

/// Groups the indices of records by key, in the order of first occurrence.
fn grouped(records: &[&Record], key: impl Fn(&Record) -> String) -> Vec<(String, Vec<usize>)> {
    let mut groups: Vec<(String, Vec<usize>)> = Vec::new();
    for (i, key) in records.iter().map(|record| key(record)).enumerate() {
        match groups.iter_mut().find(|(name, _)| *name == key) {
            Some((_, members)) => members.push(i),
            None => groups.push((key, vec![i])),
        }
    }
    groups
}

fn header(out: &mut String, first: &str, columns: &[&str]) {
    let names = columns.iter().copied().chain(METRICS.iter().map(|column| column.name)).chain(["s"]);
    let names: Vec<&str> = core::iter::once(first).chain(names).collect();
    let _ = writeln!(out, "| {} |", names.join(" | "));
    let rules: Vec<&str> = names.iter().map(|_| "---").collect();
    let _ = writeln!(out, "|{}|", rules.join("|"));
}

fn line(out: &mut String, group: &str, name: &str, records: &[&Record]) {
    let share = |tolerance| {
        let known: Vec<bool> = records.iter().filter_map(|record| record.success(tolerance)).collect();
        let hits = known.iter().filter(|hit| **hit).count();
        if known.is_empty() { "–".into() } else { format!("{:.1} %", 100.0 * hits as f64 / known.len() as f64) }
    };
    // A missing result counts as an infinite error.
    let known = || records.iter().filter(|record| record.truth_metrics.is_some());
    let error = |digits, of: fn(&PoseErrors) -> f64| {
        cell(median(known().map(|record| record.errors.as_ref().map_or(f64::INFINITY, of)).collect()), digits)
    };
    let unanswered = records.iter().filter(|record| record.alignment.is_none()).count();
    let count = if unanswered == 0 { String::new() } else { format!(" ({unanswered} unanswered)") };
    let _ = write!(
        out,
        "| {group} | {name} | {}{count} | {} | {} | {} | {} | {}",
        records.len(),
        share(&STRICT),
        share(&LOOSE),
        error(2, |e| 100.0 * e.scale_error),
        error(1, |e| e.rotation_error_deg),
        error(2, |e| 100.0 * e.translation_error_relative),
    );
    metrics(out, records, |record| record.alignment.as_ref().and_then(|alignment| alignment.metrics()));
    // Unknown for some imported results.
    let seconds = records.iter().map(|record| record.seconds).filter(|seconds| seconds.is_finite());
    let _ = writeln!(out, " | {} |", cell(median(seconds.collect()), 2));
}

fn truth_line(out: &mut String, group: &str, records: &[&Record]) {
    let known = records.iter().filter(|record| record.truth_metrics.is_some()).count();
    let _ = write!(out, "| {group} | *truth* | {known} | | | | |");
    metrics(out, records, |record| record.truth_metrics);
    let _ = writeln!(out, " | |");
}

/// Mean over the cases with the metric.
fn metrics(out: &mut String, records: &[&Record], of: impl Fn(&Record) -> Option<Metrics>) {
    for Column { digits, value, .. } in METRICS {
        let values: Vec<f64> = records.iter().filter_map(|record| value(&of(record)?)).collect();
        let _ = write!(out, " | {}", cell(mean(&values), *digits));
    }
}

fn list_failures(out: &mut String, name: &str, records: &[&Record], most: usize) {
    let failed: Vec<&&Record> = records.iter().filter(|record| record.success(&STRICT) == Some(false)).collect();
    let _ = writeln!(out, "\n{name}: {} of {} beyond the strict tolerance", failed.len(), records.len());
    if failed.is_empty() || most == 0 {
        return;
    }
    let _ = writeln!(
        out,
        "\n| case | loose | scale | rotation ° | translation % | IoU (truth) | depth mm (truth) | tags |"
    );
    let _ = writeln!(out, "|---|---|---|---|---|---|---|---|");
    for record in failed.iter().take(most) {
        let found = record.alignment.as_ref().and_then(|alignment| alignment.metrics());
        let both = |digits, of: fn(&Metrics) -> Option<f64>| {
            let [found, truth] = [found, record.truth_metrics].map(|m| cell(m.as_ref().and_then(of), digits));
            format!("{found} ({truth})")
        };
        let errors = match (&record.errors, &record.error) {
            (Some(e), _) => format!(
                "{} | {:+.1} % | {:.1} | {:.1}",
                if LOOSE.holds(e) { "yes" } else { "no" },
                100.0 * signed_scale_error(record),
                e.rotation_error_deg,
                100.0 * e.translation_error_relative
            ),
            (None, Some(error)) => format!("no | {} | |", error.split(':').next().unwrap_or_default()),
            (None, None) => "no | | |".into(),
        };
        let _ = writeln!(
            out,
            "| {} | {errors} | {} | {} | {} |",
            record.name,
            both(2, |m| m.iou),
            both(1, |m| m.depth_mae_mm),
            record.tags.join(", ")
        );
    }
    if failed.len() > most {
        let _ = writeln!(out, "\n… and {} more", failed.len() - most);
    }
}

/// s / s_true − 1.
fn signed_scale_error(record: &Record) -> f64 {
    let ratio = record.alignment.as_ref().map(|alignment| alignment.diagnostics().scale_ratio);
    ratio.zip(record.truth_scale_ratio).map_or(f64::NAN, |(found, truth)| found / truth - 1.0)
}
