//! Videos of one object on a table.

use super::images::{OBJECT_STREAM, SCENE_STREAM, SIZE, image, object};
use crate::case::{Case, CaseFrame, CaseObject};
use crate::conditions::{Class, Conditions, SPARSE_SENSOR, Tier, WARPED_IN_VIDEO};
use crate::effects::generator::{MESH_STREAM, generate};
use crate::effects::noise::disc;
use crate::objects::solid::Solid;
use crate::objects::{Object, Pool};
use crate::prelude::*;
use crate::world::view::{Rendering, View};
use crate::world::{Placed, World, unit};

/// Distance of the wall: too far for a reading.
const WALL_M: f64 = 50.0;
/// Fewest visible pixels of the object in the first frame.
const VIDEO_PX: usize = 2500;

named! {
    /// Kinds of video.
    pub enum Motion {
        /// A camera in a hand, which moves to and fro.
        HandHeld = "hand-held",
        /// An object on a turntable.
        Turntable = "turntable",
        /// Hand-held, with things that pass between camera and object.
        Occluders = "occluders",
        /// Hand-held, with the object leaving the image and coming back.
        Leaving = "leaving",
        /// Hand-held and fast: frames in which most of the depth is missing.
        Blur = "blur",
        /// Hand-held, with some frames left out.
        Dropped = "dropped-frames",
    }
}

/// An object on a table that cameras look at from all sides.
struct Stage {
    world: World,
    camera: Pinhole,
    /// The distance at which the object spans 150 to 280 pixels.
    distance: f64,
    conditions: Conditions,
}

impl Stage {
    fn draw(tier: Tier, class: &'static Class, random: &mut Random) -> Result<Self> {
        let placed = Placed::put_down(Object::draw(Pool::All, random)?, tier, random)?;
        let [width, height] = SIZE.map(|side| side as f64);
        let focal = between(random, 0.8, 1.1) * width;
        let camera = Pinhole::new(focal, focal, 0.5 * width - 0.5, 0.5 * height - 0.5)?;
        let diagonal = placed.object.diagonal();
        let distance = focal * diagonal / between(random, 150.0, 280.0);
        let mut solid = Solid::default();
        for _ in 0..random.below(3) {
            let spot = unit(TAU * random.uniform()) * (diagonal * between(random, 1.1, 2.0));
            let half = diagonal * between(random, 0.1, 0.3);
            solid.at(DAffine3::from_translation(spot.extend(half))).cuboid(DVec3::splat(half), 0.05 * half);
        }
        let others = if solid.is_empty() { Vec::new() } else { vec![solid.finish()?.0] };
        let world = World::new(vec![placed], others, 0.0, WALL_M);
        Ok(Self { world, camera, distance, conditions: Conditions { tier, class } })
    }

    fn diagonal(&self) -> f64 {
        self.world.objects[0].object.diagonal()
    }

    /// A camera at this heading and elevation, degrees, and this distance, that looks past the centre by an offset.
    fn look(&self, [heading, elevation, roll]: [f64; 3], distance: f64, past: DVec3) -> Result<View> {
        let (rise, level) = libm::sincos(elevation.to_radians());
        let eye = self.world.center + (unit(heading.to_radians()) * level).extend(rise) * distance;
        View::at(SIZE, self.camera, eye, self.world.center + past - eye, roll.to_radians())
    }

    fn see(&self, view: &View) -> (Rendering, Rendering) {
        let (mut renderings, together) = view.see(&self.world);
        (renderings.remove(0), together)
    }

    /// The object with the mesh that a generator makes from one image.
    fn object(&self, rendering: &Rendering, class: String, seed: u64) -> Result<(CaseObject, Similarity)> {
        let placed = &self.world.objects[0];
        let generated = generate(placed, rendering, self.conditions, &mut Random::new(seed, MESH_STREAM))?;
        object(placed.object.family.into(), class, (placed, rendering), &generated, self.conditions, seed)
    }

    fn frame(
        &self,
        name: String,
        (rendering, together): &(Rendering, Rendering),
        world_from_mesh: &Similarity,
        seed: u64,
    ) -> Result<CaseFrame> {
        let conditions = (self.conditions, &[self.conditions][..]);
        let renderings = core::slice::from_ref(rendering);
        let mut frame = image(name, &self.world, (renderings, together), conditions, seed)?.frame;
        frame.truths[0] = frame.truths[0].map(|camera_from_world| camera_from_world.compose(world_from_mesh));
        Ok(frame)
    }

    fn case(&self, name: String, object: CaseObject, frames: Vec<CaseFrame>) -> Case {
        let tier = self.conditions.tier.as_str().to_owned();
        Case { name: format!("{name}-{}", object.name), tier, tags: Vec::new(), objects: vec![object], frames }
    }
}

/// A smooth path from −1 to 1: a sum of three waves, each a frequency and a phase.
struct Path([[f64; 2]; 3]);

impl Path {
    fn draw(random: &mut Random, seconds: [f64; 2]) -> Self {
        Self([0; 3].map(|_| [1.0 / between(random, seconds[0], seconds[1]), TAU * random.uniform()]))
    }

    fn at(&self, time: f64) -> f64 {
        self.0.iter().map(|[frequency, phase]| libm::sin(TAU * frequency * time + phase)).sum::<f64>() / 3.0
    }
}

/// A video at 30 frames a second. Kinds of motion take turns, and after each turn the tiers; the mesh of hard ones has other
/// proportions than the object.
pub fn draw(index: usize, seed: u64, frames: usize) -> Result<Option<Case>> {
    let motion = Motion::ALL[index % Motion::ALL.len()];
    let tier = Tier::of(index / Motion::ALL.len());
    let class = if tier == Tier::Hard { &WARPED_IN_VIDEO } else { &SPARSE_SENSOR };
    let mut stage = Stage::draw(tier, class, &mut Random::new(seed, OBJECT_STREAM))?;
    let random = &mut Random::new(seed, SCENE_STREAM);
    let (heading, elevation) = (between(random, 0.0, 360.0), between(random, 25.0, 45.0));
    let turn = sign(random) * between(random, 20.0, 60.0);
    let seconds = if motion == Motion::Blur { [1.0, 2.5] } else { [2.0, 6.0] };
    let paths: Vec<Path> = (0..7).map(|_| Path::draw(random, seconds)).collect();
    let drift = between(random, -20.0, 20.0);
    let neighbours = stage.world.others.clone();
    let (mut made, mut all, mut first, mut time) = (None, Vec::new(), (0, 1.0), 0.0);
    for k in 0..frames {
        time += 1.0 / 30.0;
        if motion == Motion::Dropped && k > 0 && chance(random, 0.15) {
            time += (1 + random.below(3)) as f64 / 30.0;
        }
        let hand = |path: usize, by: f64| by * paths[path].at(time);
        let (angles, distance, past) = if motion == Motion::Turntable {
            ([heading + turn * time, elevation, 0.0], stage.distance, DVec3::ZERO)
        } else {
            let angles = [heading + drift * time + hand(0, 25.0), elevation + hand(1, 14.0), hand(2, 8.0)];
            let past = DVec3::new(hand(3, 0.2), hand(4, 0.2), hand(5, 0.15)) * stage.diagonal();
            (angles, stage.distance * (1.0 + hand(6, 0.15)), past)
        };
        // Out of the image and back within two seconds of every four.
        let cycle = time % 4.0;
        let is_away = motion == Motion::Leaving && cycle > 2.0;
        let away = if is_away { libm::sin(0.5 * PI * (cycle - 2.0)) } else { 0.0 };
        let view = stage.look(angles, distance, past + DVec3::Z * (away * 0.9 * stage.distance))?;
        if motion == Motion::Occluders {
            stage.world.others.clone_from(&neighbours);
            stage.world.others.extend(passing(&stage, &view, time)?);
        }
        let seen = stage.see(&view);
        if k == 0 {
            if seen.0.visible_px() < VIDEO_PX || seen.0.hidden > 0.1 {
                return Ok(None);
            }
            made = Some(stage.object(&seen.0, motion.as_str().into(), seed)?);
            first = (seen.0.visible_px(), distance);
        }
        let Some((_, world_from_mesh)) = &made else { return Ok(None) };
        let mut frame = stage.frame(format!("frame_{k:04}"), &seen, world_from_mesh, mixed([seed, k as u64]))?;
        if motion == Motion::Blur && k > 0 && chance(random, 0.2) {
            let radius = 0.12 * stage.camera.fx * stage.diagonal() / stage.distance;
            let depth = frame.depth.data_mut();
            for _ in 0..30 {
                disc(&view, random.below(view.pixels()), radius * between(random, 0.5, 3.0), |i| depth[i] = 0.0);
            }
        }
        // Compared with the first frame, at the same distance.
        let near = (distance / first.1).powi(2);
        frame.visible = frame.visible.min(seen.0.visible_px() as f64 * near / first.0.max(1) as f64);
        all.push(frame);
    }
    let name = format!("{index:04}-{}", motion.as_str());
    Ok(made.map(|(object, _)| stage.case(name, object, all)))
}

/// Something that passes between camera and object, for a second of every three.
fn passing(stage: &Stage, view: &View, time: f64) -> Result<Option<Mesh>> {
    let cycle = time % 3.0 - 1.5;
    if cycle.abs() > 0.5 {
        return Ok(None);
    }
    let diagonal = stage.diagonal();
    let center = view.camera_from_world.apply(Vector3::from(stage.world.center.to_array()));
    let place = Vector3::new(center.x * 0.7 + 2.4 * cycle * diagonal, center.y * 0.7, 0.7 * center.z);
    let spot = DVec3::from_array(view.camera_from_world.inverse().apply(place).into());
    let mut solid = Solid::default();
    solid.at(DAffine3::from_translation(spot)).cuboid(DVec3::new(0.16, 0.16, 0.6) * diagonal, 0.02 * diagonal);
    Ok(Some(solid.finish()?.0))
}
