//! A Markdown table of results.

use std::collections::{BTreeMap, BTreeSet};

use super::records::Record;
use super::result::ResultRow;
use crate::numbers::{cell, mean, median};

/// Confidence from which on callers trust a pose.
const TRUSTED: f64 = 0.9;

/// The name of the group of all cases.
const ALL: &str = "all";

/// Success and errors of each row: of all cases, by tier and by class.
pub fn report(records: &[Record]) -> String {
    let mut out = String::from(
        "| row | cases | n | strict % | loose % | scale % | rotation ° | place % | ≥ .9: right of | ms |\n",
    );
    out += "|---|---|---|---|---|---|---|---|---|---|\n";
    let keys: [fn(&ResultRow) -> &str; 3] = [|_| ALL, |result| &result.tier, |result| &result.class];
    for key in keys {
        let mut groups: BTreeMap<(&str, &str), Vec<&ResultRow>> = BTreeMap::new();
        for Record { row, result, .. } in records {
            groups.entry((row, key(result))).or_default().push(result);
        }
        let names: BTreeSet<&str> = groups.keys().map(|(_, name)| *name).collect();
        // Tiers and classes only where there are several.
        if names.len() > 1 || names.contains(ALL) {
            for ((row, group), results) in groups {
                out += &format!("| {row} | {group} | {} |\n", cells(&results).join(" | "));
            }
        }
    }
    out + "\nStrict: scale within 5 %, rotation within 10° up to symmetry, place within 5 % of the diameter; loose: twice that. Errors and times are medians.\n"
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
    vec![
        results.len().to_string(),
        share(|r| r.strict),
        share(|r| r.loose),
        error(0, 100.0),
        error(1, 1.0),
        error(2, 100.0),
        if trusted.is_empty() { "–".into() } else { format!("{right} of {}", trusted.len()) },
        cell(median(results.iter().filter_map(|r| r.ms).collect()), 0),
    ]
}
