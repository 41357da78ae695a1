//! The results of all calls, bit by bit: they are the same natively and in WebAssembly.
//!
//! A change of a method on purpose changes its fingerprint. Take the new one over from the failure message once native and
//! WebAssembly print the same.

use core::fmt::Debug;

use sim3align::align::evaluate::{EvaluateOptions, Truth, evaluate};
use sim3align::align::search::Request;
use sim3align::align::{align, align_paper, align_prepared};
use sim3align::calibrate::raw_view::Focal;
use sim3align::error::Result;
use sim3align::geometry::depth_kind::DepthKind;
use sim3align::paper::options::PaperOptions;
use sim3align::precise::options::Proportions;
use sim3align::register::options::{EstimateSim3Options, RegisterOptions};
use sim3align::register::{estimate_sim3, register};
use sim3align::scene::task::align_scene;
use sim3align::track::TrackOptions;
use sim3align::track::tracker::Tracker;
use sim3align::views::ViewsOptions;
use sim3align::views::align_views;
use sim3align_formats::mesh::{MeshReadOptions, read_colored_mesh};
use sim3align_formats::photo::read_photo;
use sim3align_formats::splats::read_splats;

use crate::color::{carton, label, photo, printed_mesh};
use crate::fixtures::fixture;
use crate::observations::{WIDTH, body, frame_of, observe, quick, solve, truth, views};
use crate::prelude::*;
use crate::shapes::{self, rendered};
use crate::{calibrate, scene, track};

/// Panics unless each call has the expected hash.
#[track_caller]
fn check(cases: &[(&str, u64, u64)]) {
    let other = cases.iter().filter(|(_, expected, found)| found != expected);
    let other: String = other.map(|(name, _, found)| format!("{name}: {found:#018x}\n")).collect();
    assert!(other.is_empty(), "now\n{other}");
}

/// Numbers are written so that they can be read again to the bit.
fn of<T: Debug>(result: Result<T>) -> u64 {
    fingerprint(format!("{:?}", result.unwrap()).bytes().map(u64::from))
}

/// FNV-1a over the bytes of 64-bit words.
fn fingerprint(words: impl IntoIterator<Item = u64>) -> u64 {
    let bytes = words.into_iter().flat_map(u64::to_le_bytes);
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

/// The body as a sensor and a network see it: with noise, holes, something nearer in front of one side, and specks.
fn noisy() -> Observation {
    let (mut draw, seen) = (Draw::new(3), observe(&body(), &truth()));
    let (mut depth, mut mask) = (seen.depth().clone(), seen.mask().clone());
    for (i, (z, m)) in depth.data_mut().iter_mut().zip(mask.data_mut()).enumerate() {
        if i % WIDTH < 85 {
            (*z, *m) = (0.4, 0);
        }
        *z *= if draw.below(40) == 0 { 0.0 } else { 1.0 + 0.002 * draw.normal() as f32 };
        *m ^= u8::from(draw.below(300) == 0);
    }
    Observation::new(depth, mask, seen.camera()).unwrap()
}

#[wasm_bindgen_test(unsupported = test)]
pub fn alignments_have_these_bits() {
    let initial = Some(Similarity { scale: 0.173, ..truth() });
    let up = Some((truth().rotation * Vector3::z()).into());
    let scale = ScaleOption::Between([0.172, 0.3]);
    let given = AlignOptions { initial, scale, camera_up: up, mesh_up: Some([0.0, 0.0, 1.0]), ..quick() };
    let stretched = AlignOptions { proportions: Proportions::Full, ..quick() };
    let camera = Pinhole::new(3600.0, 3600.0, 699.5, 549.5).unwrap();
    let large = rendered(&body(), &truth(), camera, [1400, 1100], |z| z);
    let (seen, hollow) = (observe(&body(), &truth()), joined(&body(), &mapped(&body(), |p| p * -0.5)));
    let can = ellipsoid(Vec3::new(0.4, 0.4, 0.7), 24);
    let symmetric = AlignOptions { symmetry: Symmetry::Auto, ..quick() };
    let photo = photo(&carton(), &truth(), label, (Vec3::new(0.6, 0.7, 0.9), 0.5), 1);
    let photo = observe(&carton(), &truth()).with_photo(photo).unwrap();
    let request = Request::new(quick()).unwrap();
    let (scan, paper) = (shapes::observe(&shapes::body()), PaperOptions::default());
    check(&[
        ("by shape", 0x1612_6a0e_23d1_6001, of(Ok(solve(&AlignOptions::default())))),
        ("noise and an occluder", 0x19df_2e2b_6e13_0513, of(align(&noisy(), &body(), &quick(), &mut Silent))),
        ("a pose, bounds and up", 0x7841_8663_3e1d_f1f3, of(Ok(solve(&given)))),
        ("a large image", 0x1b7b_9af8_b8cb_12cd, of(align(&large, &body(), &quick(), &mut Silent))),
        ("a doubtful pose", 0x492f_92d3_d82f_d9fa, of(align(&seen, &carton(), &quick(), &mut Silent))),
        ("an inner shell", 0x0185_a0e0_2fde_df64, of(align(&seen, &hollow, &quick(), &mut Silent))),
        ("proportions", 0x6b53_b90d_e738_3e30, of(Ok(solve(&stretched)))),
        ("a symmetric mesh", 0x1f93_95ae_bf5e_2854, of(align(&observe(&can, &truth()), &can, &symmetric, &mut Silent))),
        ("colour", 0x1a9e_b3d8_9f03_7326, of(align_prepared(&photo, &printed_mesh(), request, &mut Silent))),
        ("paper", 0x391b_6ce3_9790_62c5, of(align_paper(&scan, &shapes::body(), &paper, &mut Silent))),
    ]);
}

#[wasm_bindgen_test(unsupported = test)]
pub fn errors_have_these_bits() {
    let turn = Rotation3::new(Vector3::new(0.02, 3.1, 0.01));
    let pose = Similarity { scale: 0.175, rotation: truth().rotation * turn, ..truth() };
    let mesh = cuboid(Vec3::new(0.5, 0.8, 1.1));
    let against = Truth { camera_from_mesh: truth(), symmetry: Symmetry::Auto };
    let (seen, lemon) = (observe(&mesh, &truth()), ellipsoid(Vec3::new(0.5, 0.5, 0.9), 24));
    let options = EvaluateOptions::against(Some(&against));
    check(&[
        ("evaluate", 0xb668_80a5_2778_2ba8, of(evaluate(&seen, &mesh, &pose, &options))),
        ("evaluate, a lemon", 0x4c97_480b_416f_c351, of(evaluate(&observe(&lemon, &truth()), &lemon, &pose, &options))),
    ]);
}

#[wasm_bindgen_test(unsupported = test)]
pub fn registrations_have_these_bits() {
    let draw = &mut Draw::new(5);
    let truth = draw.similarity([2.0, 3.0], 5.0);
    let source: Vec<_> = mug(draw, 2000).points.into_iter().map(vector3).collect();
    // Another sample of a part.
    let part = mug(draw, 2000).points.into_iter().filter(|p| p.z < 0.6);
    let target = flat(&part.map(|p| truth.apply(vector3(p))).collect::<Vec<_>>());
    let moved = flat(&source.iter().map(|p| truth.apply(*p)).collect::<Vec<_>>());
    let source = flat(&source);
    let pairs: Vec<u32> = (0..1000).flat_map(|i| [i, if i % 2 == 0 { i } else { i * 7 % 1000 }]).collect();
    let (free, pairwise) = (RegisterOptions::default(), EstimateSim3Options::default());
    let fixed = RegisterOptions { scale: ScaleOption::Fixed(truth.scale), ..free.clone() };
    check(&[
        ("register", 0x3e4b_2ea9_94bf_ccf2, of(register(&source, &target, &free, &mut Silent))),
        ("register, a known scale", 0x936c_ffdf_a98e_11c0, of(register(&source, &target, &fixed, &mut Silent))),
        ("estimateSim3", 0x9106_3946_4619_ff12, of(estimate_sim3(&source, &moved, &pairs, &pairwise, &mut Silent))),
    ]);
}

#[wasm_bindgen_test(unsupported = test)]
pub fn scenes_views_and_videos_have_these_bits() {
    let mut seen = views(&body(), &[0.0, 1.3, 4.0]);
    seen[2].frame.mask = None;
    let views = |views, mesh: &PreparedMesh<'_>| align_views(views, mesh, &crate::views::options(), &mut Silent);
    let printed = crate::views::printed(Rotation3::identity(), false);
    let mut tracker = Tracker::new(PreparedMesh::new(body()), TrackOptions::default()).unwrap();
    let frames = (0..5).map(|k| {
        // The object leaves the image.
        let aside = similarity(1.0, [0.0; 3], [0.03 * k as f64, 0.0, 0.0]);
        let mut seen = frame_of(&observe(&body(), &aside.compose(&track::place(k))));
        seen.mask = seen.mask.filter(|_| k % 2 == 0);
        tracker.next(&seen, &mut Silent)
    });
    let whole = observe(&body(), &truth());
    let calibrations = DepthKind::ALL.map(|kind| {
        let focal = if kind == DepthKind::Metric { Focal::Guessed(0.25) } else { Focal::Known };
        let view = calibrate::raw(&whole, kind, focal, 1.1);
        calibrate::calibrated(&view, whole.mask(), &body(), &quick()).map(|found| found.calibration)
    });
    let scene = scene::things();
    let around = crate::observations::views(&body(), &[0.0, 2.1, 4.2]);
    let wide = PreparedMesh::new(mapped(&body(), |p| p * Vec3::new(1.06, 0.97, 0.97)));
    let stretched = ViewsOptions { proportions: Proportions::Full, ..crate::views::options() };
    check(&[
        ("alignScene", 0x8f2a_a8b8_b584_0b42, of(align_scene(&scene::scene_of(&scene, &[], true), &mut Silent))),
        ("alignViews", 0xc75e_5909_faa2_d7ee, of(views(seen, &PreparedMesh::borrowed(&body())))),
        ("alignViews, proportions", 0xbbea_e04f_a783_614d, of(align_views(around, &wide, &stretched, &mut Silent))),
        ("alignViews, unknown cameras and colour", 0xfd4f_ab8e_e7ca_7440, of(views(printed, &printed_mesh()))),
        ("track", 0xacf3_37b5_bb35_53e4, of(frames.collect::<Result<Vec<_>>>())),
        ("calibration", 0x895a_1106_ca89_3cc1, of(calibrations.into_iter().collect::<Result<Vec<_>>>())),
    ]);
}

#[wasm_bindgen_test(unsupported = test)]
pub fn files_have_these_bits() {
    let beside = |uri: &str| match uri {
        "mesh-textured.mtl" => Some(fixture!("mesh-textured.mtl").to_vec()),
        _ => Some(fixture!("photo.png").to_vec()),
    };
    let splats = read_splats(fixture!("splat.ply"), true);
    let mesh = |bytes: &[u8]| {
        let read = read_colored_mesh(
            bytes,
            &MeshReadOptions { format: None, resources: Some(&beside), ..MeshReadOptions::default() },
        );
        of(read.map(|read| (read.mesh, read.colors.unwrap(), read.problem)))
    };
    check(&[
        ("a textured GLB", 0xd47b_e0b6_91f7_5576, mesh(fixture!("mesh-textured.glb"))),
        ("a GLB of coloured vertices", 0xa036_80d3_8b70_bf1c, mesh(fixture!("mesh-colors.glb"))),
        ("a textured OBJ", 0x0b26_6b56_4449_638d, mesh(fixture!("mesh-textured.obj"))),
        ("a large photo", 0xa44f_803c_9e7c_ba9c, of(read_photo(fixture!("photo-large.jpg")))),
        ("splats", 0xb3c9_b24c_1b1a_43bb, of(splats.map(|read| (read.mesh, read.colors)))),
    ]);
}
