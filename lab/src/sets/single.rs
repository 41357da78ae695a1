//! Cases with one object on a table in front of a wall, with occluders and neighbours.

use super::images::{OBJECT_STREAM, SCENE_STREAM, image, object};
use crate::case::Case;
use crate::conditions::{Conditions, DepthFault, Framing, Tier};
use crate::effects::depth::FARTHEST_M;
use crate::effects::generator::{MESH_STREAM, generate};
use crate::objects::solid::Solid;
use crate::objects::{Object, Pool};
use crate::prelude::*;
use crate::world::view::{Rendering, View, count, shown};
use crate::world::{Placed, World, unit};

/// Minimum number of pixels of a mask, and of those with a reading.
pub const MIN_MASK_PX: usize = 350;
const LEAST_READINGS: usize = 250;
/// Maximum number of pixels of a tiny object.
const TINY_PX: usize = 1600;
/// Maximum number of occluders tried for the required occlusion.
const OCCLUDERS: usize = 12;

/// A case; `None` if it shows too little of the object, or not the property of its class.
pub fn draw(index: usize, seed: u64, conditions: Conditions) -> Result<Option<Case>> {
    let Conditions { tier, class } = conditions;
    let random = &mut Random::new(seed, OBJECT_STREAM);
    let drawn = Object::draw(conditions.pool(), random)?;
    let family = drawn.family;
    let placed = Placed::put_down(drawn, tier, random)?.printed(class.print, random);
    let (world, view) = staged(placed, conditions, &mut Random::new(seed, SCENE_STREAM))?;
    let (renderings, together) = view.see(&world);
    let (rendering, placed) = (&renderings[0], &world.objects[0]);
    if !shows_enough(rendering, placed, conditions) {
        return Ok(None);
    }
    let is_determined = placed.print.as_ref().is_none_or(|print| rendering.shows_turn(placed, print));
    if class.needs_color && !is_determined {
        return Ok(None);
    }
    let made = image("frame_00".into(), &world, (&renderings, &together), (conditions, &[conditions]), seed)?;
    let pixels = made.frame.masks[0].iter().flat_map(|mask| mask.data()).zip(made.frame.depth.data());
    let mask_px = pixels.clone().filter(|(m, _)| **m != 0).count();
    let readings = pixels.filter(|(m, z)| **m != 0 && **z > 0.0).count();
    let is_missing = made.missing[0] > tier.pick(0.1, 0.25, 0.4) || readings < LEAST_READINGS;
    if is_missing || mask_px < MIN_MASK_PX || (class.framing == Framing::Tiny && mask_px > TINY_PX) {
        return Ok(None);
    }
    let generated = generate(placed, rendering, conditions, &mut Random::new(seed, MESH_STREAM))?;
    let (object, world_from_mesh) =
        object(family.into(), class.name.into(), (placed, rendering), &generated, conditions, seed)?;
    let mut frame = made.frame;
    let View { width, height, .. } = view;
    frame.exact = Some(DepthMap::from_metres(width, height, together.depth)?);
    frame.truths[0] = frame.truths[0].map(|camera_from_world| camera_from_world.compose(&world_from_mesh));
    let tags = made.tags.into_iter().chain(generated.tags).map(str::to_owned).collect();
    Ok(Some(Case {
        name: format!("{index:04}-{}-{}-{family}", tier.as_str(), class.name),
        tier: tier.as_str().into(),
        tags,
        objects: vec![object],
        frames: vec![frame],
    }))
}

/// Whether the image shows enough of the object, and the property of the class.
fn shows_enough(rendering: &Rendering, placed: &Placed, Conditions { tier, class }: Conditions) -> bool {
    let shows_class = match class.framing {
        Framing::Occluded => rendering.hidden >= tier.pick(0.0, 0.05, 0.08),
        Framing::BorderCut => (0.04..=0.25).contains(&rendering.cut),
        Framing::Free | Framing::Tiny => rendering.cut < 1e-9,
    };
    let least = tier.pick(0.95, 0.75, 0.55);
    // An image without the part that determines the orientation is no case to count on, though one that occurs.
    let shows_key = tier == Tier::Hard && class.depth_fault != DepthFault::HolesOfMask || rendering.shows_key(placed);
    shows_class
        && shows_key
        && rendering.visible_px() >= MIN_MASK_PX
        && rendering.visible_share() >= least
        && rendering.shows_shape(placed, tier)
        && rendering.object_depth.iter().all(|z| f64::from(*z) <= FARTHEST_M)
}

/// The world about an object, and a camera.
fn staged(placed: Placed, conditions: Conditions, random: &mut Random) -> Result<(World, View)> {
    let Conditions { tier, class } = conditions;
    let size = match random.uniform() {
        w if w < 0.82 => [640, 480],
        w if w < 0.94 => [1280, 720],
        _ => [1920, 1080],
    };
    let [width, height] = size.map(|side| side as f64);
    let focal = between(random, 0.7, 1.3) * width;
    let mut off = |middle: f64| 0.5 * middle - 0.5 + between(random, -0.01, 0.01) * width;
    let camera = Pinhole::new(focal, focal, off(width), off(height))?;
    let front = TAU * random.uniform();
    let diagonal = placed.object.diagonal();
    let behind = diagonal * between(random, 0.1, 4.0);
    let mut world = World::new(vec![placed], Vec::new(), front, behind);

    let (low, high) = tier.pick((180.0, 380.0), (130.0, 340.0), (90.0, 340.0));
    let low = if class.pool == Some(Pool::Thin) { 1.4 * low } else { low };
    let mut span =
        if class.framing == Framing::Tiny { 50.0 } else { between(random, low, high) * libm::pow(width / 640.0, 0.8) };
    let elevation = tier.pick((15.0, 50.0), (8.0, 65.0), (5.0, 80.0));
    let (rise, level) = libm::sincos(between(random, elevation.0, elevation.1).to_radians());
    let towards = (unit(front) * level).extend(rise);
    let roll = between(random, -1.0, 1.0) * tier.pick(3.0f64, 8.0, 20.0).to_radians();
    let aim = aim(random, class.framing == Framing::BorderCut, span, [width, height]);
    // From the distance at which the diagonal of the object spans so many pixels.
    let view_at = |span: f64| {
        let eye = world.center + towards * (focal * diagonal / span);
        View::at(size, camera, eye, -towards, roll)?.aimed(aim)
    };
    if class.framing == Framing::Tiny {
        let wanted = between(random, 430.0, 1400.0);
        span *= (wanted / count(&view_at(span)?.depth_of(&world.objects[0].mesh)).max(1) as f64).sqrt();
    }
    let view = view_at(span)?;
    let mut solid = Solid::default();
    for _ in 0..random.below(tier.pick(2, 3, 5)) {
        let size = diagonal * between(random, 0.12, 0.4);
        let angle = front + sign(random) * between(random, 75.0, 180.0).to_radians();
        let spot = unit(angle) * (world.reach + 1.5 * size + diagonal * between(random, 0.0, 0.6));
        solid.block(spot.extend(0.0), 0.0, size, diagonal * between(random, 0.2, 0.9), random);
    }
    let solid = occluded(solid, &view, &world.objects[0].mesh, (conditions, span), random)?;
    if !solid.is_empty() {
        world.others.push(solid.finish()?.0);
    }
    Ok((world, view))
}

/// Neighbours with something in front of the object, if its conditions ask for that.
fn occluded(
    solid: Solid,
    view: &View,
    mesh: &Mesh,
    (Conditions { tier, class }, span): (Conditions, f64),
    random: &mut Random,
) -> Result<Solid> {
    let wanted = match (tier, class.framing) {
        (Tier::Medium, Framing::Occluded) => [0.06, 0.22],
        (Tier::Hard, Framing::Occluded) => [0.1, 0.4],
        (Tier::Medium, _) if chance(random, 0.15) => [0.0, 0.1],
        (Tier::Hard, _) if chance(random, 0.25) => [0.0, 0.15],
        _ => return Ok(solid),
    };
    let object = view.depth_of(mesh);
    let pixels: Vec<usize> = (0..object.len()).filter(|&i| object[i] > 0.0).collect();
    for _ in 0..OCCLUDERS {
        let mut candidate = solid.clone();
        if let Some(&pixel) = pixels.get(random.below(pixels.len().max(1))) {
            let z = object[pixel] * between(random, 0.6, 0.88) as f32;
            let spot = view.world_point(&view.camera_from_world.inverse(), pixel, z);
            let size = between(random, 0.06, 0.24) * span * f64::from(z) / view.camera.fx;
            if chance(random, 0.6) && spot.z > 0.3 * size {
                let height = spot.z + between(random, 0.0, 1.0) * size;
                candidate.block(spot.with_z(0.0), 0.0, size, height, random);
            } else {
                // A hand, a branch, the arm of a robot.
                let (lean, length) = (between(random, 0.2, 1.5), size * between(random, 2.0, 6.0));
                candidate.block(spot, lean, size, length, random);
            }
        }
        if candidate.is_empty() {
            continue;
        }
        let visible = shown(&object, &view.depth_of(&candidate.clone().finish()?.0));
        let left = visible.iter().filter(|visible| **visible).count();
        let hidden = 1.0 - left as f64 / pixels.len().max(1) as f64;
        if (wanted[0]..=wanted[1]).contains(&hidden) {
            return Ok(candidate);
        }
    }
    Ok(solid)
}

/// The target pixel of the centre: inside the image, or such that the border cuts the object.
fn aim(random: &mut Random, is_cut: bool, span: f64, [width, height]: [f64; 2]) -> [f64; 2] {
    let mut within = |size: f64| {
        let margin = (0.5 * span + 4.0).min(0.5 * size);
        between(random, margin, size - margin)
    };
    let [u, v] = [within(width), within(height)];
    if !is_cut {
        return [u, v];
    }
    let beside = between(random, 0.02, 0.34) * span;
    match random.below(4) {
        0 => [beside, v],
        1 => [width - beside, v],
        2 => [u, beside],
        _ => [u, height - beside],
    }
}
