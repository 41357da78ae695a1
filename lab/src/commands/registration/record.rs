//! What came of a pair under a method, as it is kept in a file.

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
