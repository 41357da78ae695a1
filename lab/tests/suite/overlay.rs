//! Pictures of poses: outlines where they belong.

use sim3align::align::evaluate::Truth;
use sim3align_lab::bench::benchmark::BenchCase;
use sim3align_lab::bench::overlay::{MASK_COLOUR, POSE_COLOUR, TRUTH_COLOUR, picture};
use sim3align_lab::prelude::*;

const FOCAL_PX: f64 = 100.0;

/// A square of 0.2 m before a wall, 1 m away: pixels 40 to 59 of columns and 30 to 49 of rows.
fn case(truth: Option<Similarity>) -> BenchCase {
    let (width, height) = (100, 80);
    let inside = |i: usize| (40..60).contains(&(i % width)) && (30..50).contains(&(i / width));
    let depth = (0..width * height).map(|i| if inside(i) { 1.0 + 1e-4 * (i % 7) as f32 } else { 1.5 }).collect();
    let mask = (0..width * height).map(|i| u8::from(inside(i))).collect();
    let observation = Observation::new(
        DepthMap::from_metres(width, height, depth).unwrap(),
        Mask::new("mask", width, height, mask).unwrap(),
        Pinhole::new(FOCAL_PX, FOCAL_PX, 49.5, 39.5).unwrap(),
    );
    let corners = [-0.1, -0.1, 0.0, 0.1, -0.1, 0.0, 0.1, 0.1, 0.0, -0.1, 0.1, 0.0];
    BenchCase {
        name: "square".into(),
        tier: "easy".into(),
        class: "given".into(),
        family: "square".into(),
        tags: Vec::new(),
        parameters: serde_json::Value::Null,
        observation: observation.unwrap(),
        mesh: Mesh::from_flat(&corners, Some(&[0, 1, 2, 0, 2, 3])).unwrap(),
        given: None,
        colors: None,
        truth: truth.map(|camera_from_mesh| Truth { camera_from_mesh, symmetry: Symmetry::None }),
    }
}

fn pose(x_m: f64, y_m: f64) -> Similarity {
    Similarity { translation: Vector3::new(x_m, y_m, 1.0), ..Similarity::identity() }
}

/// The picture's width, and of each colour the box about its pixels: left, top, right, bottom.
fn boxes(case: &BenchCase, pose: &Similarity) -> (u32, [Option<[u32; 4]>; 3]) {
    let image = image::load_from_memory(&picture(case, pose).unwrap()).unwrap().to_rgb8();
    let around = [MASK_COLOUR, TRUTH_COLOUR, POSE_COLOUR].map(|colour| {
        let mut found: Option<[u32; 4]> = None;
        for (u, v, _) in image.enumerate_pixels().filter(|(_, _, pixel)| pixel.0 == colour) {
            let [left, top, right, bottom] = found.unwrap_or([u, v, u, v]);
            found = Some([left.min(u), top.min(v), right.max(u), bottom.max(v)]);
        }
        found
    });
    (image.width(), around)
}

#[test]
fn outlines_lie_where_mask_and_poses_do() {
    // The right half of the mask's outline is not drawn over.
    let case = case(Some(pose(-0.04, 0.0)));
    let (width, [mask, truth, found]) = boxes(&case, &pose(-0.08, 0.02));
    assert_eq!(width, 320);
    // 20 pixels and 8 of margin on either side.
    let zoom = 320.0 / 36.0;
    let expect = |found: Option<[u32; 4]>, [left, top]: [f64; 2], sides: &[usize]| {
        let found = found.unwrap().map(f64::from);
        let [left, top] = [(left - 32.0) * zoom, (top - 22.0) * zoom];
        let expected = [left, top, left + 20.0 * zoom, top + 20.0 * zoom];
        for &side in sides {
            assert!((found[side] - expected[side]).abs() <= 2.0, "side {side}: {found:?}, {expected:?}");
        }
    };
    expect(mask, [40.0, 30.0], &[2]);
    expect(truth, [36.0, 30.0], &[1, 2]);
    expect(found, [32.0, 32.0], &[1, 2, 3]);
}

#[test]
fn nothing_is_drawn_of_what_is_not_there() {
    // Behind the camera, and no truth.
    let (_, [mask, truth, found]) = boxes(&case(None), &Similarity { translation: -Vector3::z(), ..pose(0.0, 0.0) });
    assert!(mask.is_some() && truth.is_none() && found.is_none());
}
