//! A file of results (JSON lines) to which runs append, and from which an interrupted run resumes.

use std::fs::{File, OpenOptions};
use std::io::Write;
use std::sync::{Mutex, PoisonError};

use serde::{Deserialize, Serialize};

use super::result::ResultRow;
use super::row::Row;
use crate::files::{corrupt, read, unwritable};
use crate::prelude::*;

/// A line of the file.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Record {
    /// Name of the row.
    pub row: String,
    /// Options of the row, as written; rows with the same name and other options are different.
    options: String,
    /// The source of the case.
    case: String,
    /// A result.
    #[serde(flatten)]
    pub result: ResultRow,
}

impl Record {
    /// A record of a row for a case.
    pub fn new(row: &Row, case: &str, result: ResultRow) -> Self {
        Self { row: row.name.clone(), options: row.text.clone(), case: case.into(), result }
    }
}

/// A file of records, open for appending.
#[derive(Debug)]
pub struct RecordFile {
    file: Mutex<File>,
    path: PathBuf,
    /// The records that were there when the file was opened.
    pub before: Vec<Record>,
}

impl RecordFile {
    /// Opens a file, and creates it if necessary. A truncated last line is removed.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidArgument`] where the file can't be read or written; [`ErrorCode::CorruptFile`] for a whole
    /// line that is no record.
    pub fn open(path: &Path) -> Result<Self> {
        let failed = |error| unwritable(path, error);
        let file = OpenOptions::new().append(true).create(true).open(path).map_err(failed)?;
        let mut bytes = read(path)?;
        bytes.truncate(bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1));
        file.set_len(bytes.len() as u64).map_err(failed)?;
        let parsed =
            |line| serde_json::from_slice(line).map_err(|_| corrupt(path, "another line", "one record a line"));
        let before = bytes.split_inclusive(|byte| *byte == b'\n').map(parsed).collect::<Result<_>>()?;
        Ok(Self { file: Mutex::new(file), path: path.to_owned(), before })
    }

    /// Whether there were records of a row for a case when the file was opened.
    pub fn has(&self, row: &Row, case: &str) -> bool {
        self.before.iter().any(|known| known.case == case && known.row == row.name && known.options == row.text)
    }

    /// Appends records.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidArgument`] where they can't be written.
    pub fn add(&self, records: &[Record]) -> Result<()> {
        let line = |record| serde_json::to_string(record).map(|line| format!("{line}\n"));
        let lines: serde_json::Result<String> = records.iter().map(line).collect();
        let lines = lines.map_err(|error| unwritable(&self.path, error.into()))?;
        // A thread that panicked wrote all of its lines or, at the end of the file, a part of them.
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        file.write_all(lines.as_bytes()).map_err(|error| unwritable(&self.path, error))
    }
}
