//! The exports of the joint module: several objects in one view, one object in several views, and through a video. Each reads
//! its arguments, calls the crate `sim3align`, and returns a plain object.

pub mod calibrate;
pub mod helper;
pub mod mesh;
pub mod scene;
pub mod track;
pub mod views;
