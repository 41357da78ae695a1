//! What came of a pair under a method, as it is kept in a file.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::Path;
use std::sync::Mutex;

use serde::{Deserialize, Serialize};

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
    pub translation_m: Option<f64>,
    pub rmse_m: Option<f64>,
    pub error: Option<String>,
    pub seconds: Option<f64>,
    /// Column by column.
    pub matrix: Option<[f64; 16]>,
}

/// Records of earlier runs, and the file that new ones are appended to.
pub struct Records {
    known: BTreeMap<(String, String), Record>,
    file: Option<Mutex<File>>,
}

impl Records {
    pub fn open(path: Option<&Path>) -> Result<Self, String> {
        let Some(path) = path else { return Ok(Self { known: BTreeMap::new(), file: None }) };
        let failed = |error: std::io::Error| format!("{}: {error}", path.display());
        let text = if path.is_file() { std::fs::read_to_string(path).map_err(failed)? } else { String::new() };
        // A line that was cut off when a run was stopped is run again.
        let records = text.lines().filter_map(|line| serde_json::from_str::<Record>(line).ok());
        let known = records.map(|record| ((record.id.clone(), record.method.clone()), record)).collect();
        let mut file = OpenOptions::new().create(true).append(true).open(path).map_err(failed)?;
        if !text.is_empty() && !text.ends_with('\n') {
            writeln!(file).map_err(failed)?;
        }
        Ok(Self { known, file: Some(Mutex::new(file)) })
    }

    pub fn get(&self, id: &str, method: &str) -> Option<&Record> {
        self.known.get(&(id.to_owned(), method.to_owned()))
    }

    pub fn append(&self, record: &Record) -> Result<(), String> {
        let Some(file) = &self.file else { return Ok(()) };
        let line = serde_json::to_string(record).map_err(|error| error.to_string())?;
        let mut file = file.lock().map_err(|error| error.to_string())?;
        writeln!(file, "{line}").map_err(|error| error.to_string())
    }
}
