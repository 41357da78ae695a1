//! Objects in scenes, in 3DMatch's layout: the complete surface of an object, and the readings of a depth image around
//! it, which contain one side of the object, its support and its neighbours. The unit is a decimetre, so that the
//! tolerance of rooms, 0.2 units, is 2 cm.

use nalgebra::Matrix4;

use super::overlap::{covered, information};
use super::pair::{Listed, write_set};
use super::trajectory::{Block, text};
use crate::case_folder::write::ply_points;
use crate::files::write;
use crate::prelude::*;
use crate::scenes::{ClutteredScene, SceneSet};
use sim3align::geometry::surface::sample_surface;

/// Units per metre.
const PER_METRE: f32 = 10.0;

/// Points of an object.
const OBJECT_POINTS: usize = 15_000;

/// Radius of the ball of readings, relative to that of the object.
const MARGIN: f32 = 1.5;

/// Points this near to each other show the same surface, in units.
const SAME_SURFACE: f32 = 0.08;

/// Numbers of clouds for a pair: of a scene, of none and of an object, because successive numbers are no pair.
const NUMBERS_PER_PAIR: u32 = 3;

/// Writes `scenes` scenes, each with a pair of clouds for each of its objects without symmetry:
/// `scene-<n>/cloud_bin_<i>.ply`, `scene-<n>-evaluation/gt.log` and `gt.info`, `pairs.json`.
///
/// # Errors
/// [`InvalidArgument`](sim3align_geometry::error::ErrorCode::InvalidArgument) if a file cannot be written.
pub fn write_objects(root: &Path, seed: u64, scenes: u32) -> Result<()> {
    let set = SceneSet::new(seed, scenes as usize);
    write_set(root, scenes, |i| write_scene(&set.scene(i as usize)?, root, &format!("scene-{i:02}")))
}

fn write_scene(scene: &ClutteredScene, root: &Path, name: &str) -> Result<Vec<Listed>> {
    let Some(first) = scene.pairs.first() else { return Ok(Vec::new()) };
    let cloud = |i: u32| root.join(name).join(format!("cloud_bin_{i}.ply"));
    let seen = points(&first.observation);
    let (mut poses, mut matrices, mut listed) = (Vec::new(), Vec::new(), Vec::new());
    let fragments = scene.pairs.len() as u32 * NUMBERS_PER_PAIR;
    for (k, pair) in (0..).zip(&scene.pairs).filter(|(_, pair)| !pair.is_symmetric()) {
        let (target, source) = (NUMBERS_PER_PAIR * k, NUMBERS_PER_PAIR * k + 2);
        // In the metric of the depth map, so that the true scale is 1.
        let size = PER_METRE * pair.camera_from_object.scale as f32;
        let surface = sample_surface(&pair.object, OBJECT_POINTS, u64::from(source))?;
        let object: Vec<Vec3> = surface.points.iter().map(|&p| size * p).collect();
        let translation = pair.camera_from_object.translation * f64::from(PER_METRE);
        let pose = Similarity { scale: 1.0, translation, ..pair.camera_from_object };
        let around = around(&object, &pose, &seen);
        let shown = covered(&object, &KdTree::new(&around), &pose, SAME_SURFACE);
        if shown.is_empty() {
            continue;
        }
        let overlap = shown.len() as f64 / object.len() as f64;
        let matrix = information(shown.into_iter().map(|i| object[i]));
        write(&cloud(target), &ply_points(&around))?;
        write(&cloud(source), &ply_points(&object))?;
        let columns = pose.to_column_major();
        poses.push(Block { target, source, fragments, matrix: Matrix4::from_column_slice(&columns) });
        matrices.push(Block { target, source, fragments, matrix });
        listed.push(Listed { group: name.to_owned(), source, target, overlap });
    }
    let folder = root.join(format!("{name}-evaluation"));
    write(&folder.join("gt.log"), text(&poses).as_bytes())?;
    write(&folder.join("gt.info"), text(&matrices).as_bytes())?;
    Ok(listed)
}

/// The points in a ball about an object.
fn around(object: &[Vec3], scene_from_object: &Similarity, scene: &[Vec3]) -> Vec<Vec3> {
    let transform = scene_from_object.to_f32();
    let placed: Vec<Vec3> = object.iter().map(|&p| transform.apply(p)).collect();
    let centre = Bounds::of(&placed).map_or(Vec3::ZERO, |bounds| bounds.center());
    let reach = MARGIN * placed.iter().fold(0.0f32, |far, p| far.max(p.distance(centre)));
    scene.iter().copied().filter(|p| p.distance(centre) <= reach).collect()
}

/// The readings of a depth image as points.
fn points(observation: &Observation) -> Vec<Vec3> {
    let (depth, camera) = (observation.depth(), observation.camera());
    let pixels = (0..depth.height()).flat_map(|v| (0..depth.width()).map(move |u| (u, v)));
    let point = |(u, v): (usize, usize)| {
        let z = depth.get(u, v).filter(|z| *z > 0.0)?;
        Some(PER_METRE * vec3(&vector3(camera.back_project(u as f64, v as f64, f64::from(z)))))
    };
    pixels.filter_map(point).collect()
}
