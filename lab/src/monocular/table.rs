//! The tables of the monocular set.

use std::fmt::Write;

use super::record::{Errors, LOOSE, Record, STRICT, Tolerance};
use super::row::Row;
use super::runs::Way;
use crate::bench::statistics::{cell, median};
use crate::names::Named;

/// Confidence from which a pose is said to be right.
const SURE: f64 = 0.9;
/// Errors of focal length and shift that are small.
const SMALL: [f64; 2] = [0.05, 0.03];

/// The table of the rows, for each way, and of the sizes of scenes.
pub fn report(records: &[Record], rows: &[Row], ways: &[Way]) -> String {
    let mut out = String::new();
    let ways: Vec<Way> =
        ways.iter().copied().filter(|way| records.iter().any(|record| record.way == way.as_str())).collect();
    for way in ways {
        let _ = writeln!(
            out,
            "\n| {} | n | strict | loose | shift % (≤ 3 %) | focal % (≤ 5 %) | size % | confidence ≥ .9 | of these strict | loose |",
            way.as_str()
        );
        let _ = writeln!(out, "|---|---|---|---|---|---|---|---|---|---|");
        for row in rows {
            let of_row: Vec<&Record> =
                records.iter().filter(|r| r.row == row.as_str() && r.way == way.as_str() && r.has_truth).collect();
            line(&mut out, row.as_str(), &of_row);
        }
    }
    let _ = writeln!(
        out,
        "\nStrict: rotation within 10° up to symmetry, apparent size (focal length · scale / distance) within 5 %, centre in the image within 5 % of the apparent diameter; loose: twice that. Errors are medians of magnitudes, of all answered objects: of the shift of the map as a share of the distance, of the focal length, and, where it is said to be in metres, of the size; in brackets, how many are small."
    );
    sizes(&mut out, records, rows);
    out
}

fn line(out: &mut String, name: &str, records: &[&Record]) {
    let share = |tolerance: &Tolerance| {
        percent(records.iter().filter(|r| r.success(tolerance) == Some(true)).count(), records.len())
    };
    let errors = |of: fn(&Errors) -> f64| -> Vec<f64> {
        records.iter().filter_map(|r| r.errors.as_ref()).map(|errors| of(errors).abs()).collect()
    };
    let small = |of: fn(&Errors) -> f64, most: f64| {
        let errors = errors(of);
        let few = errors.iter().filter(|e| **e <= most).count();
        format!("{} ({})", cell(median(errors.clone()).map(|e| 100.0 * e), 1), percent(few, errors.len()))
    };
    let metric = records.iter().filter(|r| r.is_metric && !r.is_told);
    let sizes = metric.filter_map(|r| r.errors.as_ref()).map(|errors| errors.size.abs()).collect();
    let sure: Vec<&&Record> = records.iter().filter(|r| r.confidence >= SURE).collect();
    let right = |tolerance: &Tolerance| sure.iter().filter(|r| r.success(tolerance) == Some(true)).count();
    let _ = writeln!(
        out,
        "| {name} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
        records.len(),
        share(&STRICT),
        share(&LOOSE),
        small(|e| e.shift, SMALL[1]),
        small(|e| e.focal, SMALL[0]),
        cell(median(sizes).map(|e| 100.0 * e), 1),
        sure.len(),
        right(&STRICT),
        right(&LOOSE),
    );
}

/// The sizes of the objects of a scene once the length of one is known: each in turn makes those of the others metric.
fn sizes(out: &mut String, records: &[Record], rows: &[Row]) {
    let together: Vec<&Record> = records.iter().filter(|r| r.way == Way::Together.as_str()).collect();
    if together.is_empty() {
        return;
    }
    let _ = writeln!(
        out,
        "\n| together | scenes | focal ≤ 5 % | shift ≤ 3 % | sizes from one | median % |\n|---|---|---|---|---|---|"
    );
    for row in rows {
        let of_row: Vec<&Record> = together.iter().copied().filter(|r| r.row == row.as_str()).collect();
        let (mut scenes, mut few, mut sizes) = (0, [0; 2], Vec::new());
        let mut rest = of_row.as_slice();
        while let Some(first) = rest.first() {
            let count = rest.iter().take_while(|r| r.picture == first.picture).count();
            let (scene, others) = rest.split_at(count);
            rest = others;
            let errors: Vec<Errors> = scene.iter().filter_map(|r| r.errors).collect();
            let (Some(focal), Some(shift)) =
                (errors.first().map(|e| e.focal.abs()), median(errors.iter().map(|e| e.shift.abs()).collect()))
            else {
                continue;
            };
            scenes += 1;
            few[0] += usize::from(focal <= SMALL[0]);
            few[1] += usize::from(shift <= SMALL[1]);
            for (k, known) in errors.iter().enumerate() {
                let others = errors.iter().enumerate().filter(|(j, _)| *j != k);
                sizes.extend(others.map(|(_, other)| ((1.0 + other.size) / (1.0 + known.size) - 1.0).abs()));
            }
        }
        let _ = writeln!(
            out,
            "| {} | {scenes} | {} | {} | {} | {} |",
            row.as_str(),
            percent(few[0], scenes),
            percent(few[1], scenes),
            sizes.len(),
            cell(median(sizes).map(|e| 100.0 * e), 1),
        );
    }
    let _ = writeln!(
        out,
        "\nSizes from one: each object of a scene in turn has a known length, which gives the unit of the others."
    );
}

fn percent(count: usize, of: usize) -> String {
    if of == 0 { "–".into() } else { format!("{:.1} %", 100.0 * count as f64 / of as f64) }
}
