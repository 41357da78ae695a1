//! What a depth model gives for a photo of objects: depth maps with the errors of such models, made of depth with a known
//! truth, and how well objects are aligned with them.

pub mod calibration;
mod faults;
pub mod filling;
pub mod picture;
pub mod prediction;
pub mod reading;
pub mod record;
pub mod row;
pub mod runs;
mod smoothing;
pub mod table;
