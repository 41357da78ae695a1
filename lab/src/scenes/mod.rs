//! Cluttered scenes: two to four masked objects on a desk that occlude each other, among other things, in front of one
//! camera, with one depth map. A hundred scenes contain 338 pairs of an object and a generated mesh.
//!
//! The form follows the benchmark of the paper (100 cluttered scenes, 338 pairs); the content is procedural. Each pair
//! has two meshes with different kinds of errors, see [`Prior`]; depth, mask, camera and the true pose of the object
//! are the same for both. A pair depends on the seed of the set, its scene, its object and the prior alone. A scene
//! that shows too little of one of its objects is drawn again.

mod arranged;
mod bop_folder;
mod clutter;
mod difficulty;
mod folder;
mod heap;
mod layout;
mod melt;
mod prior;
mod scene;
mod set;
mod underside;
mod view;

pub use bop_folder::write_bop;
pub use difficulty::{Sight, difficulty, tier};
pub use heap::Below;
pub use layout::Stance;
pub use prior::Prior;
pub use scene::{ClutteredScene, DEPTH_SCALE, LEAST_VISIBLE, MIN_MASK_PX, ScenePair};
pub use set::{SCENES, SceneSet};
