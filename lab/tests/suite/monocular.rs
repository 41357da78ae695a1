//! What a depth model gives: each row has the errors that it names, and its true calibration takes them back.

use sim3align::align::evaluate::Truth;
use sim3align_geometry::depth_kind::DepthKind;
use sim3align_lab::bench::benchmark::BenchCase;
use sim3align_lab::cases::case::EvaluationSet;
use sim3align_lab::cases::tier::CaseSet;
use sim3align_lab::monocular::calibration::Calibration;
use sim3align_lab::monocular::filling::filled;
use sim3align_lab::monocular::picture::{Picture, Thing};
use sim3align_lab::monocular::prediction::{GivenCamera, Prediction};
use sim3align_lab::monocular::reading::Treatment;
use sim3align_lab::monocular::record::{Errors, STRICT};
use sim3align_lab::monocular::row::Row;
use sim3align_lab::monocular::runs::{Settings, Way, run};
use sim3align_lab::monocular::table::report;
use sim3align_lab::prelude::*;

use crate::shapes::cuboid;

const SIZE: [usize; 2] = [250, 160];
const NEAR: f64 = 0.6;
const FAR: f64 = 1.4;
/// Columns and rows of the object.
const OBJECT: [core::ops::Range<usize>; 2] = [90..170, 40..120];

fn is_object(i: usize) -> bool {
    OBJECT[0].contains(&(i % SIZE[0])) && OBJECT[1].contains(&(i / SIZE[0]))
}

/// The inverse depth of a plane; where it is seen is linear in the image.
fn plane(i: usize) -> f64 {
    let (u, v) = ((i % SIZE[0]) as f64, (i / SIZE[0]) as f64);
    1.0 / FAR + 4e-4 * u + 9e-4 * v
}

/// A slab before a slanted plane.
fn depth() -> Vec<f64> {
    (0..SIZE[0] * SIZE[1]).map(|i| if is_object(i) { NEAR } else { 1.0 / plane(i) }).collect()
}

fn mask() -> Mask {
    Image::new("mask", SIZE[0], SIZE[1], (0..SIZE[0] * SIZE[1]).map(|i| u8::from(is_object(i))).collect()).unwrap()
}

fn map(values: &[f64]) -> DepthMap {
    DepthMap::from_metres(SIZE[0], SIZE[1], values.iter().map(|z| *z as f32).collect()).unwrap()
}

fn picture(name: &str, has_steps: bool) -> Picture {
    let mesh = cuboid(Vec3::ONE);
    let thing = Thing { name: "slab".into(), mask: mask(), mesh, colors: None, truth: None };
    Picture {
        name: name.into(),
        depth: map(&depth()),
        camera: Pinhole::new(240.0, 240.0, 124.5, 79.5).unwrap(),
        photo: None,
        objects: vec![thing],
        has_steps,
    }
}

fn prediction(row: Row, seed: u64) -> Prediction {
    Prediction::new(&picture("slab", false), row, seed).unwrap()
}

#[test]
fn holes_continue_what_is_around_them() {
    let exact = depth();
    // Holes of the background, of the object, and one across its outline, as shadows are.
    let is_hole = |i: usize| {
        let (u, v) = (i % SIZE[0], i / SIZE[0]);
        (10..40).contains(&u) && (20..60).contains(&v)
            || (120..130).contains(&u) && (60..90).contains(&v)
            || (150..190).contains(&u) && (70..100).contains(&v)
    };
    let holed: Vec<f64> = exact.iter().enumerate().map(|(i, z)| if is_hole(i) { 0.0 } else { *z }).collect();
    let found = filled(&map(&holed), &[&mask()]).unwrap();
    // The slope of the background is unknown at the outline, and taken to be 0: a harmonic function that is 0 on the sides of
    // a half strip and of this slope at its end is largest amid the end, 4 G / π² of slope times height, with Catalan's G.
    let at_outline = 4.0 * 0.915_966 / (PI * PI) * 4e-4 * 31.0;
    for (i, (found, exact)) in found.iter().zip(&exact).enumerate() {
        let most = match is_hole(i) {
            false => 1e-6,
            true if i % SIZE[0] >= OBJECT[0].end => at_outline,
            true => 3e-4,
        };
        assert!((1.0 / found - 1.0 / exact).abs() < most, "{i}: {found} for {exact}");
    }
    // What lacks all readings gets those around; nothing gets nothing.
    let empty: Vec<f64> = exact.iter().enumerate().map(|(i, z)| if is_object(i) { 0.0 } else { *z }).collect();
    let found = filled(&map(&empty), &[&mask()]).unwrap();
    assert!(found.iter().all(|z| (0.7..=FAR + 1e-6).contains(z)));
    assert!(filled(&map(&vec![0.0; exact.len()]), &[&mask()]).is_err());
}

#[test]
fn true_calibrations_take_the_errors_back() {
    let exact = depth();
    let rows = [
        (Row::Filled, DepthKind::Metric, 0),
        (Row::Scaled, DepthKind::Metric, 0),
        (Row::ScaleInvariant, DepthKind::ScaleInvariant, 0),
        (Row::Shifted, DepthKind::AffineInvariant, 0),
        (Row::ShiftedMetric, DepthKind::Metric, 0),
        (Row::FocalWrong, DepthKind::Metric, 0),
        (Row::FocalUnknown, DepthKind::Metric, 0),
        (Row::Disparity, DepthKind::AffineInvariantDisparity, 16),
        (Row::DisparityFocalUnknown, DepthKind::AffineInvariantDisparity, 16),
        (Row::Disparity8, DepthKind::AffineInvariantDisparity, 8),
    ];
    for (row, kind, bits) in rows {
        for seed in 0..4 {
            let Prediction { map, truth, kind: said, .. } = prediction(row, seed);
            assert_eq!(said, kind, "{row:?}");
            let mut beyond = 0;
            for (value, exact) in map.data().iter().zip(&exact) {
                let found = truth.depth(f64::from(*value));
                if bits == 0 {
                    assert!((found / exact - 1.0).abs() < 1e-5, "{row:?} {seed}: {found} for {exact}");
                } else {
                    // Half a step of the whole range.
                    let step = 0.5 * truth.scale / f64::from((1 << bits) - 1);
                    beyond += usize::from((1.0 / found - 1.0 / exact).abs() > step + 1e-6);
                }
            }
            assert!(beyond <= exact.len() / 2000, "{row:?}: {beyond}");
        }
    }
}

#[test]
fn rows_err_as_much_as_they_say() {
    let exact = depth();
    let (mut signs, mut shifts) = ([0; 2], [0; 2]);
    for seed in 0..16 {
        let ratio = |row: Row| {
            let map = prediction(row, seed).map;
            let ratios: Vec<f64> = map.data().iter().zip(&exact).map(|(found, z)| f64::from(*found) / z).collect();
            ratios
        };
        let scaled = ratio(Row::Scaled)[0];
        assert!(((scaled - 1.0).abs() - 0.15).abs() < 1e-6);
        signs[usize::from(scaled > 1.0)] += 1;
        let shifted = prediction(Row::ShiftedMetric, seed).truth;
        assert!((shifted.shift.abs() - 0.12 * NEAR).abs() < 1e-6 && shifted.scale == 1.0);
        shifts[usize::from(shifted.shift > 0.0)] += 1;
        let shifted = prediction(Row::Shifted, seed);
        assert!((shifted.truth.shift * shifted.truth.scale).abs() - 0.12 * NEAR < 1e-6);
        let bent = ratio(Row::Bent);
        let most = bent.iter().fold(0.0, |most: f64, ratio| most.max((ratio - 1.0).abs()));
        assert!((0.01..=0.02 + 1e-6).contains(&most), "{most}");
        let wrong = match prediction(Row::FocalWrong, seed).camera {
            GivenCamera::Doubted(camera, _) => camera.fx / 240.0,
            other => panic!("{other:?}"),
        };
        assert!((0.15..=0.18).contains(&(wrong - 1.0).abs()), "{wrong}");
        assert_eq!(prediction(Row::FocalUnknown, seed).camera, GivenCamera::Unknown);
        let disparity = prediction(Row::Disparity, seed).map;
        let [low, high] = [f32::min, f32::max].map(|of| disparity.data().iter().copied().reduce(of).unwrap());
        assert_eq!([low, high], [0.0, 1.0]);
    }
    assert!(signs.iter().chain(&shifts).all(|count| *count > 2), "{signs:?} {shifts:?}");
}

#[test]
fn seeds_reproduce_and_rows_of_the_same_error_share_a_map() {
    for &row in Row::ALL {
        let first = prediction(row, 5);
        assert_eq!(first.map, prediction(row, 5).map, "{row:?}");
    }
    assert_ne!(prediction(Row::Bent, 5).map, prediction(Row::Bent, 6).map);
    let renamed = Prediction::new(&picture("other", false), Row::Bent, 5).unwrap();
    assert_ne!(prediction(Row::Bent, 5).map, renamed.map);
    for (row, other) in [(Row::Scaled, Row::ScaleInvariant), (Row::Disparity, Row::DisparityFocalUnknown)] {
        assert_eq!(prediction(row, 5).map, prediction(other, 5).map);
    }
}

/// The share of a step that is done at each pixel of a row across the left edge of the object.
fn edge(row: Row, has_steps: bool) -> Vec<(f64, f64)> {
    let picture = picture("slab", has_steps);
    let Prediction { map, truth, .. } = Prediction::new(&picture, row, 3).unwrap();
    let v = 80;
    let is_inverse = truth.is_inverse || row == Row::BlurredDisparity;
    let space = |z: f64| if is_inverse { 1.0 / z } else { z };
    let done = |u: usize| {
        let [found, near, far] =
            [truth.depth(f64::from(map.data()[v * SIZE[0] + u])), NEAR, 1.0 / plane(v * SIZE[0] + u)].map(space);
        // The edge is between two columns.
        (u as f64 - (OBJECT[0].start as f64 - 0.5), (found - far) / (near - far))
    };
    (OBJECT[0].start - 20..OBJECT[0].start + 20).map(done).collect()
}

#[test]
fn edges_are_blurred_in_the_space_of_the_network() {
    // The width of the object is 80 pixels, so that σ = 2: the normal distribution, between whose pixels the kernel has no
    // part.
    for row in [Row::Blurred, Row::BlurredDisparity] {
        for (x, done) in edge(row, false) {
            let exact = 0.5 * (1.0 + libm::erf(x / (2.0 * 2f64.sqrt())));
            assert!((done - exact).abs() < 0.01, "{row:?} at {x}: {done} for {exact}");
        }
    }
}

#[test]
fn exact_edges_become_ramps() {
    // 250 pixels for 500 of the network: ramps of 1 to 2 pixels.
    let ramp = edge(Row::Disparity, true);
    let between: Vec<&(f64, f64)> = ramp.iter().filter(|(_, done)| (0.02..0.98).contains(done)).collect();
    assert!((1..=3).contains(&between.len()), "{ramp:?}");
    assert!(ramp.iter().all(|(x, done)| x.abs() < 2.0 || (*done > 0.5) == (*x > 0.0)), "{ramp:?}");
    let steps = edge(Row::Disparity, false);
    assert!(steps.iter().all(|(x, done)| (f64::from(u8::from(*x > 0.0)) - done).abs() < 1e-3), "{steps:?}");
}

#[test]
fn the_error_of_the_shift_is_that_of_the_relief() {
    let camera = Pinhole::new(500.0, 500.0, 320.0, 240.0).unwrap();
    let random = &mut Random::new(7, 1);
    for _ in 0..100 {
        let is_inverse = random.uniform() < 0.5;
        let mut draw = || Calibration { is_inverse, scale: 0.5 + random.uniform(), shift: random.uniform(), camera };
        let (truth, assumed) = (draw(), draw());
        let z = 0.4 + random.uniform();
        let value = truth.value(z);
        assert!((truth.depth(value) - z).abs() < 1e-12);
        // d ln z / d value, by finite differences.
        let relief = |calibration: &Calibration| {
            let step = 1e-6 * (value + calibration.shift);
            (calibration.depth(value + step) / calibration.depth(value - step)).ln() / (2.0 * step)
        };
        let exact = relief(&truth) / relief(&assumed) - 1.0;
        let found = assumed.shift_error(&truth, z);
        assert!((found - exact).abs() < 1e-6, "{found} for {exact}");
    }
}

#[test]
fn a_pose_is_right_if_it_looks_right() {
    let picture = picture("slab", false);
    let thing = &picture.objects[0];
    let rotation = Rotation3::from_euler_angles(0.3, -0.2, 0.5);
    let camera_from_mesh = Similarity { scale: 0.2, rotation, translation: Vector3::new(0.1, -0.05, 0.9) };
    let truth = Truth { camera_from_mesh, symmetry: Symmetry::None };
    let exact = Calibration::of_metres(picture.camera);
    let errors =
        |found: &Similarity, assumed: &Calibration| Errors::of(thing, &truth, found, [assumed, &exact]).unwrap();
    // In another unit, the image is the same.
    let metric = Similarity { scale: 3.0, ..Similarity::identity() };
    let found = errors(&metric.compose(&camera_from_mesh), &Calibration { scale: 3.0, ..exact });
    assert!(STRICT.holds(&found) && found.apparent_size.abs() < 1e-12 && found.direction < 1e-12);
    assert!((found.size - 2.0).abs() < 1e-12);
    // With a longer lens it is the same farther away and nearer to the axis.
    let longer = Pinhole { fx: 1.2 * 240.0, fy: 1.2 * 240.0, ..picture.camera };
    let mut pose = camera_from_mesh;
    pose.translation.z *= 1.2;
    let found = errors(&pose, &Calibration { camera: longer, ..exact });
    let center = Bounds::of(thing.mesh.positions()).unwrap().center();
    assert!(center.length() < 1e-6, "the mesh is centred");
    assert!(found.apparent_size.abs() < 1e-6 && found.direction < 1e-6 && (found.focal - 0.2).abs() < 1e-12);
    // A tenth too large, a tenth of the diameter aside, and turned by 12°.
    let found = errors(&Similarity { scale: 0.22, ..camera_from_mesh }, &exact);
    assert!((found.apparent_size - 0.1).abs() < 1e-9 && !STRICT.holds(&found));
    let diameter = 0.2 * thing.mesh.diagonal();
    let aside = camera_from_mesh.translation + Vector3::new(0.1 * diameter, 0.0, 0.0);
    let found = errors(&Similarity { translation: aside, ..camera_from_mesh }, &exact);
    assert!((found.direction - 0.1).abs() < 1e-6 && !STRICT.holds(&found));
    let turned = rotation * Rotation3::from_axis_angle(&Vector3::x_axis(), 12f64.to_radians());
    let found = errors(&Similarity { rotation: turned, ..camera_from_mesh }, &exact);
    assert!((found.rotation_deg - 12.0).abs() < 1e-6 && !STRICT.holds(&found));
}

#[test]
fn a_generated_case_is_aligned_in_its_rows() {
    let case = EvaluationSet::new(3).of(CaseSet::Monocular).case(0).unwrap();
    assert_eq!(case.depth, "exact");
    let picture = Picture { has_steps: true, ..BenchCase::from(case).into() };
    let settings = Settings {
        rows: vec![Row::Scaled, Row::Disparity],
        ways: Way::ALL.to_vec(),
        treatment: Treatment::Naive,
        options: AlignOptions { quality: Quality::Fast, ..AlignOptions::default() },
        seed: 0,
    };
    let records = run(&picture, &settings).unwrap();
    // One object has no others to be aligned with.
    assert_eq!(
        records.iter().map(|r| (r.row, r.way)).collect::<Vec<_>>(),
        [("scaled", "alone"), ("disparity", "alone")]
    );
    let errors = records[0].errors.unwrap();
    assert!(STRICT.holds(&errors), "{errors:?}");
    assert!((errors.size.abs() - 0.15).abs() < 0.03 && errors.shift == 0.0 && errors.focal == 0.0, "{errors:?}");
    assert!(records[1].errors.unwrap().shift.abs() > 0.03);
    let table = report(&records, &settings.rows, &settings.ways);
    assert!(table.contains("| scaled | 1 | 100.0 % | 100.0 % | 0.0 (100.0 %) |"), "{table}");
}
