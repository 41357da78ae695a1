//! Records of registrations, and Markdown tables of them.

use std::collections::BTreeSet;
use std::fmt::Write;

use serde::{Deserialize, Serialize};
use sim3align_lab::statistics::{cell, mean, median};

/// Lower bounds of the overlap bins, with names.
const OVERLAPS: [(f64, &str); 4] =
    [(0.6, "overlap ≥ 60 %"), (0.3, "overlap 30–60 %"), (0.1, "overlap 10–30 %"), (0.0, "overlap < 10 %")];

/// Upper bounds of the distance bins, with names; for lidar only.
const DISTANCES_M: [(f64, &str); 5] = [
    (7.5, "about 5 m"),
    (15.0, "about 10 m"),
    (25.0, "about 20 m"),
    (34.0, "about 30 m"),
    (f64::INFINITY, "about 40 m"),
];

/// The result of a method on a pair, as stored in the file of records.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Record {
    pub id: String,
    pub group: String,
    pub method: String,
    pub overlap: Option<f64>,
    pub distance_m: f64,
    pub success: bool,
    pub rotation_deg: Option<f64>,
    /// Relative. Absent in older files.
    #[serde(default)]
    pub scale: Option<f64>,
    pub translation_m: Option<f64>,
    pub rmse_m: Option<f64>,
    pub error: Option<String>,
    pub seconds: Option<f64>,
    /// Target from source, column-major.
    pub matrix: Option<[f64; 16]>,
}

/// Table of recall and errors of every method, over all pairs and per bin.
pub fn report(records: &[Record], methods: &[&str]) -> String {
    let mut out = String::new();
    let _ = writeln!(
        out,
        "| pairs | method | n | recall | by scene | RRE ° | RTE m | RRE ° (median) | RTE m (median) | RMSE m | scale % | s |"
    );
    let _ = writeln!(out, "|---|---|---|---|---|---|---|---|---|---|---|---|");
    let mut group = |name: &str, belongs: &dyn Fn(&Record) -> bool| {
        for method in methods {
            let members: Vec<&Record> = records.iter().filter(|r| r.method == *method && belongs(r)).collect();
            if !members.is_empty() {
                line(&mut out, name, method, &members);
            }
        }
    };
    group("all", &|_| true);
    let mut upper = f64::INFINITY;
    for (lower, name) in OVERLAPS {
        group(name, &|r| r.overlap.is_some_and(|overlap| overlap >= lower && overlap < upper));
        upper = lower;
    }
    if records.iter().all(|record| record.rmse_m.is_none()) {
        let mut lower = 0.0;
        for (upper, name) in DISTANCES_M {
            group(name, &|r| r.distance_m >= lower && r.distance_m < upper);
            lower = upper;
        }
    }
    let _ = writeln!(
        out,
        "\nRecall over pairs, and its mean over scenes. Success: RMSE by gt.info within 0.2 m (3DMatch), or rotation within 5° and translation within 2 m (KITTI); scale within 5 %. RRE, RTE, RMSE and scale are of the successes, means unless said otherwise; seconds are means."
    );
    out
}

fn line(out: &mut String, group: &str, method: &str, records: &[&Record]) {
    let recall = |records: &[&Record]| {
        100.0 * records.iter().filter(|record| record.success).count() as f64 / records.len().max(1) as f64
    };
    let scenes: BTreeSet<&str> = records.iter().map(|record| record.group.as_str()).collect();
    let by_scene = scenes
        .iter()
        .map(|scene| recall(&records.iter().copied().filter(|record| record.group == *scene).collect::<Vec<_>>()));
    let successes = |of: fn(&Record) -> Option<f64>| -> Vec<f64> {
        records.iter().filter(|record| record.success).filter_map(|record| of(record)).collect()
    };
    let (rotation, translation) = (successes(|r| r.rotation_deg), successes(|r| r.translation_m));
    let seconds = records.iter().filter_map(|record| record.seconds);
    let _ = writeln!(
        out,
        "| {group} | {method} | {} | {:.1} % | {} % | {} | {} | {} | {} | {} | {} | {} |",
        records.len(),
        recall(records),
        cell(mean(by_scene), 1),
        cell(mean(rotation.iter().copied()), 2),
        cell(mean(translation.iter().copied()), 3),
        cell(median(rotation), 2),
        cell(median(translation), 3),
        cell(mean(successes(|r| r.rmse_m)), 3),
        cell(mean(successes(|r| r.scale.map(|scale| 100.0 * scale))), 2),
        cell(mean(seconds), 2),
    );
}
