//! What warnings say about poses.

use sim3align::report::{AnyAlignment, Warning, WarningCode};
use sim3align_lab::bench::benchmark::{BenchCase, Record, STRICT, run_case};
use sim3align_lab::bench::warning_tally::{Tally, WarningTally};
use sim3align_lab::cases::case::EvaluationSet;
use sim3align_lab::prelude::*;

/// The record with these warnings, and with an error of scale that makes it wrong or not.
fn with(record: &Record, is_right: bool, codes: &[WarningCode]) -> Record {
    let mut record = record.clone();
    let Some(AnyAlignment::Precise(found)) = &mut record.alignment else { panic!("no alignment") };
    found.warnings = codes.iter().map(|&code| Warning { code, message: String::new() }).collect();
    if let Some(errors) = &mut record.errors {
        errors.scale_error = if is_right { 0.0 } else { 2.0 * STRICT.scale };
    }
    record
}

#[test]
fn warnings_are_tallied_by_whether_the_pose_is_wrong() {
    let case = BenchCase::from(EvaluationSet::new(3).case(0).unwrap());
    let record = run_case(&case, &AlignOptions { quality: Quality::Fast, ..AlignOptions::default() }.into(), &[]);
    assert_eq!(record.success(&STRICT), Some(true));
    let (sparse, border) = (WarningCode::SparseDepth, WarningCode::MaskTouchesBorder);
    let failed = Record { alignment: None, errors: None, ..with(&record, false, &[]) };
    let unknown = Record { truth_metrics: None, ..with(&record, false, &[WarningCode::MeshDoubtful]) };
    let records = [
        with(&record, true, &[sparse]),
        // A code twice counts once.
        with(&record, false, &[border, sparse, sparse]),
        with(&record, false, &[sparse]),
        with(&record, true, &[]),
        failed,
        unknown,
    ];
    let tallies = WarningTally::of(&records.iter().collect::<Vec<_>>());
    let expected = [
        (sparse, Tally { poses: 3, wrong: 2 }, Tally { poses: 1, wrong: 0 }),
        (border, Tally { poses: 1, wrong: 1 }, Tally { poses: 3, wrong: 1 }),
    ];
    assert_eq!(tallies, expected.map(|(code, with, without)| WarningTally { code, with, without }));
    assert_eq!(tallies[1].without.wrong_percent().map(f64::round), Some(33.0));
    assert_eq!(Tally::default().wrong_percent(), None);
    assert!(WarningTally::of(&[]).is_empty());
}
