//! The shadow of a projector beside the camera: structured light and active stereo have no reading at points that only
//! the camera sees.

use super::scene::Scene;
use crate::prelude::*;
use sim3align_geometry::order::median;

/// Area of the shadow on the background as a share of the object's, which is its width as a share of the object's, in
/// the mean over rows.
pub const SHARES: [f64; 2] = [0.1, 0.4];
/// Longest baseline, as a share of the object's distance.
const LONGEST: f64 = 0.9;
/// Halvings of the interval of baselines.
const HALVINGS: usize = 9;
/// Minimum distance, as a share of the object's diagonal, between a point in the shadow and the surface in front of it:
/// more than the error of a rasterised depth on a slope.
const NEARER: f64 = 0.03;

/// A projector's shadow.
pub struct Shadow {
    /// Pixels that the projector does not see.
    pub dark: Vec<bool>,
    /// Area of the shadow on the background, as a share of the visible object's.
    pub share: f64,
    /// From the camera to the projector along the camera's x axis, metres.
    pub baseline_m: f64,
}

/// The object's shadow of a width within [`SHARES`], for a baseline that is solved for; `None` if nothing behind the
/// object is far enough for such a shadow.
pub fn cast(scene: &Scene, object: &Mesh, diagonal: f64, random: &mut Random) -> Result<Option<Shadow>> {
    let wanted = between(random, SHARES[0] + 0.02, SHARES[1] - 0.02);
    let side = sign(random);
    let Some(distance) = median(scene.object_depth.iter().copied().filter(|z| *z > 0.0)) else { return Ok(None) };
    let distance = f64::from(distance);
    let mut rasteriser = Rasteriser::new();
    let mut at = |baseline: f64| shadow(scene, object, (side * baseline, distance), NEARER * diagonal, &mut rasteriser);
    let [mut low, mut high] = [0.0, LONGEST * distance];
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if at(middle)?.share < wanted { low = middle } else { high = middle }
    }
    let shadow = at(0.5 * (low + high))?;
    Ok(Some(shadow).filter(|shadow| (SHARES[0]..=SHARES[1]).contains(&shadow.share)))
}

fn shadow(
    scene: &Scene,
    object: &Mesh,
    (baseline, distance): (f64, f64),
    nearer: f64,
    rasteriser: &mut Rasteriser,
) -> Result<Shadow> {
    let (width, height, camera) = (scene.width, scene.height, scene.camera);
    // The projector looks the same way, with the object at the same place in its image.
    let pose = &scene.camera_from_world;
    let beside = pose.translation - Vector3::new(baseline, 0.0, 0.0);
    let from_world = Similarity::from_parts(pose.scale, *pose.rotation.matrix(), beside)?;
    let shift = camera.fx * baseline / distance;
    let projector = Pinhole { cx: camera.cx + shift, ..camera };
    rasteriser.render_depth(object, &from_world, &projector, width, height);
    let lit = rasteriser.depth();
    let mut dark = vec![false; scene.depth.len()];
    let (mut background, mut visible) = (0usize, 0usize);
    for (i, &z) in scene.depth.iter().enumerate() {
        visible += usize::from(scene.visible[i]);
        if z <= 0.0 {
            continue;
        }
        let z = f64::from(z);
        // Both look along z, so the depth of a point is the same for both.
        let u = ((i % width) as f64 + shift - camera.fx * baseline / z).round();
        if u < 0.0 || u >= width as f64 {
            continue;
        }
        let first = f64::from(lit[i / width * width + u as usize]);
        dark[i] = first > 0.0 && first < z - nearer;
        background += usize::from(dark[i] && scene.object_depth[i] == 0.0);
    }
    Ok(Shadow { dark, share: background as f64 / visible.max(1) as f64, baseline_m: baseline })
}
