//! Tracking of one object through a video: each pose starts at the one before, and the size sharpens over the frames.
//!
//! In: a mesh, and a [`Frame`](crate::evidence::frame::Frame) after the other, with or without a mask. Out: a
//! [`TrackedFrame`](report::TrackedFrame) each. A tracker keeps poses, size and motion, never images: its evidence of a frame,
//! it takes at once. A frame that fails must leave it usable.

pub mod detection;
pub mod evidence;
pub mod history;
pub mod local_search;
pub mod motion;
pub mod options;
pub mod report;
pub mod size;
pub mod tracker;
