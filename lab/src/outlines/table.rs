//! Tables of outlines by group.

use core::fmt::Write;

use super::object::{ObjectOutlines, Offsets};
use crate::bench::statistics::{cell, median};

/// Markdown tables of outlines and of depth, a row per group in the order of the first objects.
pub fn report(objects: &[ObjectOutlines]) -> String {
    let mut groups: Vec<&str> = Vec::new();
    for object in objects {
        if !groups.contains(&object.group.as_str()) {
            groups.push(&object.group);
        }
    }
    let members = |group: &str| -> Vec<&ObjectOutlines> { objects.iter().filter(|o| o.group == group).collect() };
    let mut out = String::from(
        "Offsets from the true outline, pixels of an image 640 wide, positive outwards: 10th percentile / median / 90th \
         percentile of the objects' medians; ± the median of the spreads (MAD) within an object.\n\n\
         | group | objects | mask | mask lost | mask's shift | depth edge | its shift | depth edge from mask | photo's edge \
         | its shift |\n|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for group in &groups {
        let of = members(group);
        let lost = median(of.iter().map(|o| 100.0 * (1.0 - o.masked)).collect());
        let _ = writeln!(
            out,
            "| {group} | {} | {} | {} % | {} | {} | {} | {} | {} | {} |",
            of.len(),
            offsets(&of, |o| o.mask),
            cell(lost, 0),
            shift(&of, |o| o.mask),
            offsets(&of, |o| o.depth),
            shift(&of, |o| o.depth),
            offsets(&of, |o| o.depth_from_mask),
            offsets(&of, |o| o.photo),
            shift(&of, |o| o.photo),
        );
    }
    out.push_str(
        "\nMedians over objects. Gap: pixels without readings from the object to the background, median and 90th percentile \
         of the rays. Mixed: share of the readings within 3 pixels of the depth edge. Noise: measured less true depth \
         inside; grain: of neighbouring pixels.\n\n\
         | group | depth edges of | gap | mixed | distance | noise | noise / z² | grain | grain / z² |\n\
         |---|---|---|---|---|---|---|---|---|\n",
    );
    for group in &groups {
        let of = members(group);
        let middle = |value: &dyn Fn(&ObjectOutlines) -> Option<f64>, digits: usize| {
            cell(median(of.iter().filter_map(|o| value(o)).collect()), digits)
        };
        let _ = writeln!(
            out,
            "| {group} | {} | {} / {} | {} % | {} m | {} mm | {} mm/m² | {} mm | {} mm/m² |",
            of.iter().filter(|o| o.depth.is_some()).count(),
            middle(&|o| o.gap.map(|gap| gap[0]), 1),
            middle(&|o| o.gap.map(|gap| gap[1]), 1),
            middle(&|o| o.mixed.map(|share| 100.0 * share), 1),
            middle(&|o| Some(o.quality.distance_m), 2),
            middle(&|o| Some(1000.0 * o.quality.noise_m), 1),
            middle(&|o| Some(1000.0 * o.quality.noise_m / o.quality.distance_m.powi(2)), 1),
            middle(&|o| Some(1000.0 * o.quality.grain_m), 1),
            middle(&|o| Some(1000.0 * o.quality.grain_m / o.quality.distance_m.powi(2)), 1),
        );
    }
    out
}

/// A line per object.
pub fn by_object(objects: &[ObjectOutlines]) -> String {
    let mut out = String::from(
        "| object | mask | mask's shift | depth edge | its shift | depth edge from mask | photo's edge | its shift | gap | mixed |\n\
         |---|---|---|---|---|---|---|---|---|---|\n",
    );
    for object in objects {
        let one = |of: Option<Offsets>| {
            of.map_or("–".into(), |of| format!("{:+.1} ± {:.1} ({})", of.median, of.spread, of.rays))
        };
        let shift =
            |of: Option<Offsets>| of.and_then(|of| of.shift).map_or("–".into(), |[x, y]| format!("{x:+.1}, {y:+.1}"));
        let _ = writeln!(
            out,
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
            object.name,
            one(object.mask),
            shift(object.mask),
            one(object.depth),
            shift(object.depth),
            one(object.depth_from_mask),
            one(object.photo),
            shift(object.photo),
            object.gap.map_or("–".into(), |[middle, most]| format!("{middle:.1} / {most:.1}")),
            object.mixed.map_or("–".into(), |share| format!("{:.0} %", 100.0 * share)),
        );
    }
    out
}

fn offsets(objects: &[&ObjectOutlines], of: impl Fn(&ObjectOutlines) -> Option<Offsets>) -> String {
    let mut medians: Vec<f64> = objects.iter().filter_map(|o| Some(of(o)?.median)).collect();
    if medians.is_empty() {
        return "–".into();
    }
    medians.sort_by(f64::total_cmp);
    let at = |share: f64| medians[(share * (medians.len() - 1) as f64).round() as usize];
    let spread = median(objects.iter().filter_map(|o| Some(of(o)?.spread)).collect());
    let middle = median(medians.clone()).unwrap_or_default();
    format!("{:+.1} / {middle:+.1} / {:+.1} ± {}", at(0.1), at(0.9), cell(spread, 1))
}

/// Median and 90th percentile of the lengths of the shifts.
fn shift(objects: &[&ObjectOutlines], of: impl Fn(&ObjectOutlines) -> Option<Offsets>) -> String {
    let mut lengths: Vec<f64> = objects.iter().filter_map(|o| of(o)?.shift).map(|[x, y]| libm::hypot(x, y)).collect();
    if lengths.is_empty() {
        return "–".into();
    }
    lengths.sort_by(f64::total_cmp);
    let at = |share: f64| lengths[(share * (lengths.len() - 1) as f64).round() as usize];
    format!("{:.1} / {:.1}", at(0.5), at(0.9))
}
