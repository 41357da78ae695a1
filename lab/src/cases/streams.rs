//! Random streams of the generated cases and scenes: one per part, so that a change to one part leaves the others
//! unchanged.

/// The object and its dimensions.
pub(crate) const OBJECT_STREAM: u64 = 1;
/// Camera and scene.
pub(crate) const SCENE_STREAM: u64 = 2;
/// Errors of the generated mesh.
pub(crate) const GENERATOR_STREAM: u64 = 3;
/// Errors of the depth map.
pub(crate) const READINGS_STREAM: u64 = 4;
/// Errors of the mask.
pub(crate) const MASK_STREAM: u64 = 5;
/// Effects of sensors.
pub(crate) const SENSOR_STREAM: u64 = 6;
/// Prints, photos, and the colours of generated meshes.
pub(crate) const COLOR_STREAM: u64 = 7;
/// Edges of the depth map.
pub(crate) const EDGE_STREAM: u64 = 8;
/// The set of exact depth for depth models.
pub(crate) const MONOCULAR_STREAM: u64 = 9;
/// Cluttered scenes: positions of objects and clutter, and the viewpoint.
pub(crate) const LAYOUT_STREAM: u64 = 17;
/// Cluttered scenes: number of objects per scene.
pub(crate) const COUNT_STREAM: u64 = 18;
/// Cluttered scenes: quality of mask, depth and mesh.
pub(crate) const QUALITY_STREAM: u64 = 19;
/// How objects are held.
pub(crate) const STANCE_STREAM: u64 = 32;
/// Simulated placements of generators.
pub(crate) const PLACEMENT_STREAM: u64 = 33;
