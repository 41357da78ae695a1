//! Case folders: images of objects, meshes and, optionally, the true poses, as the package's command line reads them too.

mod files;
pub mod read;
pub(crate) mod write;

pub use files::{PoseFile, parsed};
