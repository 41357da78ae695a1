//! Cluttered scenes: two to four masked objects on a desk, close enough to hide each other, among things that nobody
//! asked for, before one camera, with one depth map; a hundred scenes hold 338 pairs of object and generated mesh.
//!
//! The form is that of the paper's benchmark (100 cluttered scenes, 338 pairs), the content procedural. Each pair comes
//! with two meshes of different failure styles, see [`Prior`]; depth, mask, camera and the object's true pose are the
//! same for both. A pair follows from the set's seed, its scene, its object and the prior alone. A scene that
//! shows too little of one of its objects is drawn again.

mod case;
mod clutter;
mod difficulty;
mod layout;
mod melt;
mod prior;
mod rest;
mod scene;
mod set;
mod view;
mod write;

pub use case::SceneCase;
pub use difficulty::{Sight, difficulty, tier};
pub use prior::Prior;
pub use scene::{ClutteredScene, ScenePair};
pub use set::SceneSet;

/// Metres per unit of the depth maps: fine enough for what is noise, and few bytes as a 16-bit image.
pub const DEPTH_SCALE: f64 = 0.0001;
/// Fewest pixels in a mask.
pub const MIN_MASK_PX: usize = 350;
/// The least share of an object's silhouette that is visible.
pub const LEAST_VISIBLE: f64 = 0.35;
/// Scenes of a set unless another number is asked for.
pub const SCENES: usize = 100;

/// Where things stand, which clutter there is, and from where the camera looks; evaluation's streams begin at 1.
const LAYOUT_STREAM: u64 = 17;
/// How many objects each scene has.
const COUNT_STREAM: u64 = 18;
/// How good mask, depth and mesh are.
const QUALITY_STREAM: u64 = 19;
