//! Tracking of one object through a video: each pose starts at the one before, and the size sharpens over the frames.

pub mod detection;
pub mod evidence;
pub mod history;
pub mod motion;
pub mod options;
pub mod report;
pub mod sight;
pub mod size;
pub mod tracker;
