//! A file of records (JSON lines) to which runs append, and from which an interrupted run resumes.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Seek, SeekFrom, Write};
use std::sync::Mutex;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::files::{corrupt, unwritable};
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
        let mut options = OpenOptions::new();
        let mut file = options.read(true).write(true).create(true).truncate(false).open(path).map_err(failed)?;
        let mut done = BTreeMap::new();
        let mut whole = 0;
        let mut reader = BufReader::new(&file);
        let mut line = Vec::new();
        while reader.read_until(b'\n', &mut line).map_err(failed)? > 0 && line.ends_with(b"\n") {
            let Line { key, record } = serde_json::from_slice(&line).map_err(|_| {
                corrupt(path, format!("another line after {} records", done.len()), "one record a line")
            })?;
            done.insert(key, record);
            whole += line.len() as u64;
            line.clear();
        }
        file.set_len(whole).map_err(failed)?;
        file.seek(SeekFrom::End(0)).map_err(failed)?;
        Ok(Self { file: Mutex::new(file), path: path.to_owned(), done })
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
