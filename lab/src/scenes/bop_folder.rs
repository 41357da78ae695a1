//! Cluttered scenes as a dataset in the layout of BOP: each scene has one image, and each object is its own model.

use nalgebra::UnitVector3;
use serde_json::{Map, Value, json};

use super::scene::DEPTH_SCALE;
use super::scene::ScenePair;
use super::set::SceneSet;
use crate::case_folder::write::{depth_png, mask_png, ply_mesh};
use crate::cases::distortion::mapped;
use crate::files::write;
use crate::parallel::parallel_map;
use crate::prelude::*;
use sim3align::metrics::bop::VISIBILITY_TOLERANCE_M;
use sim3align_geometry::surface::SurfaceMoments;

/// BOP's unit, in metres.
const MILLIMETRE: f64 = 0.001;

/// Writes the scenes of a set as `folder`/test and models, on several threads; `progress` gets the number of completed
/// scenes. The masks are those of BOP's definition: what is at most 15 mm behind the depth map.
///
/// # Errors
/// [`sim3align_geometry::error::ErrorCode::InvalidArgument`] for a folder that can't be written.
pub fn write_bop(set: &SceneSet, folder: &Path, threads: usize, progress: impl Fn(usize) + Sync) -> Result<()> {
    let scenes: Vec<usize> = (0..set.scenes()).collect();
    let first_id = |scene: usize| 1 + (0..scene).map(|before| set.pairs_of(before)).sum::<usize>();
    let written = |&scene: &usize| write_scene(set, scene, first_id(scene), folder);
    let parts = parallel_map(threads, &scenes, written, progress)?;
    let mut targets = Vec::new();
    let mut models = Map::new();
    for (scene, infos) in scenes.iter().zip(parts) {
        for (i, info) in infos.into_iter().enumerate() {
            let id = first_id(*scene) + i;
            targets.push(json!({ "scene_id": scene + 1, "im_id": 0, "obj_id": id, "inst_count": 1 }));
            models.insert(id.to_string(), info);
        }
    }
    write(&folder.join("test_targets_bop19.json"), text(&Value::from(targets)).as_bytes())?;
    write(&folder.join("models/models_info.json"), text(&Value::from(models)).as_bytes())
}

fn text(value: &Value) -> String {
    format!("{value:#}\n")
}

/// Writes a scene and its models, of which the first has this id. Returns the entries of `models_info.json`.
fn write_scene(set: &SceneSet, index: usize, first_id: usize, folder: &Path) -> Result<Vec<Value>> {
    let scene = set.scene(index)?;
    let own = folder.join(format!("test/{:06}", index + 1));
    let (mut infos, mut poses, mut visibility) = (Vec::new(), Vec::new(), Vec::new());
    for (i, pair) in scene.pairs.iter().enumerate() {
        let id = first_id + i;
        let model = Model::of(pair);
        write(&folder.join(format!("models/obj_{id:06}.ply")), &ply_mesh(&model.mesh))?;
        infos.push(model.info());
        let Similarity { rotation, translation, .. } = &model.camera_from_model;
        poses.push(json!({
            "obj_id": id,
            "cam_R_m2c": rotation.matrix().transpose().as_slice(),
            "cam_t_m2c": (translation / MILLIMETRE).as_slice(),
        }));
        let (mask, info) = model.seen(pair);
        write(&own.join(format!("mask_visib/000000_{i:06}.png")), &mask_png(&mask)?)?;
        visibility.push(info);
    }
    if let Some(pair) = scene.pairs.first() {
        let camera = pair.observation.camera();
        let matrix = [camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0];
        let cameras = json!({ "0": { "cam_K": matrix, "depth_scale": DEPTH_SCALE / MILLIMETRE } });
        write(&own.join("scene_camera.json"), text(&cameras).as_bytes())?;
        write(&own.join("depth/000000.png"), &depth_png(pair.observation.depth(), DEPTH_SCALE)?)?;
    }
    write(&own.join("scene_gt.json"), text(&json!({ "0": poses })).as_bytes())?;
    write(&own.join("scene_gt_info.json"), text(&json!({ "0": visibility })).as_bytes())?;
    Ok(infos)
}

/// An object as a model of BOP: millimetres, the middle of its box at the origin.
struct Model {
    mesh: Mesh,
    camera_from_model: Similarity,
    symmetry: Vec<SymmetryAxis>,
}

impl Model {
    /// The object of a pair. The depth map may have a metric of its own, which the model has as well.
    fn of(pair: &ScenePair) -> Self {
        let pose = &pair.camera_from_object;
        let bounds = Bounds::of(pair.object.positions());
        let middle = bounds.map_or(Vector3::zeros(), |b| vector3(b.center()));
        let unit = pose.scale / MILLIMETRE;
        let moved = mapped(&pair.object, |p| vec3(&((vector3(*p) - middle) * unit)));
        Self {
            mesh: moved.unwrap_or_else(|_| pair.object.clone()),
            camera_from_model: Similarity { scale: MILLIMETRE, translation: pose.apply(middle), ..*pose },
            symmetry: pair.symmetry(),
        }
    }

    /// The entry of `models_info.json`.
    fn info(&self) -> Value {
        let bounds =
            Bounds::of(self.mesh.positions()).unwrap_or(Bounds { min: Default::default(), max: Default::default() });
        let (min, size) = (bounds.min, bounds.extent());
        let centroid = Vector3::from(SurfaceMoments::of(&self.mesh).centroid.to_array());
        let (mut continuous, mut discrete) = (Vec::new(), Vec::new());
        for SymmetryAxis { axis, fold } in &self.symmetry {
            let axis = UnitVector3::new_normalize(*axis);
            match fold {
                None => continuous.push(json!({ "axis": axis.as_slice(), "offset": centroid.as_slice() })),
                Some(fold) => discrete.extend((1..*fold).map(|k| {
                    let angle = TAU * f64::from(k) / f64::from(*fold);
                    let turn = Rotation3::from_axis_angle(&axis, angle);
                    let shift = centroid - turn * centroid;
                    let rows = (0..3).flat_map(|i| [turn[(i, 0)], turn[(i, 1)], turn[(i, 2)], shift[i]]);
                    json!(rows.chain([0.0, 0.0, 0.0, 1.0]).collect::<Vec<f64>>())
                })),
            }
        }
        json!({
            "diameter": self.diameter(),
            "min_x": min.x, "min_y": min.y, "min_z": min.z,
            "size_x": size.x, "size_y": size.y, "size_z": size.z,
            "symmetries_continuous": continuous,
            "symmetries_discrete": discrete,
        })
    }

    /// The largest distance between two vertices.
    fn diameter(&self) -> f32 {
        let points = self.mesh.positions();
        let pairs =
            points.iter().enumerate().flat_map(|(i, a)| points[i + 1..].iter().map(move |b| a.distance_squared(*b)));
        pairs.fold(0.0, f32::max).sqrt()
    }

    /// The mask of what is seen, and the entry of `scene_gt_info.json`.
    fn seen(&self, pair: &ScenePair) -> (Mask, Value) {
        let (depth, camera) = (pair.observation.depth(), pair.observation.camera());
        let (width, height) = (depth.width(), depth.height());
        let mut rasteriser = Rasteriser::new();
        rasteriser.render_depth(&self.mesh, &self.camera_from_model, &camera, width, height);
        let mut mask = Mask::filled(width, height, 0);
        let (mut all, mut valid, mut visible) = (0, 0, 0);
        for (i, (&z, &scene)) in rasteriser.depth().iter().zip(depth.data()).enumerate() {
            if z <= 0.0 {
                continue;
            }
            let (x, y) = ((i % width) as f64 - camera.cx, (i / width) as f64 - camera.cy);
            let along_ray = ((x / camera.fx).powi(2) + (y / camera.fy).powi(2) + 1.0).sqrt();
            let is_visible = scene == 0.0 || f64::from(z - scene) * along_ray <= VISIBILITY_TOLERANCE_M;
            mask.data_mut()[i] = u8::from(is_visible);
            (all, valid, visible) = (all + 1, valid + usize::from(scene > 0.0), visible + usize::from(is_visible));
        }
        let fraction = visible as f64 / all.max(1) as f64;
        let info = json!({
            "px_count_all": all, "px_count_valid": valid, "px_count_visib": visible, "visib_fract": fraction,
        });
        (mask, info)
    }
}
