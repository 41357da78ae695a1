//! One stretch of the mesh for several views, against objects of known proportions.

use sim3align::precise::options::Proportions as Freedom;
use sim3align::precise::searched::proportions::Proportions;
use sim3align::report::Stretch;
use sim3align::views::options::ViewsOptions;
use sim3align::views::{View, align_views};
use sim3align_lab::prelude::Frame;

use crate::precise::{body, observe, truth};
use crate::prelude::*;

/// Views of an object from cameras a third of a turn apart; the world is the frame of the first one.
fn views(object: &Mesh) -> Vec<View> {
    [0.0, 2.1, 4.2]
        .into_iter()
        .map(|angle| {
            let pose = truth();
            let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), angle);
            let seen = Similarity { rotation: turn * pose.rotation, ..pose };
            let observation = observe(object, &seen);
            let (depth, mask) = (observation.depth().clone(), Some(observation.mask().clone()));
            let frame = Frame { depth, camera: observation.camera(), mask, photo: None };
            View { frame, world_from_camera: Some(pose.compose(&seen.inverse())) }
        })
        .collect()
}

fn fitted(mesh: &Mesh, views: Vec<View>, options: &ViewsOptions) -> Option<Stretch> {
    align_views(views, &PreparedMesh::borrowed(mesh), options, &mut Silent).unwrap().proportions
}

fn options(proportions: Freedom) -> ViewsOptions {
    ViewsOptions { proportions, quality: Quality::Fast, metrics: false, ..ViewsOptions::default() }
}

/// The largest error of the lengths along the axes of a mesh, relative.
fn error(found: &Stretch, by: &DMat3) -> f64 {
    let stretch = DMat3::from_cols_array_2d(&found.stretch);
    let of_axis = |axis| {
        let length = found.camera_from_stretched.scale * stretch.col(axis).length();
        libm::log(length / (truth().scale * by.col(axis).length())).abs()
    };
    [0, 1, 2].map(of_axis).into_iter().fold(0.0, f64::max)
}

#[wasm_bindgen_test(unsupported = test)]
fn views_from_all_sides_show_all_lengths() {
    let object = body();
    let draw = &mut Draw::new(3);
    let by = Proportions::new(core::array::from_fn(|_| draw.between(-0.05, 0.05))).matrix();
    let mesh = mapped(&object, |p| (by.inverse() * p.as_dvec3()).as_vec3());
    let found = fitted(&mesh, views(&object), &options(Freedom::Full)).unwrap();
    let off = error(&found, &by);
    assert!(off < 0.01, "{off}: {found:?} for {by}");
    assert!(found.uncertainty.iter().all(|sd| *sd < 0.02), "{found:?}");
    // One view leaves what it does not show as the mesh has it.
    let one = fitted(&mesh, views(&object)[..1].to_vec(), &options(Freedom::Full)).unwrap();
    assert!(off < error(&one, &by) && one.uncertainty.iter().zip(found.uncertainty).all(|(one, all)| *one > all));
}

#[wasm_bindgen_test(unsupported = test)]
fn views_keep_what_they_are_told_to_keep() {
    // A surface of revolution stays one.
    let round = ellipsoid(Vec3::new(0.5, 0.5, 1.0), 24);
    let flat = mapped(&round, |p| p * Vec3::new(1.0, 1.0, 0.95));
    let stretch = fitted(&flat, views(&round), &options(Freedom::Full)).unwrap();
    let stretch = DMat3::from_cols_array_2d(&stretch.stretch);
    assert!((stretch.x_axis.x - stretch.y_axis.y).abs() < 2e-3, "{stretch}");
    assert!(stretch.z_axis.z > 1.015, "{stretch}");
    let object = body();
    assert_eq!(fitted(&object, views(&object), &options(Freedom::Keep)), None);
    let known = ViewsOptions { scale: ScaleOption::Fixed(truth().scale), ..options(Freedom::Axes) };
    assert_eq!(fitted(&object, views(&object), &known), None);
    let mut unknown = views(&object);
    unknown.iter_mut().for_each(|view| view.world_from_camera = None);
    assert_eq!(fitted(&object, unknown, &options(Freedom::Axes)), None);
}
