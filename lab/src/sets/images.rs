//! The chain of effects that turns a view of a world into an image, and an object into a mesh.

use std::sync::Arc;

use crate::case::{CaseFrame, CaseObject};
use crate::conditions::Conditions;
use crate::effects::depth;
use crate::effects::generator::Generated;
use crate::effects::mask::mask_of;
use crate::effects::painter::paint;
use crate::effects::photo::take;
use crate::objects::mesh::{canonicalise, declared};
use crate::prelude::*;
use crate::world::view::{Rendering, View};
use crate::world::{Placed, World};
use sim3align_geometry::order::median;

/// Image size of scenes and videos.
pub const SIZE: [usize; 2] = [640, 480];

/// Random streams of the parts of a case, besides that of the mesh: a change to one part leaves the others unchanged.
pub const OBJECT_STREAM: u64 = 1;
pub const SCENE_STREAM: u64 = 2;
const DEPTH_STREAM: u64 = 4;
const MASK_STREAM: u64 = 5;
const FAULT_STREAM: u64 = 6;
const COLOR_STREAM: u64 = 7;

/// An image of a world.
pub struct Made {
    /// The image; its true poses are those of the objects in the world, `camera_from_world`.
    pub frame: CaseFrame,
    /// Names of the simulated errors.
    pub tags: Vec<&'static str>,
    /// Missing share of the readings of each object, before the faults of its class.
    pub missing: Vec<f64>,
}

/// The image that a view shows. `renderings` has the image of each object, `together` that of all as one; `of_depth` has the
/// conditions of depth, `of_masks` those of the mask of each object.
pub fn image(
    name: String,
    world: &World,
    (renderings, together): (&[Rendering], &Rendering),
    (of_depth, of_masks): (Conditions, &[Conditions]),
    seed: u64,
) -> Result<Made> {
    let view: &View = &together.view;
    let things: Vec<&[bool]> = renderings.iter().map(|rendering| rendering.visible.as_slice()).collect();
    let diagonals = world.objects.iter().map(|placed| placed.object.diagonal() as f32);
    let diagonal = f64::from(median(diagonals).unwrap_or_default());
    let random = &mut Random::new(seed, DEPTH_STREAM);
    let mut readings = depth::read(together, &things, diagonal, of_depth, random)?;
    let missing = things.iter().map(|shown| readings.missing(shown)).collect();
    let (mut masks, mut tags) = (Vec::new(), Vec::new());
    for (k, (rendering, placed)) in renderings.iter().zip(&world.objects).enumerate() {
        let random = &mut Random::new(mixed([seed, k as u64]), MASK_STREAM);
        let (mut mask, own) = mask_of(rendering, of_masks[k], random)?;
        let random = &mut Random::new(mixed([seed, k as u64]), FAULT_STREAM);
        readings.afflict(&mut mask, rendering, placed, of_depth, random);
        masks.push(Some(mask));
        tags.extend(own);
    }
    // A map with a metric of its own, whose warp moves each object by a share of it: along the rays, so that its picture
    // stays the same.
    let truth = |drift: &f64| {
        let metric = Similarity { scale: readings.bias * (1.0 + drift), ..Similarity::identity() };
        Some(metric.compose(&view.camera_from_world))
    };
    let truths = readings.drifts.iter().map(truth).collect();
    let random = &mut Random::new(seed, COLOR_STREAM);
    let printed = world.objects.first().and_then(|placed| Some((placed, placed.print.as_ref()?)));
    let photo =
        printed.map(|(placed, print)| take(&renderings[0], (&placed.mesh, print), of_depth, random)).transpose()?;
    tags.extend(readings.tags);
    let frame = CaseFrame {
        name,
        depth: readings.depth,
        exact: None,
        camera: view.camera,
        photo: photo.map(Arc::new),
        world_from_camera: Some(view.camera_from_world.inverse()),
        masks,
        truths,
        visible: 1.0 - renderings.first().map_or(0.0, |rendering| rendering.hidden),
    };
    Ok(Made { frame, tags, missing })
}

/// The object of a case with the mesh that a generator made of it, and the true pose of the mesh in the world.
pub fn object(
    name: String,
    class: String,
    (placed, rendering): (&Placed, &Rendering),
    generated: &Generated,
    conditions: Conditions,
    seed: u64,
) -> Result<(CaseObject, Similarity)> {
    let random = &mut Random::new(seed, COLOR_STREAM + 1);
    let (mesh, world_from_mesh) = canonicalise(&generated.mesh, seed)?;
    let eye = rendering.view.eye();
    let colors =
        placed.print.as_ref().map(|print| paint(&mesh, &world_from_mesh, (placed, print), eye, conditions, random));
    let needs_color = conditions.class.needs_color;
    let symmetry = if needs_color { Symmetry::None } else { declared(&placed.symmetry, &world_from_mesh) };
    let colors = colors.transpose()?;
    Ok((CaseObject { name, class, mesh, surplus: None, colors, symmetry, initial: None }, world_from_mesh))
}
