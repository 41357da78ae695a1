//! The generated set of depth sensors and of masks: each class shows its effect.

use std::collections::BTreeSet;

use sim3align_lab::cases::case::{EvaluationCase, EvaluationSet, MIN_MASK_PX};
use sim3align_lab::cases::tier::{CaseSet, Class, Tier};
use sim3align_lab::outlines::{GroupBy, ObjectOutlines, OutlineView};
use sim3align_lab::prelude::*;

use crate::common::{mask_px, object_depth, parameter};

/// Two cases of every class of every tier.
const LOOKED_AT: usize = 72;

fn set(seed: u64) -> EvaluationSet {
    EvaluationSet::new(seed).of(CaseSet::Sensors)
}

fn of_class(class: Class) -> Vec<EvaluationCase> {
    let indices = (0..LOOKED_AT).filter(|&index| CaseSet::Sensors.class(index) == class);
    let cases: Vec<EvaluationCase> = indices.map(|index| set(7).case(index).unwrap()).collect();
    assert_eq!(cases.len(), LOOKED_AT / 12);
    cases
}

fn of(case: &EvaluationCase, name: &str) -> f64 {
    parameter(&case.parameters, name)
}

/// Sizes of the 4-connected parts of a mask, largest first.
fn parts(mask: &[u8], width: usize) -> Vec<usize> {
    let mut left: BTreeSet<usize> = (0..mask.len()).filter(|&i| mask[i] != 0).collect();
    let mut sizes = Vec::new();
    while let Some(first) = left.pop_first() {
        let (mut open, mut size) = (vec![first], 0);
        while let Some(i) = open.pop() {
            size += 1;
            let beside = [(i % width > 0).then(|| i - 1), (i % width + 1 < width).then(|| i + 1)];
            let above = [i.checked_sub(width), Some(i + width)];
            open.extend(beside.into_iter().chain(above).flatten().filter(|k| left.remove(k)));
        }
        sizes.push(size);
    }
    sizes.sort_unstable_by(|a, b| b.cmp(a));
    sizes
}

#[test]
fn classes_are_mixed_evenly() {
    for tier in Tier::ALL {
        let of_tier = || (0..LOOKED_AT).filter(|&index| Tier::of(index) == *tier);
        let classes: BTreeSet<Class> = of_tier().map(|index| CaseSet::Sensors.class(index)).collect();
        assert_eq!(classes.len(), 12);
        for class in classes {
            assert_eq!(of_tier().filter(|&index| CaseSet::Sensors.class(index) == class).count(), 2);
            assert!((0..LOOKED_AT).all(|index| CaseSet::General.class(index) != class), "{class:?}");
        }
    }
    for set in CaseSet::ALL {
        assert_eq!(CaseSet::from_name(set.as_str()), Ok(*set));
    }
    assert!(CaseSet::from_name("radar").is_err());
}

#[test]
fn every_case_has_enough_of_a_mask() {
    for index in 0..LOOKED_AT {
        let case = set(7).case(index).unwrap();
        let mask_px = mask_px(&case.observation);
        assert!(mask_px >= MIN_MASK_PX, "{}: {mask_px} pixels", case.name());
        assert!(of(&case, "visible") >= case.tier.least_visible(case.class), "{}", case.name());
    }
}

#[test]
fn a_wide_shadow_lies_on_one_side_of_the_object() {
    for case in of_class(Class::WideShadow) {
        let (alone, depth) = (object_depth(&case), case.observation.depth());
        let width = depth.width();
        let object_px = alone.iter().filter(|z| **z > 0.0).count() as f64;
        // Lost readings on either side of the object, in its rows, no farther than the object is wide.
        let (mut left, mut right) = (0.0, 0.0);
        for (row, lost) in alone.chunks(width).zip(depth.data().chunks(width)) {
            let Some(first) = row.iter().position(|z| *z > 0.0) else { continue };
            let last = row.iter().rposition(|z| *z > 0.0).unwrap();
            let reach = last - first + 8;
            let count = |range: core::ops::Range<usize>| lost[range].iter().filter(|z| **z == 0.0).count() as f64;
            left += count(first.saturating_sub(reach)..first);
            right += count(last + 1..(last + 1 + reach).min(width));
        }
        let [most, least] = [left.max(right) / object_px, left.min(right) / object_px];
        println!("{}: {most:.3} and {least:.3}, {:.3}", case.name(), of(&case, "shadow"));
        assert!((0.1..=0.4).contains(&of(&case, "shadow")), "{}", case.name());
        assert!((0.05..=0.65).contains(&most), "{}: {most}", case.name());
        assert!(least < 0.7 * most, "{}: {least} of {most}", case.name());
    }
}

#[test]
fn holes_are_on_the_object_and_in_the_mask() {
    for case in of_class(Class::Holes) {
        let masked = case.observation.mask().data().iter().zip(case.observation.depth().data());
        let masked: Vec<bool> = masked.filter(|(m, _)| **m != 0).map(|(_, z)| *z == 0.0).collect();
        let share = masked.iter().filter(|lost| **lost).count() as f64 / masked.len() as f64;
        let least = [0.04, 0.1, 0.18][case.tier as usize];
        println!("{}: {share:.3} lost", case.name());
        assert!((least..0.75).contains(&share), "{}: {share}", case.name());
        assert!(case.tags.iter().any(|tag| ["dark", "shiny", "grazing"].contains(tag)), "{}", case.name());
    }
}

#[test]
fn a_mask_of_readings_has_a_reading_everywhere_and_lacks_the_holes() {
    for case in of_class(Class::MaskOfReadings) {
        let masked = case.observation.mask().data().iter().zip(case.observation.depth().data());
        assert!(masked.into_iter().all(|(m, z)| *m == 0 || *z > 0.0), "{}", case.name());
        let alone = object_depth(&case);
        let pixels = || alone.iter().zip(case.observation.mask().data()).filter(|(z, _)| **z > 0.0);
        let lacking = pixels().filter(|(_, m)| **m == 0).count() as f64 / pixels().count() as f64;
        assert!(lacking >= 0.04, "{}: {lacking}", case.name());
    }
}

#[test]
fn a_split_mask_has_two_parts_and_sometimes_one_without_depth() {
    let mut without = 0;
    for case in of_class(Class::SplitMask) {
        let (mask, depth) = (case.observation.mask(), case.observation.depth());
        let sizes = parts(mask.data(), mask.width());
        let total: usize = sizes.iter().sum();
        println!("{}: {sizes:?}", case.name());
        assert!(sizes[1] as f64 >= 0.1 * total as f64, "{}: {sizes:?}", case.name());
        let with_depth: Vec<u8> =
            mask.data().iter().zip(depth.data()).map(|(m, z)| u8::from(*m != 0 && *z > 0.0)).collect();
        let lost = total - with_depth.iter().filter(|m| **m != 0).count();
        if case.tags.contains(&"part-without-depth") {
            without += 1;
            assert!(lost >= sizes[1], "{}: {lost} lost", case.name());
        }
    }
    assert!((1..6).contains(&without), "{without} of 6");
}

#[test]
fn quantised_depth_has_steps_that_grow_with_its_square() {
    for case in of_class(Class::Quantised) {
        let mut levels: Vec<f32> = case.observation.depth().data().iter().copied().filter(|z| *z > 0.0).collect();
        levels.sort_unstable_by(f32::total_cmp);
        levels.dedup();
        let alone: Vec<f32> = object_depth(&case).into_iter().filter(|z| *z > 0.0).collect();
        let z = f64::from(alone.iter().sum::<f32>()) / alone.len() as f64;
        let step_m = of(&case, "stepMm") / 1000.0;
        assert!((0.0005..=0.01).contains(&step_m), "{}: {step_m}", case.name());
        let disparity = |level: f32| z * z / step_m / f64::from(level);
        // In units of a disparity step, every two levels are a whole number apart; z is the object's mean here.
        let apart: Vec<f64> = levels.windows(2).map(|pair| disparity(pair[0]) - disparity(pair[1])).collect();
        let smallest = apart.iter().copied().fold(f64::INFINITY, f64::min);
        assert!((0.7..1.4).contains(&smallest), "{}: steps of {smallest}", case.name());
        let whole = |steps: f64| (steps / smallest - (steps / smallest).round()).abs() < 0.05;
        assert!(apart.iter().filter(|steps| whole(**steps)).count() * 10 >= apart.len() * 9, "{}", case.name());
    }
}

#[test]
fn a_predicted_mask_is_wrong_by_a_few_percent_of_the_object() {
    let mut checked = 0;
    for case in of_class(Class::PredictedMask) {
        assert!((0.008..=0.042).contains(&of(&case, "maskError")), "{}", case.name());
        if of(&case, "hidden") > 0.0 {
            continue;
        }
        checked += 1;
        let alone = object_depth(&case);
        let area = alone.iter().filter(|z| **z > 0.0).count() as f64;
        let wrong = alone.iter().zip(case.observation.mask().data()).filter(|(z, m)| (**z > 0.0) != (**m != 0)).count();
        let share = wrong as f64 / area;
        println!("{}: {share:.3} wrong", case.name());
        // Up to three islands of .8 % each in addition.
        assert!((0.008..=0.07).contains(&share), "{}: {share}", case.name());
    }
    assert!(checked >= 2);
}

/// The measured outlines of the cases of a class that show enough of them.
fn outlines_of(class: Class) -> Vec<ObjectOutlines> {
    let view = |case| OutlineView::generated(case, GroupBy::Class);
    let found: Vec<_> = of_class(class).into_iter().filter_map(|case| ObjectOutlines::of(&view(case))).collect();
    found.iter().for_each(|o| println!("{}: {o:?}", o.name));
    assert!(found.len() >= 4, "{class:?}: {}", found.len());
    found
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.collect();
    values.iter().sum::<f64>() / values.len() as f64
}

#[test]
fn edges_of_stereo_move_in_and_out() {
    let found = outlines_of(Class::ActiveStereo);
    let depth = || found.iter().filter_map(|o| o.depth);
    assert!(depth().count() >= 3);
    assert!(mean(depth().map(|edge| edge.spread)) >= 0.6);
    assert!(depth().all(|edge| edge.median.abs() <= 8.0));
    assert!(of_class(Class::ActiveStereo).iter().all(|case| case.depth == "active-stereo"));
}

#[test]
fn edges_of_structured_light_are_eroded_behind_a_gap() {
    let found = outlines_of(Class::StructuredLight);
    let depth = || found.iter().filter(|o| o.depth.is_some());
    assert!(depth().count() >= 3);
    assert!(mean(depth().map(|o| o.depth.unwrap().median)) <= -0.6);
    assert!(mean(depth().map(|o| o.gap.unwrap()[0])) >= 1.0);
    assert!(mean(depth().map(|o| o.mixed.unwrap())) <= 0.1);
}

#[test]
fn edges_of_time_of_flight_and_of_models_are_mixed() {
    for (class, gap) in [(Class::TimeOfFlight, 2.0), (Class::PredictedDepth, 0.1)] {
        let found = outlines_of(class);
        let depth = || found.iter().filter(|o| o.depth.is_some());
        assert!(depth().count() >= 3, "{class:?}");
        assert!(mean(depth().map(|o| o.mixed.unwrap())) >= 0.1, "{class:?}");
        assert!(mean(depth().map(|o| o.gap.unwrap()[0])) <= gap, "{class:?}");
    }
}

#[test]
fn masks_of_networks_and_annotators_are_right_within_about_a_pixel_and_not_evenly() {
    for (class, kind) in [(Class::NetworkMask, "network-mask"), (Class::AnnotatedMask, "annotated-mask")] {
        assert!(of_class(class).iter().all(|case| case.mask == kind && case.tags.contains(&kind)));
        let found = outlines_of(class);
        let masks = || found.iter().filter_map(|o| o.mask);
        assert!(mean(masks().map(|mask| mask.median.abs())) <= 1.0, "{class:?}");
        assert!(mean(masks().map(|mask| mask.spread)) >= 0.25, "{class:?}");
        assert!(masks().all(|mask| mask.median.abs() <= 2.5), "{class:?}");
    }
}

#[test]
fn masks_of_all_sets_but_one_are_mostly_of_networks_and_annotators() {
    let kinds = |set: CaseSet| -> Vec<&str> {
        let set = EvaluationSet::new(7).of(set);
        (0..36).map(|index| set.case(index).unwrap().mask).collect()
    };
    assert!(kinds(CaseSet::Dilated).iter().all(|kind| *kind == "uniform-mask"));
    let general = kinds(CaseSet::General);
    let count = |kind: &str| general.iter().filter(|k| **k == kind).count();
    assert!(count("uniform-mask") <= 5, "{general:?}");
    assert!(count("network-mask") >= 12 && count("annotated-mask") >= 6, "{general:?}");
    // The same objects, seen from the same places: only what a mask or a depth map leaves too little of is drawn again.
    let [new, old] = [CaseSet::General, CaseSet::Dilated].map(|set| EvaluationSet::new(7).of(set));
    let same = (0..36).filter(|&index| new.case(index).unwrap().object == old.case(index).unwrap().object).count();
    assert!(same >= 30, "{same} of 36");
}
