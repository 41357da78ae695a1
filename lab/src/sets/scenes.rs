//! Scenes of several objects on a desk, among clutter, in front of one camera.

use super::images::{OBJECT_STREAM, SCENE_STREAM, SIZE, image, object};
use super::single::MIN_MASK_PX;
use crate::case::Case;
use crate::conditions::{Conditions, PLAIN, RAGGED_MASK, Tier};
use crate::effects::generator::generate_any;
use crate::prelude::*;
use crate::world::view::{Rendering, View};
use crate::world::{World, unit};

/// Range of the distance of the middle of the objects, metres.
const DISTANCE_M: [f64; 2] = [0.5, 1.6];
/// Cameras that are tried before each arrangement.
const VIEWS: u64 = 12;
/// Minimum visible fraction of the silhouette of an object.
const LEAST_VISIBLE: f64 = 0.35;
/// The largest share of an object that the image's border cuts off, where it may.
const MOST_CUT: f64 = 0.2;
/// The largest share of an object without a reading.
const MOST_MISSING: f64 = 0.45;
/// The number of objects of a scene: of 50 scenes, 26 have four, 17 three and 7 two, which makes 338 of 100 scenes.
fn objects_of(index: usize) -> usize {
    match 21 * index % 50 {
        k if k < 26 => 4,
        k if k < 43 => 3,
        _ => 2,
    }
}

/// A scene; `None` if no camera shows enough of its objects.
pub fn draw(index: usize, seed: u64) -> Result<Option<Case>> {
    let world = World::desk(objects_of(index), &mut Random::new(seed, OBJECT_STREAM))?;
    let random = &mut Random::new(seed, SCENE_STREAM);
    // Every tenth scene or so may show an object that the border cuts.
    let too_near = chance(random, 0.1);
    for view in 0..VIEWS {
        let (renderings, together) = camera(&world, too_near, random)?.see(&world);
        if shows_enough(&world, &renderings, if too_near { MOST_CUT } else { 0.0 }, random)
            && let Some(case) = read(index, &world, (&renderings, &together), mixed([seed, view]))?
        {
            return Ok(Some(case));
        }
    }
    Ok(None)
}

/// A camera that looks at the objects on a desk, so close in some cases that the border may cut them.
fn camera(world: &World, too_near: bool, random: &mut Random) -> Result<View> {
    let mut camera = Pinhole::from_vertical_fov(between(random, 38.0, 60.0), SIZE[0], SIZE[1])?;
    camera.cx += between(random, -6.0, 6.0);
    camera.cy += between(random, -6.0, 6.0);
    // The share of the picture's height that the objects would take, were they a ball.
    let fill = between(random, 0.6, 1.15) * if too_near { 1.4 } else { 1.0 };
    let distance = 2.0 * world.reach * camera.fy / (fill * SIZE[1] as f64);
    let (rise, level) = libm::sincos(between(random, 9.0, 42.0).to_radians());
    let towards = (unit(world.front + between(random, -0.5, 0.5)) * level).extend(rise);
    let eye = world.center + towards * distance.clamp(DISTANCE_M[0], DISTANCE_M[1]);
    let mut aside = || between(random, -0.12, 0.12) * world.reach;
    let target = world.center + DVec3::new(aside(), aside(), aside());
    View::at(SIZE, camera, eye, target - eye, between(random, -4.0, 4.0).to_radians())
}

/// Whether the image shows enough of each object to determine its pose.
fn shows_enough(world: &World, renderings: &[Rendering], most_cut: f64, random: &mut Random) -> bool {
    let is_shown = |(rendering, placed): (&Rendering, _)| {
        rendering.visible_px() >= MIN_MASK_PX
            && rendering.visible_share() >= LEAST_VISIBLE
            && rendering.cut <= most_cut + 1e-9
            && rendering.shows_shape(placed, Tier::Hard)
            // A mug whose handle is out of sight: no case to count on, though one that occurs.
            && (rendering.shows_key(placed) || chance(random, 0.15))
    };
    renderings.iter().zip(&world.objects).all(is_shown)
}

/// Depth, masks and meshes of a view; `None` where they leave too little of an object.
fn read(
    index: usize,
    world: &World,
    (renderings, together): (&[Rendering], &Rendering),
    seed: u64,
) -> Result<Option<Case>> {
    let random = &mut Random::new(seed, SCENE_STREAM);
    let of_depth = Conditions { tier: Tier::draw(random), class: &PLAIN };
    let of_mask = |random: &mut Random| {
        let tier = Tier::draw(random);
        let is_ragged = tier != Tier::Easy && chance(random, 0.12);
        Conditions { tier, class: if is_ragged { &RAGGED_MASK } else { &PLAIN } }
    };
    let of_masks: Vec<Conditions> = renderings.iter().map(|_| of_mask(random)).collect();
    let made = image("frame_00".into(), world, (renderings, together), (of_depth, &of_masks), seed)?;
    let mut frame = made.frame;
    let mut objects = Vec::new();
    for (k, (rendering, placed)) in renderings.iter().zip(&world.objects).enumerate() {
        let pixels = frame.masks[k].iter().flat_map(|mask| mask.data()).filter(|m| **m != 0).count();
        if pixels < MIN_MASK_PX || made.missing[k] > MOST_MISSING {
            return Ok(None);
        }
        let seed = mixed([seed, k as u64]);
        let generated = generate_any(placed, rendering, seed)?;
        let family = placed.object.family;
        let (object, world_from_mesh) =
            object(format!("{k}-{family}"), family.into(), (placed, rendering), &generated, of_depth, seed)?;
        objects.push(object);
        frame.truths[k] = frame.truths[k].map(|camera_from_world| camera_from_world.compose(&world_from_mesh));
    }
    frame.visible = renderings.iter().map(Rendering::visible_share).fold(1.0, f64::min);
    let tier = match frame.visible {
        v if v > 0.85 => Tier::Easy,
        v if v > 0.6 => Tier::Medium,
        _ => Tier::Hard,
    };
    let tags = made.tags.into_iter().map(str::to_owned).collect();
    let name = format!("{index:03}");
    Ok(Some(Case { name, tier: tier.as_str().into(), tags, objects, frames: vec![frame] }))
}
