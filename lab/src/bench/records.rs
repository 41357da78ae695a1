//! A file of records (JSON lines) to which runs append, and from which an interrupted run resumes.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{Seek, SeekFrom, Write};
use std::sync::Mutex;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::files::{corrupt, read, unwritable};
use crate::prelude::*;

/// The unique key of a record: the row, its options as written, and the case.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct RecordKey {
    /// Name of the row.
    pub row: String,
    /// Options of the row; rows with the same name and other options are different.
    pub options: String,
    /// The case.
    pub case: String,
}

/// A line of the file.
#[derive(Serialize, Deserialize)]
struct Line<T> {
    #[serde(flatten)]
    key: RecordKey,
    #[serde(flatten)]
    record: T,
}

/// A file of records, open for appending. Of several records of one key, the last is kept.
#[derive(Debug)]
pub struct RecordFile<T> {
    file: Mutex<File>,
    path: PathBuf,
    done: BTreeMap<RecordKey, T>,
}

impl<T: DeserializeOwned> RecordFile<T> {
    /// Opens a file, and creates it if necessary. A truncated last line is removed.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidArgument`] where the file can't be read or written; [`ErrorCode::CorruptFile`] for a whole
    /// line that is no record.
    pub fn open(path: &Path) -> Result<Self> {
        let failed = |error| unwritable(path, error);
        let mut file = OpenOptions::new().write(true).create(true).truncate(false).open(path).map_err(failed)?;
        let bytes = whole_lines(path)?;
        let done = Self::parsed(path, &bytes)?.into_iter().collect();
        file.set_len(bytes.len() as u64).map_err(failed)?;
        file.seek(SeekFrom::End(0)).map_err(failed)?;
        Ok(Self { file: Mutex::new(file), path: path.to_owned(), done })
    }

    /// All records of a file, several of one key included, but for a truncated last line.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidArgument`] where the file can't be read; [`ErrorCode::CorruptFile`] for a whole line that is
    /// no record.
    pub fn records(path: &Path) -> Result<Vec<(RecordKey, T)>> {
        Self::parsed(path, &whole_lines(path)?)
    }

    fn parsed(path: &Path, bytes: &[u8]) -> Result<Vec<(RecordKey, T)>> {
        let record = |(i, line)| {
            let read = serde_json::from_slice(line).map(|Line { key, record }| (key, record));
            read.map_err(|_| corrupt(path, format!("another line after {i} records"), "one record a line"))
        };
        bytes.split_inclusive(|byte| *byte == b'\n').enumerate().map(record).collect()
    }

    /// Whether a record was there when the file was opened.
    pub fn has(&self, key: &RecordKey) -> bool {
        self.done.contains_key(key)
    }

    /// The record, if it was there when the file was opened.
    pub fn get(&self, key: &RecordKey) -> Option<&T> {
        self.done.get(key)
    }

    /// Appends a record and flushes it to the file.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidArgument`] where it can't be written.
    pub fn add(&self, key: &RecordKey, record: &impl Serialize) -> Result<()> {
        self.add_all(key, core::slice::from_ref(record))
    }

    /// Appends the records of one key.
    ///
    /// # Errors
    /// As [`RecordFile::add`].
    pub fn add_all(&self, key: &RecordKey, records: &[impl Serialize]) -> Result<()> {
        let line = |record| serde_json::to_string(&Line { key: key.clone(), record }).map(|line| format!("{line}\n"));
        let lines: String = records
            .iter()
            .map(line)
            .collect::<Result<_, _>>()
            .map_err(|error: serde_json::Error| unwritable(&self.path, error.into()))?;
        // A thread that panicked wrote all of its lines or, at the end of the file, a part of them.
        let mut file = self.file.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        file.write_all(lines.as_bytes()).map_err(|error| unwritable(&self.path, error))
    }
}

fn whole_lines(path: &Path) -> Result<Vec<u8>> {
    let mut bytes = read(path)?;
    bytes.truncate(bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1));
    Ok(bytes)
}
