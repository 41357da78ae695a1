//! Where mask, depth and photo show the outline of an object, compared with the outline at the true pose: what sensors and
//! segmentation do, and what the generated cases have of it.

mod object;
mod ray;
mod silhouette;
pub mod table;
mod view;

pub use object::ObjectOutlines;
pub use view::{GroupBy, OutlineView};
