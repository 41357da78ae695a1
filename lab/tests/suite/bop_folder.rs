//! Generated scenes in the layout of BOP.

use std::fs;

use serde_json::Value;
use sim3align_formats::mesh::{MeshReadOptions, read_mesh};
use sim3align_lab::prelude::*;

use crate::common::fresh;
use sim3align_lab::scenes::{SceneSet, write_bop};

#[test]
fn scenes_are_a_dataset_of_bop() {
    let folder = fresh("bop");
    let set = SceneSet::new(5, 2);
    write_bop(&set, &folder, 2, |_| {}).unwrap();
    let json = |path: &str| -> Value { serde_json::from_slice(&fs::read(folder.join(path)).unwrap()).unwrap() };
    let infos = json("models/models_info.json");
    let targets = json("test_targets_bop19.json");
    assert_eq!(targets.as_array().unwrap().len(), set.pairs());
    for target in targets.as_array().unwrap() {
        let (scene, id) = (target["scene_id"].as_u64().unwrap(), target["obj_id"].as_u64().unwrap());
        let own = format!("test/{scene:06}");
        let poses = json(&format!("{own}/scene_gt.json"));
        let place = poses["0"].as_array().unwrap().iter().position(|pose| pose["obj_id"] == id).unwrap();
        let pose = &poses["0"][place];
        let numbers = |value: &Value| value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect::<Vec<_>>();
        let [rotation, translation] = ["cam_R_m2c", "cam_t_m2c"].map(|name| numbers(&pose[name]));
        let camera_from_model = Similarity::from_parts(
            0.001,
            Matrix3::from_row_slice(&rotation),
            Vector3::from_row_slice(&translation) / 1000.0,
        )
        .unwrap();
        let bytes = fs::read(folder.join(format!("models/obj_{id:06}.ply"))).unwrap();
        let mesh = read_mesh(&bytes, &MeshReadOptions::default()).unwrap();
        // Millimetres, about the origin, with the diameter of the file.
        let diagonal = mesh.diagonal();
        let diameter = infos[id.to_string()]["diameter"].as_f64().unwrap();
        assert!(diagonal > 20.0 && diameter <= diagonal + 1e-3 && diameter > 0.5 * diagonal, "{diameter}, {diagonal}");

        let image = |name: &str| image::load_from_memory(&fs::read(folder.join(&own).join(name)).unwrap()).unwrap();
        let depth = image("depth/000000.png").into_luma16();
        let mask = image(&format!("mask_visib/000000_{place:06}.png")).into_luma8();
        let camera = json(&format!("{own}/scene_camera.json"))["0"].clone();
        let scale = camera["depth_scale"].as_f64().unwrap();
        let matrix: [f64; 9] = numbers(&camera["cam_K"]).try_into().unwrap();
        let camera = Pinhole::from_matrix(&matrix).unwrap();
        let mut rasteriser = Rasteriser::new();
        let (width, height) = (depth.width() as usize, depth.height() as usize);
        rasteriser.render_depth(&mesh, &camera_from_model, &camera, width, height);
        let drawn = rasteriser.depth().iter().filter(|z| **z > 0.0).count();
        let inside = mask.pixels().filter(|pixel| pixel.0[0] > 0).count();
        let info = &json(&format!("{own}/scene_gt_info.json"))["0"][place];
        assert_eq!(
            (info["px_count_all"].as_u64(), info["px_count_visib"].as_u64()),
            (Some(drawn as u64), Some(inside as u64))
        );
        assert!(inside >= 350, "an object is seen");
        // Where the mask is and depth is read, the model is in front of it or 15 mm behind it at most.
        for ((z, depth), mask) in rasteriser.depth().iter().zip(depth.pixels()).zip(mask.pixels()) {
            let read = f64::from(depth.0[0]) * scale;
            if mask.0[0] > 0 && read > 0.0 {
                assert!(*z > 0.0 && 1000.0 * f64::from(*z) - read < 15.2);
            }
        }
    }
    fs::remove_dir_all(&folder).unwrap();
}
