//! A file of records that a run adds to, and that a run after a broken one goes on with: JSON, one record a line.

use std::collections::BTreeSet;
use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Seek, SeekFrom, Write};
use std::path::Path;
use std::sync::Mutex;

use serde_json::{Value, json};

use super::benchmark::Record;
use crate::error::{Error, ErrorCode, Result};

/// What tells a record from all others: the row, its options as they were written, and the case.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct RecordKey {
    /// The row's name.
    pub row: String,
    /// The row's options: under other options a row of the same name is another one.
    pub options: String,
    /// The case.
    pub case: String,
}

/// The file, open for more.
#[derive(Debug)]
pub struct RecordFile {
    file: Mutex<File>,
    path: String,
    done: BTreeSet<RecordKey>,
}

impl RecordFile {
    /// Opens a file, and creates it where there is none. A last line that was cut off is removed.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidArgument`] where the file can't be read or written; [`ErrorCode::CorruptFile`] for a whole
    /// line that is no record.
    pub fn open(path: &Path) -> Result<Self> {
        let name = path.display().to_string();
        let failed = |error| unusable(&name, &error);
        let mut options = OpenOptions::new();
        let mut file = options.read(true).write(true).create(true).truncate(false).open(path).map_err(failed)?;
        let mut done = BTreeSet::new();
        let mut whole = 0;
        let mut reader = BufReader::new(&file);
        let mut line = Vec::new();
        while reader.read_until(b'\n', &mut line).map_err(failed)? > 0 && line.ends_with(b"\n") {
            done.insert(key_of(&line).ok_or_else(|| {
                let found = format!("another line after {} records", done.len());
                let remedy = "Name another file, or remove this one.";
                Error::new(ErrorCode::CorruptFile, name.clone(), found, "one record a line", remedy)
            })?);
            whole += line.len() as u64;
            line.clear();
        }
        file.set_len(whole).map_err(failed)?;
        file.seek(SeekFrom::End(0)).map_err(failed)?;
        Ok(Self { file: Mutex::new(file), path: name, done })
    }

    /// Whether a record was there when the file was opened.
    pub fn has(&self, key: &RecordKey) -> bool {
        self.done.contains(key)
    }

    /// Adds a record; it is in the file when this returns.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidArgument`] where it can't be written.
    pub fn add(&self, key: &RecordKey, record: &Record) -> Result<()> {
        let line = json!({ "row": key.row, "options": key.options, "case": key.case, "record": record });
        let line = format!("{line}\n");
        // A thread that panicked wrote all of its line or, at the end of the file, part of one.
        let mut file = self.file.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        file.write_all(line.as_bytes()).map_err(|error| unusable(&self.path, &error))
    }
}

fn key_of(line: &[u8]) -> Option<RecordKey> {
    let line: Value = serde_json::from_slice(line).ok()?;
    let text = |name: &str| line.get(name)?.as_str().map(str::to_owned);
    line.get("record")?;
    Some(RecordKey { row: text("row")?, options: text("options")?, case: text("case")? })
}

fn unusable(name: &str, error: &std::io::Error) -> Error {
    let remedy = "Name a file in a folder that exists, on a disk that is not full.";
    let found = format!("a file system that says: {error}");
    Error::new(ErrorCode::InvalidArgument, name.to_owned(), found, "a file to read and write", remedy)
}
