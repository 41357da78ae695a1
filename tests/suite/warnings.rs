//! Warnings come with poses that are in doubt.

use sim3align::align::align;
use sim3align::align::warnings::{about_observation, retain_doubts};
use sim3align::report::Warning;

use crate::precise::{body, observe, quick, truth};
use crate::prelude::*;

fn codes(warnings: &[Warning]) -> Vec<WarningCode> {
    warnings.iter().map(|warning| warning.code).collect()
}

#[wasm_bindgen_test(unsupported = test)]
fn a_mask_at_the_border_is_warned_of_where_the_pose_is_in_doubt() {
    let whole = observe(&body(), &truth());
    let mut mask = whole.mask().clone();
    mask.data_mut()[0] = 1;
    let observation = Observation::new(whole.depth().clone(), mask, whole.camera()).unwrap();
    assert_eq!(codes(&about_observation(&observation)), [WarningCode::MaskTouchesBorder]);
    let with = |mesh: &Mesh| align(&observation, mesh, &quick(), &mut Silent).unwrap();
    let right = with(&body());
    assert!(right.confidence > 0.5 && right.warnings.is_empty(), "{} {:?}", right.confidence, right.warnings);
    let other = with(&cuboid(Vec3::new(0.2, 0.3, 1.4)));
    assert!(other.confidence < 0.5, "{}", other.confidence);
    for code in [WarningCode::MaskTouchesBorder, WarningCode::MeshDoubtful] {
        assert!(codes(&other.warnings).contains(&code), "{code:?}: {:?}", other.warnings);
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn faults_of_the_input_are_warned_of_whatever_the_pose() {
    let kept = |code, confidence| {
        let mut warnings = vec![Warning { code, message: String::new() }];
        retain_doubts(&mut warnings, confidence);
        !warnings.is_empty()
    };
    for code in [WarningCode::MaskTouchesBorder, WarningCode::SparseDepth, WarningCode::MeshDoubtful] {
        assert!(kept(code, 0.49) && !kept(code, 0.5), "{code:?}");
    }
    assert!(kept(WarningCode::NotConverged, 0.29) && !kept(WarningCode::NotConverged, 0.3));
    for code in [WarningCode::DepthLooksLikeMillimetres, WarningCode::MaskCoversImage, WarningCode::ScaleClamped] {
        assert!(kept(code, 1.0), "{code:?}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn depth_that_is_near_where_it_is_large_is_warned_of() {
    let whole = observe(&body(), &truth());
    let width = whole.mask().width();
    // Depth of the object, of a wall behind it, and of an object that hides all but a share of the columns.
    let seen = |hidden: usize, value: fn(f32) -> f32| {
        let pixels = whole.depth().data().iter().zip(whole.mask().data()).enumerate();
        let depth = pixels.map(|(i, (z, m))| match (*m != 0, i % width < hidden) {
            (true, _) => value(*z),
            (false, true) => value(0.3),
            (false, false) => value(1.8),
        });
        let depth = DepthMap::from_metres(width, whole.mask().height(), depth.collect()).unwrap();
        let observation = Observation::new(depth, whole.mask().clone(), whole.camera()).unwrap();
        codes(&about_observation(&observation))
    };
    let [metres, disparity]: [fn(f32) -> f32; 2] = [|z| z, |z| 1.0 / z];
    assert_eq!(seen(0, metres), []);
    assert_eq!(seen(0, disparity), [WarningCode::DepthLooksInverted]);
    // Hidden by half; and at the bottom of a box.
    assert_eq!(seen(width / 2, metres), []);
    assert_eq!(seen(width, metres), [WarningCode::DepthLooksInverted]);
    assert_eq!(seen(width, disparity), []);
}

#[wasm_bindgen_test(unsupported = test)]
fn depth_that_was_normalised_is_warned_of() {
    let whole = observe(&body(), &truth());
    let (width, height) = (whole.mask().width(), whole.mask().height());
    let wall = 1.8;
    let scene: Vec<f32> = whole.depth().data().iter().map(|z| if *z > 0.0 { *z } else { wall }).collect();
    let [near, far] = [f32::min, f32::max].map(|of| scene.iter().copied().reduce(of).unwrap());
    let seen = |depth: Vec<f32>| {
        let depth = DepthMap::from_metres(width, height, depth).unwrap();
        codes(&about_observation(&Observation::new(depth, whole.mask().clone(), whole.camera()).unwrap()))
    };
    // Depth with a single nearest pixel, from 0 to 1; the same in integers of 16 bits that are taken for millimetres.
    let mut normalised: Vec<f32> = scene.iter().map(|z| 0.05 + 0.95 * (z - near) / (far - near)).collect();
    normalised[0] = 0.0;
    let integers: Vec<f32> = normalised.iter().map(|z| (f64::from((z * 65535.0).round()) * 0.001) as f32).collect();
    for map in [&normalised, &integers] {
        assert_eq!(seen(map.clone()), [WarningCode::DepthLooksNormalised]);
    }
    // A sensor whose range ends at a metre lacks readings, a rendered map without a pixel at 0 was not normalised, and a
    // map that ends elsewhere neither.
    let mut holed = normalised.clone();
    holed.iter_mut().step_by(50).for_each(|z| *z = 0.0);
    assert_eq!(seen(holed), []);
    assert_eq!(seen(normalised.iter().map(|z| z.max(0.01)).collect()), []);
    assert_eq!(seen(normalised.iter().map(|z| 1.1 * z).collect()), []);
}
