//! Holes in a sensor's readings, on dark, reflective and grazing surfaces.

use super::distortion::face;
use super::draft::Object;
use super::mask::Noise;
use super::scene::Scene;
use super::tier::Tier;
use crate::prelude::*;
use sim3align_geometry::order::quantile;

/// Fewest pixels of one part that can be a dark part.
const LEAST_PART_PX: usize = 40;

/// Holes in the readings of the object.
pub struct Holes {
    /// Pixels of the object that have no reading.
    pub pixels: Vec<usize>,
    /// Why: `"dark"`, `"shiny"`, `"grazing"`.
    pub tags: Vec<&'static str>,
}

/// Draws holes that cover a share of the visible object, which lies in the scene as `placed`.
pub fn on_object(scene: &Scene, (shown, placed): (&Object, &Mesh), tier: Tier, random: &mut Random) -> Holes {
    let wanted = between(random, tier.pick(0.05, 0.15, 0.25), tier.pick(0.12, 0.3, 0.45));
    let object: Vec<usize> =
        (0..scene.visible.len()).filter(|&i| scene.visible[i] && scene.object_triangles[i] != NO_TRIANGLE).collect();
    let kinds = [chance(random, 0.6), chance(random, 0.5), chance(random, 0.5)];
    let kinds = if kinds == [false; 3] { [true, false, false] } else { kinds };
    let each = wanted / kinds.iter().filter(|kind| **kind).count() as f64;
    let views = Views::of(scene, placed, &object);
    let mut holes = Holes { pixels: Vec::new(), tags: Vec::new() };
    let mut lose = |tag, score: &dyn Fn(usize) -> f64, share: f64| {
        holes.tags.push(tag);
        holes.pixels.extend(highest(&object, score, share));
    };
    if kinds[0] {
        let span = (object.len() as f64).sqrt();
        let noise = Noise::new(scene, (span * between(random, 0.15, 0.35)).max(3.0), random);
        let part = dark_part(scene, shown, &object, each, random);
        let dark = |k: usize| {
            let (i, of) = (object[k], shown.parts.get(scene.object_triangles[object[k]] as usize));
            noise.at(i % scene.width, i / scene.width) + if part.is_some() && of == part.as_ref() { 4.0 } else { 0.0 }
        };
        lose("dark", &dark, each);
    }
    if kinds[1] {
        let lamp = DVec3::new(normal(random), normal(random), between(random, 0.3, 2.0)).normalize_or(DVec3::Z);
        let shiny = |k: usize| views.normals[k].dot((views.to_eye[k] + lamp).normalize_or(DVec3::Z)).abs();
        lose("shiny", &shiny, each);
    }
    if kinds[2] {
        lose("grazing", &|k: usize| -views.normals[k].dot(views.to_eye[k]).abs(), each);
    }
    holes.pixels.sort_unstable();
    holes.pixels.dedup();
    holes
}

/// Draws holes around the object, in its support and background.
pub fn around(scene: &Scene, random: &mut Random) -> Vec<usize> {
    let share = between(random, 0.2, 0.6);
    let object: Vec<usize> = (0..scene.visible.len()).filter(|&i| scene.visible[i]).collect();
    let span = (object.len() as f64).sqrt();
    let noise = Noise::new(scene, (span * between(random, 0.3, 0.7)).max(4.0), random);
    let bounds = |of: &dyn Fn(usize) -> usize| {
        let low = object.iter().map(|&i| of(i)).min().unwrap_or_default() as f64;
        let high = object.iter().map(|&i| of(i)).max().unwrap_or_default() as f64;
        low - 0.7 * span..=high + 0.7 * span
    };
    let [columns, rows] = [bounds(&|i| i % scene.width), bounds(&|i| i / scene.width)];
    let near: Vec<usize> = (0..scene.depth.len())
        .filter(|&i| {
            scene.object_depth[i] == 0.0
                && columns.contains(&((i % scene.width) as f64))
                && rows.contains(&((i / scene.width) as f64))
        })
        .collect();
    highest(&near, &|k: usize| noise.at(near[k] % scene.width, near[k] / scene.width), share).collect()
}

/// Normals and directions to the eye at pixels of the object.
struct Views {
    normals: Vec<DVec3>,
    to_eye: Vec<DVec3>,
}

impl Views {
    fn of(scene: &Scene, mesh: &Mesh, object: &[usize]) -> Self {
        let world_from_camera = scene.camera_from_world.inverse();
        let eye = DVec3::from_array(world_from_camera.translation.into());
        let normal = |&i: &usize| face(mesh, scene.object_triangles[i] as usize).normalize_or(DVec3::Z);
        let to_eye = |&i: &usize| {
            let point = scene.world_point(&world_from_camera, i, scene.object_depth[i]);
            (eye - DVec3::from_array(point.into())).normalize_or(DVec3::Z)
        };
        Self { normals: object.iter().map(normal).collect(), to_eye: object.iter().map(to_eye).collect() }
    }
}

/// A random part of the object that covers at most about this share of its visible pixels, if there is one.
fn dark_part(scene: &Scene, shown: &Object, object: &[usize], share: f64, random: &mut Random) -> Option<usize> {
    let mut sizes = std::collections::BTreeMap::new();
    for &i in object {
        if let Some(&part) = shown.parts.get(scene.object_triangles[i] as usize) {
            *sizes.entry(part).or_insert(0usize) += 1;
        }
    }
    let most = (1.3 * share * object.len() as f64) as usize;
    let fitting: Vec<usize> =
        sizes.into_iter().filter(|(_, size)| (LEAST_PART_PX..=most).contains(size)).map(|(part, _)| part).collect();
    fitting.get(random.below(fitting.len().max(1))).copied()
}

/// The pixels with the highest scores; `score` gets the index in `pixels`.
fn highest(pixels: &[usize], score: &dyn Fn(usize) -> f64, share: f64) -> impl Iterator<Item = usize> {
    let scores: Vec<f32> = (0..pixels.len()).map(|k| score(k) as f32).collect();
    let least = quantile(scores.iter().copied(), 1.0 - share).unwrap_or(f32::INFINITY);
    pixels.iter().zip(scores).filter(move |(_, score)| *score > least).map(|(&i, _)| i)
}
