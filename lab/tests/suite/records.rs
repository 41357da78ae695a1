//! Files of records: what a killed run leaves behind, another one goes on with.

use std::fs;

use serde::de::IgnoredAny;
use sim3align_lab::bench::benchmark::{BenchCase, Record, run_case};
use sim3align_lab::bench::records::{RecordFile, RecordKey};
use sim3align_lab::cases::case::EvaluationSet;
use sim3align_lab::prelude::*;

use crate::common::fresh;

fn key(row: &str, case: &str) -> RecordKey {
    RecordKey { row: row.into(), options: "quality=fast".into(), case: case.into() }
}

fn record() -> Record {
    let case = BenchCase::from(EvaluationSet::new(3).case(0).unwrap());
    run_case(&case, &AlignOptions { quality: Quality::Fast, ..AlignOptions::default() }.into(), &[])
}

#[test]
fn what_is_there_is_not_asked_for_again() {
    let path = fresh("records-resume");
    let record = record();
    let file = RecordFile::<IgnoredAny>::open(&path).unwrap();
    assert!(!file.has(&key("a", "1")));
    file.add(&key("a", "1"), &record).unwrap();
    file.add(&key("a", "2"), &record).unwrap();
    drop(file);

    // Killed in the middle of a line.
    let whole = fs::read(&path).unwrap();
    let end_of_first = whole.iter().position(|byte| *byte == b'\n').unwrap() + 1;
    for cut in [end_of_first + 1, (end_of_first + whole.len()) / 2, whole.len() - 1] {
        fs::write(&path, &whole[..cut]).unwrap();
        let file = RecordFile::<IgnoredAny>::open(&path).unwrap();
        assert!(file.has(&key("a", "1")) && !file.has(&key("a", "2")), "cut at {cut}");
        assert!(!file.has(&key("b", "1")));
        assert!(!file.has(&RecordKey { options: "quality=best".into(), ..key("a", "1") }));
        file.add(&key("a", "2"), &record).unwrap();
        assert_eq!(fs::read(&path).unwrap(), whole, "cut at {cut}");
    }
    fs::remove_file(&path).unwrap();
}

#[test]
fn a_line_is_the_record_as_it_is() {
    let path = fresh("records-line");
    let record = record();
    RecordFile::<IgnoredAny>::open(&path).unwrap().add(&key("a", "1"), &record).unwrap();
    let line: serde_json::Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    // Both read from text, where the last bit of a number may be lost.
    let written = serde_json::to_string(&record).unwrap();
    assert_eq!(line["record"], serde_json::from_str::<serde_json::Value>(&written).unwrap());
    assert_eq!((&line["row"], &line["case"]), (&"a".into(), &"1".into()));
    fs::remove_file(&path).unwrap();
}

#[test]
fn what_is_no_file_of_records_is_left_alone() {
    let path = fresh("records-other");
    for content in ["a text\n", "{\"row\":\"a\"}\n", "{\"row\":\"a\",\"options\":\"\",\"case\":\"1\"}\n", "\n"] {
        fs::write(&path, content).unwrap();
        assert_eq!(RecordFile::<IgnoredAny>::open(&path).unwrap_err().code, ErrorCode::CorruptFile, "{content:?}");
        assert_eq!(fs::read_to_string(&path).unwrap(), content);
    }
    fs::remove_file(&path).unwrap();
    let nowhere = path.join("below").join("nothing");
    assert_eq!(RecordFile::<IgnoredAny>::open(&nowhere).unwrap_err().code, ErrorCode::InvalidArgument);
}
