//! Markdown tables of results.

use std::fmt::Write;

use super::result::ResultRow;
use crate::statistics::{cell, mean, median};

/// Confidence from which on callers trust a pose.
const TRUSTED: f64 = 0.9;

/// The tables of rows, each with its results: success and errors of all cases, by tier and by class, warnings, failures.
pub fn report(rows: &[(String, Vec<ResultRow>)], failures: usize) -> String {
    let mut out = String::from(
        "| cases | row | n | strict % | loose % | scale % | rotation ° | place % | ≥ .9: right of | IoU, truth's | ms |\n|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    let all = || rows.iter().flat_map(|(_, results)| results);
    let keys: [fn(&ResultRow) -> &str; 3] = [|_| "all", |result| &result.tier, |result| &result.class];
    for key in keys {
        for group in distinct(all().map(key)) {
            for (name, results) in rows {
                let of: Vec<&ResultRow> = results.iter().filter(|result| key(result) == group).collect();
                if !of.is_empty() {
                    let _ = writeln!(out, "| {group} | {name} | {} |", cells(&of).join(" | "));
                }
            }
        }
    }
    out += "\nStrict: scale within 5 %, rotation within 10° up to symmetry, place within 5 % of the diameter; loose: twice that. Errors are medians of the answered cases, IoU is a mean.\n";
    for (name, results) in rows {
        warnings(&mut out, name, results);
    }
    for (name, results) in rows {
        list_failures(&mut out, name, results, failures);
    }
    out
}

fn distinct<'a>(values: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut found = Vec::new();
    for value in values {
        if !found.contains(&value) {
            found.push(value);
        }
    }
    found
}

fn cells(results: &[&ResultRow]) -> Vec<String> {
    let share = |of: fn(&ResultRow) -> Option<bool>| {
        cell(mean(results.iter().filter_map(|r| of(r)).map(|right| 100.0 * f64::from(right))), 1)
    };
    let error = |k: usize, unit: f64| {
        cell(median(results.iter().filter_map(|r| r.errors).map(|errors| unit * errors[k]).collect()), 2)
    };
    let trusted: Vec<_> = results.iter().filter(|r| r.confidence.is_some_and(|c| c >= TRUSTED)).collect();
    let right = trusted.iter().filter(|r| r.strict == Some(true)).count();
    let iou = |of: &dyn Fn(&ResultRow) -> Option<f64>| cell(mean(results.iter().filter_map(|r| of(r))), 3);
    let unanswered = results.iter().filter(|r| r.error.is_some()).count();
    let count = if unanswered == 0 { String::new() } else { format!(" ({unanswered} unanswered)") };
    vec![
        format!("{}{count}", results.len()),
        share(|r| r.strict),
        share(|r| r.loose),
        error(0, 100.0),
        error(1, 1.0),
        error(2, 100.0),
        format!("{right} of {}", trusted.len()),
        format!("{}, {}", iou(&|r| *r.metrics.as_ref()?.get("iou")?), iou(&|r| *r.truth_metrics.as_ref()?.get("iou")?)),
        cell(median(results.iter().filter_map(|r| r.ms).collect()), 0),
    ]
}

/// Error rates of poses with each warning and without it.
fn warnings(out: &mut String, name: &str, results: &[ResultRow]) {
    let known: Vec<&ResultRow> = results.iter().filter(|r| r.strict.is_some() && r.error.is_none()).collect();
    for code in distinct(known.iter().flat_map(|r| &r.warnings).map(String::as_str)) {
        let (with, without): (Vec<&ResultRow>, Vec<&ResultRow>) =
            known.iter().partition(|result| result.warnings.iter().any(|other| other == code));
        let wrong = |of: &[&ResultRow]| of.iter().filter(|r| r.strict == Some(false)).count();
        let percent = 100.0 * wrong(&without) as f64 / without.len().max(1) as f64;
        let _ = writeln!(
            out,
            "\n{name}: `{code}` with {} poses, {} of them wrong; without it {percent:.0} %",
            with.len(),
            wrong(&with)
        );
    }
}

fn list_failures(out: &mut String, name: &str, results: &[ResultRow], most: usize) {
    let failed: Vec<&ResultRow> = results.iter().filter(|result| result.strict == Some(false)).collect();
    let _ = writeln!(out, "\n{name}: {} of {} beyond the strict tolerance", failed.len(), results.len());
    for result in failed.iter().take(most) {
        let found = match (&result.errors, &result.error) {
            (Some([scale, rotation, place]), _) => {
                format!("scale {:.1} %, rotation {rotation:.1}°, place {:.1} %", 100.0 * scale, 100.0 * place)
            }
            (None, error) => error.clone().unwrap_or_else(|| "no pose".into()),
        };
        let confidence = cell(result.confidence, 2);
        let _ = writeln!(out, "- {}: {found}, confidence {confidence} ({})", result.name, result.tags.join(", "));
    }
}
