//! Puts a generated 3D mesh where it really is, at its real size, from one masked depth map:
//! the similarity x_cam = s·R·p + t, after "Robust 3D Alignment of Generative Reconstructions via Partial
//! Monocular Observations".
//!
//! The crate is layered; a module imports only from those below it in this list:
//! `bindings` and `samples`, `formats`, [`align`], [`metrics`] and `baselines`, [`stages`], [`geometry`], [`error`].

pub mod align;
#[cfg(feature = "baselines")]
pub mod baselines;
pub mod bindings;
pub mod error;
#[cfg(feature = "formats")]
pub mod formats;
pub mod geometry;
pub mod metrics;
pub mod number;
#[cfg(feature = "samples")]
pub mod samples;
pub mod stages;
